#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"

namespace fettle::engine {

/// Which way a scanner went: its lines are rows, or columns.
enum class ScanAxis : std::uint8_t { kX, kY };

/// How the height of a scanned line is found.
enum class LineMethod : std::uint8_t {
  kMedian,      ///< the median of its samples: features on less than half of a line leave it alone
  kPolynomial,  ///< a polynomial along the line by least squares; of degree 0, the mean
  /// From line to line the median of the differences of neighbouring samples, added up: features may fill a line as long as
  /// they reach over several. Errors add up, too, as the root of the number of lines.
  kDifference,
  /// The same with a mean that leaves out differences far from most others' (Tukey's biweight) and weighs the rest by how
  /// alike the slopes along the two lines are, by exp(-d^2 / (2 <d^2>)) of their difference d: nearer by a fifth than the
  /// median where noise is all that differs.
  kMatching,
};

struct LineOptions {
  static constexpr int kMostDegree = 3;
  static constexpr int kMostFormDegree = 9;
  /// Of form that stays where a person only says that it is to: of a wave as long as the field 3 % go (one of degree 5 by least
  /// squares leaves out what Legendre's polynomials from degree 6 on have of it), of stripes in 500 lines 1 % of the variance stays.
  static constexpr int kUsualFormDegree = 5;

  LineMethod method = LineMethod::kMedian;
  int degree = 0;  ///< of kPolynomial: 0 .. kMostDegree; ignored otherwise
  ScanAxis axis = ScanAxis::kX;
  Region region = Region::kAll;
  /// kPolynomial: samples far from the polynomial do not count. From the one with the least median distance of those
  /// through 150 sets of samples, by Tukey's biweight at 4.685 times the normalised median distance (as FormOptions).
  bool robust = false;
  /// Form across the lines that stays in the field: a polynomial of this degree over the lines, 0 .. kMostFormDegree, of at
  /// most one term for four lines that have samples. It is fitted to each coefficient by least squares, and what is taken is
  /// the rest. Nothing: all of it goes but the mean height. Of a form that is such a polynomial everything stays; of stripes
  /// that are independent from line to line the share (degree + 1) / lines of their variance; of errors that add up in
  /// kDifference and kMatching the slow part is left out as well.
  std::optional<int> form_degree = std::nullopt;

  friend bool operator==(const LineOptions&, const LineOptions&) = default;
};

/// What is taken from each scanned line.
struct LineOffsets {
  ScanAxis axis = ScanAxis::kX;
  std::int32_t lines = 0, length = 0;  ///< of the field: how many lines, of how many samples
  int degree = 0;
  /// [height_unit], (degree + 1) for each line: of Legendre's polynomials over -1 .. 1 along the line. The mean of all
  /// first ones is 0, so that heights stay about where they were; with LineOptions::form_degree that of each. A line without a sample of the region has what lies between
  /// its neighbours.
  std::vector<double> coefficients;
  std::int32_t empty = 0;  ///< lines without a sample of the region
  double rms = 0.0;        ///< of the first coefficients [height_unit]
  double form_rms = 0.0;   ///< of the form across the lines that stays, about its mean; 0: none was asked for

  /// As HeightsOf: what is taken from the samples of a rectangle.
  void readHeights(const SampleRect& rect, double* out) const noexcept;
  /// What is taken at a place along a line, counted in samples, which may lie between two.
  [[nodiscard]] double takenAt(std::int32_t line, double place) const noexcept;
};

/// Finds the offset or drift of each line of a line scanner.
///
/// Bit-identical for any number of threads. Cost: one pass; with the differences lines that follow empty ones are read once more. Errors: kInput for a degree of either kind out of
/// range or a region without samples; kCancelled. Throws std::bad_alloc. Thread: any; a long job on all workers of the calling
/// arena.
[[nodiscard]] Result<LineOffsets> findLineOffsets(const Version& field, const LineOptions& options,
                                                  JobControl& job);

/// The same from the samples at these places of each line alone, or from all where none is given; ascending. Slopes are those between
/// neighbours, as ever. A line that has no sample there counts as one without samples.
[[nodiscard]] Result<LineOffsets> findLineOffsets(const Version& field, const LineOptions& options,
                                                  std::span<const std::int32_t> places, JobControl& job);

}  // namespace fettle::engine
