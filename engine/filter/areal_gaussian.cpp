// The linear Gaussian of ISO 16610-61:2015 and the robust one of ISO 16610-71:2014 at order 0 of its regression, as J. Seewig
// has it (Linear and robust Gaussian regression filters, 2005): in each round every sample is weighted by Tukey's biweight of
// its distance from the surface of the round before, which ends at 4.4478 medians of all distances. The texts of the two standards
// were not at hand.

#include "engine/filter/areal_gaussian.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/field/tile.h"
#include "engine/filter/filter_work.h"
#include "engine/filter/gaussian_plane.h"
#include "engine/filter/gaussian_strip.h"
#include "engine/filter/middle_distance.h"
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

  // Weights are those of `weights` from now on. False when cancelled.
  bool prepare(const SampleWeights& weights, const JobControl& job) {
    weights_ = weights;
    // Where the samples are the nodes, sums of the whole would be many times the field: blocks have their own.
    if (inBlocks()) return true;
    return sums_.make(reader_, weights_, {0, 0, reader_.width(), reader_.height()}, true, job);
  }

  bool fill(const SampleRect& rect, float* out, std::ptrdiff_t stride, const JobControl& job) {
    if (x_.step == 1 && y_.step == 1)
      return strips_.fill(reader_, weights_, rect, strip_scratches_.local(), out, stride, job);
    GaussianPlane::Scratch& scratch = scratches_.local();
    if (!inBlocks()) {
      sums_.fill(rect, scratch, out, stride);
      return true;
    }
    GaussianPlane own(x_, y_, level_);
    if (!own.make(reader_, weights_, rect, false, job)) return false;
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
  SampleWeights weights_;
  tbb::enumerable_thread_specific<GaussianStrips::Scratch> strip_scratches_;
  tbb::enumerable_thread_specific<GaussianPlane::Scratch> scratches_;
};

// A surface over the whole field.
struct WholeSurface {
  explicit WholeSurface(const FieldReader& field)
      : stride((field.width() + 31) / 16 * 16),
        z(static_cast<std::size_t>(stride) * static_cast<std::size_t>(field.height()) + 16) {}
  std::ptrdiff_t stride;
  std::vector<float> z;
};

bool fillAll(ArealGaussian& filter, const FieldReader& field, WholeSurface& to, const JobControl& job) {
  const std::int64_t tiles = std::int64_t{field.tileColumns()} * field.tileRows();
  tbb::parallel_for(std::int64_t{0}, tiles, [&](std::int64_t i) {
    if (job.cancelled()) return;
    const auto column = static_cast<std::int32_t>(i % field.tileColumns()) * kTileSide;
    const auto row = static_cast<std::int32_t>(i / field.tileColumns()) * kTileSide;
    const SampleRect rect{column, row, std::min(kTileSide, field.width() - column),
                          std::min(kTileSide, field.height() - row)};
    // Rows that end at a tile's end may not write into the next one's.
    float part[kTileSamples + 16], before[kTileSamples];
    if (!filter.fill(rect, part, kTileSide, job)) return;
    for (int r = 0; r < rect.rows; ++r) {
      float* const out = to.z.data() + (row + r) * to.stride + column;
      std::copy_n(out, rect.columns, before);
      // Where no sample of the window has weight the surface of the round before stays.
      for (int c = 0; c < rect.columns; ++c) {
        const float z = part[r * kTileSide + c];
        out[c] = z == z ? z : before[c];
      }
    }
  });
  return !job.cancelled();
}

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
  if (!filter.prepare({}, job)) return cancelled();
  return passOfSurface([&](const SampleRect& rect, float* out,
                           std::ptrdiff_t stride) { return filter.fill(rect, out, stride, job); },
                       arealGaussianReach(spec, input.grid()), input, original, spec, tuning, job);
}

Result<PassResult> robustGaussianPass(const Version& input, const Version& original, const FilterSpec& spec,
                                      const FilterTuning& tuning, JobControl& job) {
  const FieldReader field = input.reader();
  ArealGaussian filter(input, spec, std::min(tuning.level, bestCpuLevel()));
  WholeSurface now(field), before(field);
  SampleWeights weights;
  double limit = 0.0;
  int round = 0;
  const std::size_t bytes = now.z.size() * sizeof(now.z[0]);
  // Not held while the rounds run: it is as large as the field.
  if (const auto kept = tuning.work != nullptr ? tuning.work->roundsBefore() : std::nullopt;
      kept && kept->numbers.size() == bytes) {
    std::memcpy(now.z.data(), kept->numbers.data(), bytes);
    limit = kept->limit;
    round = kept->done;
    weights = {now.z.data(), now.stride, limit};
  }
  for (; round < kMostRobustRounds; ++round) {
    if (!filter.prepare(weights, job)) return cancelled();
    // Blocks of one round may still read the weights of the last one.
    std::swap(now, before);
    if (weights.surface != nullptr) now.z = before.z;
    if (!fillAll(filter, field, now, job)) return cancelled();
    const double next = kRobustLimit * middleDistance(field, now.z.data(), now.stride);
    // More than half of the samples lie on the surface: there is no scale to weight the others by.
    const bool ends = !(next > 0.0) || std::fabs(next - limit) <= kRobustTolerance * limit;
    limit = next;
    if (ends) break;
    weights = {now.z.data(), now.stride, limit};
    if (tuning.work != nullptr && tuning.work->wantsRounds())
      tuning.work->roundDone({round + 1, limit, {reinterpret_cast<const char*>(now.z.data()), bytes}});
  }
  return passOfSurface(
      [&](const SampleRect& rect, float* out, std::ptrdiff_t stride) {
        for (int r = 0; r < rect.rows; ++r)
          std::copy_n(now.z.data() + (rect.row + r) * now.stride + rect.column, rect.columns,
                      out + r * stride);
        return true;
      },
      std::max(field.width(), field.height()), input, original, spec, tuning, job);
}

}  // namespace fettle::engine
