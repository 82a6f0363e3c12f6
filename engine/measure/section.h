#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"

namespace fettle::engine {

/// How heights between samples are taken.
enum class Interpolation : std::uint8_t {
  /// The bilinear patch of the four samples around, which Fettle feels and draws. A place has a height where every
  /// sample with a weight above 0 belongs to the region: next to a hole or a mark that is left out there is none.
  kBilinear,
  kNearest,  ///< the nearest sample; there is none where that does not belong to the region
};

struct SectionOptions {
  double width_mm =
      0.0;  ///< heights are means across this width, at most kMostLanes lines; 0: of the line alone
  Region region = Region::kAll;
  Interpolation interpolation = Interpolation::kBilinear;

  static constexpr int kMostLanes = 4096;
};

/// What a section was taken from: which rows and columns its places have in common is read there again.
struct SectionSource {
  Version field;
  std::vector<glm::dvec2> points;
  SectionOptions options;
};

/// The heights of a field along a polyline, at places `step_mm` apart.
struct Section {
  double step_mm = 0.0;              ///< from one place to the next along the line
  std::vector<glm::dvec2> position;  ///< of the places, field coordinates [mm]
  std::vector<double> height;        ///< [mm]; NaN: fewer than half of the lanes have a height there
  std::vector<double> share;         ///< of the lanes that have a height, 0 .. 1
  int lanes = 1;                     ///< lines side by side whose heights were averaged
  /// Covariance of the heights of places i and i + k, k = 0 .. band - 1, for independent noise of variance 1 in every
  /// sample: covariance[i * band + k]; 0 where either has no height. Places share samples with their neighbours.
  int band = 1;
  std::vector<double> covariance;
  SectionSource source;  ///< of an empty field: places have no row or column in common

  static constexpr std::int64_t kMostPlaces = std::int64_t{1} << 20;

  [[nodiscard]] std::size_t size() const noexcept { return height.size(); }
  [[nodiscard]] double along(std::size_t i) const noexcept { return static_cast<double>(i) * step_mm; }
  [[nodiscard]] double lengthMm() const noexcept { return size() > 1 ? along(size() - 1) : 0.0; }
  /// Variance of the sum of weights[i] height[i] for noise of variance 1 in every sample; weights of places without a
  /// height are 0.
  [[nodiscard]] double variance(std::span<const double> weights) const noexcept;
  /// Covariance of two such sums.
  [[nodiscard]] double covarianceOf(std::span<const double> a, std::span<const double> b) const noexcept;
  /// Variance of the same sum where whole rows of samples are off by noise of variance 1, and where whole columns are. Time:
  /// lanes of the places that have a weight, and rows and columns of the field.
  struct LineVariance {
    double rows = 0.0, columns = 0.0;
  };
  [[nodiscard]] LineVariance lineVariance(std::span<const double> weights) const;
  /// Of several such sums, each with each (sum x sum, row-major), and of the heights themselves of the
  /// places that have a weight in any: the sum of their variances, and how many rows and columns they are made of.
  struct LineCovariance {
    std::vector<double> rows, columns;
    LineVariance heights;
    int rows_met = 0, columns_met = 0;
  };
  [[nodiscard]] LineCovariance lineCovariance(std::span<const std::vector<double>> sums) const;
  /// By how much the heights of all places are off where each row and each column of the field is off by so much; none of
  /// either: as if all were 0. The same for several such offsets; 0 for places without a height. Time: lanes of all places times offsets.
  struct LineOffsets {
    std::vector<double> rows, columns;
  };
  [[nodiscard]] std::vector<std::vector<double>> offBy(std::span<const LineOffsets> offsets) const;
};

/// The section along the polyline through `points` (field coordinates [mm], at least two), signs applied. The places are
/// evenly spaced over its whole length, both ends included, as near to one sample apart as that allows, at the
/// direction in which samples are closest. With a width, lanes lie beside each other one sample apart, symmetrical about
/// the line; at a bend they fan. Places outside the field have no height.
///
/// Exact but for rounding to double where the heights are those of a bilinear patch. The covariance is exact along a
/// straight line; of a bent one with a width, what places far apart share at the inside of the bend is left out.
/// Memory: 8 (5 + band) bytes a place, of which there are at most kMostPlaces; band is 3 for equal spacing. Errors:
/// kInput for fewer than two different points, numbers that are not finite, a width that is not 0 or more, too many
/// places or lanes, a line that has no height at all; kFailed without memory; kCancelled. Thread: any.
[[nodiscard]] Result<Section> sectionAlong(const Version& field, std::span<const glm::dvec2> points,
                                           const SectionOptions& options, JobControl& job);

}  // namespace fettle::engine
