// The linear Gaussian of ISO 16610-61:2015, whose text was not at hand.

#include "engine/filter/areal_gaussian.h"

#include <algorithm>
#include <cstddef>

#include <tbb/enumerable_thread_specific.h>

#include "engine/filter/gaussian_plane.h"
#include "engine/filter/gaussian_strip.h"
#include "engine/filter/surface_pass.h"

namespace fettle::engine {

namespace {

// Of a field: the axes, and its sums where they serve the whole.
class ArealGaussian {
 public:
  ArealGaussian(const Version& input, const FilterSpec& spec, CpuLevel level)
      : reader_(input.reader()),
        x_(gaussianAxis(spec.nesting_mm / reader_.grid().spacingXMm(), reader_.width())),
        y_(gaussianAxis(spec.nesting_mm / reader_.grid().spacingYMm(), reader_.height())),
        level_(level),
        sums_(x_, y_, level),
        strips_(x_, y_, level) {}

  // False when cancelled.
  bool prepare(const JobControl& job) {
    // Where the samples are the nodes, sums of the whole would be many times the field: blocks have their own.
    if (inBlocks()) return true;
    return sums_.make(reader_, {}, {0, 0, reader_.width(), reader_.height()}, true, job);
  }

  bool fill(const SampleRect& rect, float* out, std::ptrdiff_t stride, const JobControl& job) {
    if (x_.step == 1 && y_.step == 1)
      return strips_.fill(reader_, rect, strip_scratches_.local(), out, stride, job);
    GaussianPlane::Scratch& scratch = scratches_.local();
    if (!inBlocks()) {
      sums_.fill(rect, scratch, out, stride);
      return true;
    }
    GaussianPlane own(x_, y_, level_);
    if (!own.make(reader_, {}, rect, false, job)) return false;
    own.fill(rect, scratch, out, stride);
    return true;
  }

 private:
  [[nodiscard]] bool inBlocks() const noexcept { return x_.step * y_.step < 4; }

  FieldReader reader_;
  GaussianAxis x_, y_;
  CpuLevel level_;
  GaussianPlane sums_;
  GaussianStrips strips_;
  tbb::enumerable_thread_specific<GaussianStrips::Scratch> strip_scratches_;
  tbb::enumerable_thread_specific<GaussianPlane::Scratch> scratches_;
};

}  // namespace

std::int32_t arealGaussianReach(const FilterSpec& spec, const Grid& grid) noexcept {
  return std::max(gaussianReach(spec.nesting_mm / grid.spacingXMm(), grid.width),
                  gaussianReach(spec.nesting_mm / grid.spacingYMm(), grid.height));
}

std::int32_t arealGaussianGrid(const FilterSpec& spec, const Grid& grid) noexcept {
  return std::max(gaussianStep(spec.nesting_mm / grid.spacingXMm(), grid.width),
                  gaussianStep(spec.nesting_mm / grid.spacingYMm(), grid.height));
}

Result<PassResult> arealGaussianPass(const Version& input, const Version& original, const FilterSpec& spec,
                                     const FilterTuning& tuning, JobControl& job) {
  ArealGaussian filter(input, spec, std::min(tuning.level, bestCpuLevel()));
  if (!filter.prepare(job)) return cancelled();
  return passOfSurface([&](const SampleRect& rect, float* out,
                           std::ptrdiff_t stride) { return filter.fill(rect, out, stride, job); },
                       arealGaussianReach(spec, input.grid()), input, original, spec, tuning, job);
}

}  // namespace fettle::engine
