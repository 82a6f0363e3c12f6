#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/job.h"
#include "engine/field/reader.h"
#include "engine/field/sample_rect.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// How a Gaussian is taken along one axis. Long ones go by nodes `step` samples apart: Gaussians of cut-offs a, b and a one
/// after the other, a^2 + b^2 + a^2 = L^2, are the Gaussian of cut-off L (its transmission is 2^-(L f)^2), and what the first
/// leaves needs few samples.
///
///     samples --a--> nodes --b--> nodes --a--> samples          a = 6 steps, L = 12.5 to 25 steps
///
/// Sums over nodes instead of integrals multiply each weight by 1 + 2 * 2^-(e / step)^2 at most, e^2 = a^2 b^2 / (a^2 + b^2)
/// and more: by 1 + 6e-8. With step 1 the samples are the nodes, and b = L alone.
struct GaussianAxis {
  /// Weights reach to so many cut-offs: 5e-9 of all lie beyond.
  static constexpr double kReach = 1.1;

  std::int32_t step =
      1;  ///< a power of two, so that pieces of a field have its nodes where they begin at one
  std::int32_t near = 0;       ///< reach of a [samples]; 0 where the samples are the nodes
  std::int32_t far = 0;        ///< reach of b [nodes]
  std::vector<double> a;       ///< 2 near + 1 weights
  std::vector<double> b;       ///< 2 far + 1 weights
  std::int32_t nodes_up = 1;   ///< nodes that a sample lies in the reach of
  std::int32_t up_before = 0;  ///< of these, before the one at the sample or next below it
  std::vector<double> up;      ///< of a, for each of `step` samples from a node on: nodes_up weights
};

/// Of a field of so many samples along the axis; cut_off in samples, above 0.
[[nodiscard]] GaussianAxis gaussianAxis(double cut_off, std::int32_t samples);

/// Step of gaussianAxis [samples]: the same for a piece of a field that is longer than the reach.
[[nodiscard]] std::int32_t gaussianStep(double cut_off, std::int32_t samples) noexcept;
/// Samples around one that its result depends on, at most `samples`.
[[nodiscard]] std::int32_t gaussianReach(double cut_off, std::int32_t samples) noexcept;

/// The weights and heights that samples are taken with: planes of the whole field, row-major. Holes have no weight, whatever
/// stands there. At least 7 elements may be read behind the last one.
struct SampleValues {
  const float* weights = nullptr;  ///< 0 to 1; null: all 1
  const float* heights = nullptr;  ///< null: the field's own [height_unit]
  std::ptrdiff_t stride = 0;       ///< of both [elements]
};

/// Weighted means of a rectangle's samples and those around them: sums of weights and of weighted heights at nodes, and
/// means at samples. Holes and what lies outside the field have no weight.
///
/// Each sum has an order of its own that neither the rectangle nor threads have an influence on.
/// Threading: make() from one thread; fill() afterwards from any number, each with its own scratch.
class GaussianPlane {
 public:
  struct Scratch {
    std::vector<double> value, weight, rows;
    std::vector<float> heights;
  };

  GaussianPlane(const GaussianAxis& x, const GaussianAxis& y, CpuLevel level) : x_(x), y_(y), level_(level) {}

  /// Sums at the nodes that means of `rect` need; `parallel`: on all workers of the arena. False when cancelled.
  /// Memory: 56 bytes per node. Throws std::bad_alloc.
  [[nodiscard]] bool make(const FieldReader& field, const SampleValues& samples, const SampleRect& rect,
                          bool parallel, const JobControl& job);

  /// Means of samples of `rect`, row-major, signs applied; NaN where no sample has weight. Throws std::bad_alloc.
  void fill(const SampleRect& rect, Scratch& scratch, float* out, std::ptrdiff_t stride) const;

  /// The sums at the nodes that samples of a part of `rect` need: rows of elements, node (0, 0) being `up_before` nodes before
  /// the one at the part's first sample or next below it, along both axes.
  struct Sums {
    const double* value = nullptr;
    const double* weight = nullptr;
    std::ptrdiff_t stride = 0;
    std::int32_t rows = 0;
  };
  [[nodiscard]] Sums sumsFor(const SampleRect& part) const noexcept;

 private:
  /// Nodes along an axis: [first, first + count), node n at sample n * step.
  struct Nodes {
    std::int32_t first = 0, count = 0;
  };
  static Nodes wanted(const GaussianAxis& axis, std::int32_t begin, std::int32_t end);
  static Nodes read(const GaussianAxis& axis, const Nodes& wanted, std::int32_t samples);

  void gatherRows(const FieldReader& field, const SampleValues& samples, const Nodes& columns,
                  const Nodes& rows, std::int32_t begin, std::int32_t end, double* value, double* weight,
                  std::ptrdiff_t stride, Scratch& scratch) const;

  const GaussianAxis& x_;
  const GaussianAxis& y_;
  CpuLevel level_;
  Nodes columns_, rows_;       // of the sums
  std::ptrdiff_t stride_ = 0;  // of the sums [elements]
  std::vector<double> value_, weight_;
};

}  // namespace fettle::engine
