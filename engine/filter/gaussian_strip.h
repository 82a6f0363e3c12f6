#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/job.h"
#include "engine/field/reader.h"
#include "engine/field/sample_rect.h"
#include "engine/filter/gaussian_plane.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// The means of GaussianPlane, bit by bit, where the samples are the nodes along both axes (GaussianAxis::step 1): a strip of
/// columns at a time, whose sums stay near the core. Weights are summed only where a hole or the field's border makes
/// them differ.
///
/// Threading: any, each thread with its own scratch.
class GaussianStrips {
 public:
  struct Scratch {
    std::vector<float> heights;
    std::vector<double> line, values, weights;
    std::vector<const double*> value_rows, weight_rows;
    std::vector<unsigned char> differs;
  };

  /// `x` and `y` outlive this.
  GaussianStrips(const GaussianAxis& x, const GaussianAxis& y, CpuLevel level)
      : x_(x), y_(y), level_(level) {}

  /// Means of samples of `rect` as those of GaussianPlane::fill; up to 15 elements after each row may be written. False when
  /// cancelled. Throws std::bad_alloc.
  [[nodiscard]] bool fill(const FieldReader& field, const SampleRect& rect, Scratch& scratch, float* out,
                          std::ptrdiff_t stride, const JobControl& job) const;

 private:
  void sumRows(const FieldReader& field, const SampleRect& strip, std::int32_t count, Scratch& scratch) const;

  const GaussianAxis& x_;
  const GaussianAxis& y_;
  CpuLevel level_;
};

}  // namespace fettle::engine
