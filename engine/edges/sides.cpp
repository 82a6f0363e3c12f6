#include "engine/edges/sides.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace fettle::engine {

namespace {

constexpr double kGuards[] = {1.25, 0.75};  // of each turn [samples]
constexpr Offsets kFineOffsets{1.5};
constexpr double kFineStep = 0.3;     // change from point to point [samples]
constexpr double kMostMisfit = 50.0;  // of one sample [variances]: a spike decides nothing
constexpr double kUnsupported =
    0.4;  // chi-square per squared sample: keeps a point without surfaces in place

void addFineCosts(const SideContext& context, const StripLine& line, int i, double guard, float* costs) {
  const auto at = static_cast<std::size_t>(i);
  const int count = kFineOffsets.count();
  std::fill(costs, costs + count, 0.0F);
  const Sides sides = sidesAt(context, line, i, guard);
  if (!sides.supported()) {
    for (int k = 0; k < count; ++k)
      costs[k] = static_cast<float>(kUnsupported * kFineOffsets.at(k) * kFineOffsets.at(k));
    return;
  }
  // The variance of the better side for both: a side that is no plane makes the other one no less certain.
  const double variance = std::max(context.variance, std::min(sides.left.variance(), sides.right.variance()));
  const auto misfit = [&](const PlaneFit& surface, const StripSample& sample) {
    const double residual = sample.z - surface.at(sample.d, sample.s);
    return static_cast<float>(std::min(residual * residual / variance, kMostMisfit));
  };
  const OffsetRange& range = context.ranges[at];
  const Extent extent = line.extents[at];
  for (const StripSample& sample : context.strip.at(i)) {
    if (!context.window.at(sample.index).kept || !range.contains(sample.d)) continue;
    if (sample.d < extent.low || sample.d > extent.high) continue;
    if (std::abs(sample.d - line.offsets[at]) > kFineOffsets.reach + 0.5) continue;
    const float left = misfit(sides.left, sample), right = misfit(sides.right, sample);
    for (int k = 0; k < count; ++k)
      costs[k] += sample.d < line.offsets[at] + kFineOffsets.at(k) ? right : left;
  }
}

}  // namespace

Sides sidesAt(const SideContext& context, const StripLine& line, int i, double guard) {
  Moments left, right;
  forEachBeside(context, line, i, guard, [&](const StripSample& sample, double s, bool is_left) {
    (is_left ? left : right).add(sample.d, s, sample.z);
  });
  return {fitPlane(left), fitPlane(right), fitPlane(left + right)};
}

void refine(const SideContext& context, StripLine& line) {
  const auto count = static_cast<std::size_t>(kFineOffsets.count());
  for (const double guard : kGuards) {
    ChainCosts costs{kFineOffsets, {}};
    costs.costs.resize(line.offsets.size() * count);
    tbb::parallel_for(tbb::blocked_range<int>(0, context.line.size(), 32), [&](const auto& points) {
      for (int i = points.begin(); i < points.end(); ++i)
        addFineCosts(context, line, i, guard, costs.costs.data() + static_cast<std::size_t>(i) * count);
    });
    Chain chain = chainAlong(costs, kFineStep, context.line.closed);
    for (std::size_t i = 0; i < line.offsets.size(); ++i) line.offsets[i] += chain.mean[i];
    line.deviations = std::move(chain.deviation);
  }
}

}  // namespace fettle::engine
