#include "engine/edges/line_round.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace fettle::engine {

namespace {

// Residuals of neighbouring samples are not independent: interpolation and speckle of the scanner.
constexpr double kInflation = 1.3;
constexpr double kStrongStep = 6.0;   // standard deviations of the noise
constexpr double kFinalGuard = 0.75;  // samples nearer to the line may lie on either side [samples]
constexpr double kEitherSide = 1.0;   // samples nearer to the line fit where they fit better [samples]
constexpr double kNearExtent = 0.75;  // samples nearer to the end of a surface are not judged [samples]
constexpr double kLeastExtent = 4.0;  // of a surface [samples]
constexpr double kNoPlane = 2.5;      // residual variance over that of the noise
constexpr int kGrain = 16;            // points of a task

// When a point is located; see locateEdgeLines().
constexpr double kLeastEvidence = 12.0;
constexpr int kEvidenceAlong = 10;  // points before and after whose mean evidence counts
constexpr double kLargestDeviation = 1.0;
constexpr double kRoughestSide = 9.0;  // residual variance over that of the noise, of the better side
// What the chain does not know: the surfaces' own errors, smoothing along, tremor within the strip.
constexpr double kLeastDeviation = 0.2;

// Where a strip lies slanted over a high wall, samples of both sides share their d, and the division puts a
// narrow segment of its own there. The surfaces begin behind it, unless a neighbouring line does.
Extent widened(Extent extent, double offset, const Surroundings& around, double depth) {
  const std::vector<double>& breaks = around.breaks;
  const double before = around.own > 0 ? breaks[around.own - 1] : -depth;
  const double after = around.own + 1 < breaks.size() ? breaks[around.own + 1] : depth;
  return {std::min(extent.low, static_cast<float>(std::max(before, offset - kLeastExtent))),
          std::max(extent.high, static_cast<float>(std::min(after, offset + kLeastExtent)))};
}

void decideLocated(const Polyline& line, double variance, std::vector<Finding>& findings) {
  for (int i = 0; i < line.size(); ++i) {
    double sum = 0.0;
    int count = 0;
    for (int along = -kEvidenceAlong; along <= kEvidenceAlong; ++along) {
      const int j = line.wrapped(i + along);
      if (j < 0) continue;
      sum += findings[static_cast<std::size_t>(j)].evidence;
      ++count;
    }
    Finding& here = findings[static_cast<std::size_t>(i)];
    here.located = here.sides.supported() && here.deviation <= kLargestDeviation &&
                   here.variance <= kRoughestSide * variance && sum >= kLeastEvidence * count;
  }
}

bool standsOut(const std::vector<Finding>& findings, double noise) {
  std::vector<double> steps;
  steps.reserve(findings.size());
  for (const Finding& f : findings)
    steps.push_back(std::abs(f.sides.left.at(f.offset, 0.0) - f.sides.right.at(f.offset, 0.0)));
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle > kStrongStep * noise;
}

// How far each sample of the strip lies from the surfaces of its point.
void noteMisfits(const SideContext& context, const StripLine& line, const std::vector<Finding>& findings,
                 double noise, SampleWindow& window) {
  tbb::parallel_for(tbb::blocked_range<int>(0, context.line.size(), kGrain), [&](const auto& points) {
    for (int i = points.begin(); i < points.end(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      const Finding& f = findings[at];
      const double limit = kNoPlane * context.variance;
      const bool judged =
          f.sides.supported() && f.sides.left.variance() <= limit && f.sides.right.variance() <= limit;
      const double low = std::max(double{line.extents[at].low}, context.ranges[at].low) + kNearExtent;
      const double high = std::min(double{line.extents[at].high}, context.ranges[at].high) - kNearExtent;
      for (const StripSample& sample : context.strip.at(i)) {
        const double left = std::abs(sample.z - f.sides.left.at(sample.d, sample.s));
        const double right = std::abs(sample.z - f.sides.right.at(sample.d, sample.s));
        const double u = sample.d - line.offsets[at];
        const bool inside = judged && sample.d >= low && sample.d <= high;
        const double misfit = !inside            ? 0.0
                              : u > kEitherSide  ? left
                              : u < -kEitherSide ? right
                                                 : std::min(left, right);
        SampleWindow::Sample& known = window.at(sample.index);
        known.misfit = std::min(known.misfit, static_cast<float>(misfit / noise));
      }
    }
  });
}

}  // namespace

EdgePoint edgePointOf(const Finding& f) {
  EdgePoint point;
  point.located = f.located;
  point.deviation = std::hypot(f.deviation, kLeastDeviation);
  point.step = f.sides.left.at(f.offset, 0.0) - f.sides.right.at(f.offset, 0.0);
  point.slope_change = f.sides.left.slope_d - f.sides.right.slope_d;
  const double left = std::max(f.variance, f.sides.left.variance());
  const double right = std::max(f.variance, f.sides.right.variance());
  point.step_deviation = std::sqrt(left * f.sides.left.varianceAt(f.offset, 0.0) +
                                   right * f.sides.right.varianceAt(f.offset, 0.0));
  point.slope_deviation = std::sqrt(left * f.sides.left.inverse_dd + right * f.sides.right.inverse_dd);
  const bool step =
      std::abs(point.step) * point.slope_deviation >= std::abs(point.slope_change) * point.step_deviation;
  point.kind = step ? LineKind::kStep : LineKind::kCrease;
  return point;
}

StripLine LineRound::coarse(const SideContext& context, const std::vector<Surroundings>& around,
                            const JobControl& job) const {
  const auto count = static_cast<std::size_t>(plan.offsets.count());
  const std::size_t n = context.line.points.size();
  ChainCosts costs{plan.offsets, std::vector<float>(n * count)};
  std::vector<Extent> extents(n * count);
  tbb::parallel_for(tbb::blocked_range<int>(0, context.line.size(), kGrain), [&](const auto& points) {
    AcrossSearch search({plan.depth, plan.offsets, context.variance, plan.deviation});
    for (int i = points.begin(); i < points.end() && !job.cancelled(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      search.clear();
      forEachKept(context.line, context.strip, context.window, context.ranges, i, plan.half,
                  [&](const StripSample& sample, double s, int) { search.add(sample, s); });
      const std::span<float> own_costs(costs.costs.data() + at * count, count);
      search.solve(around[at].breaks, around[at].own, own_costs, {extents.data() + at * count, count});
      // The strips of neighbouring points share their samples.
      const int used = context.line.closed
                           ? 2 * plan.half + 1
                           : std::min(i, plan.half) + 1 + std::min(context.line.size() - 1 - i, plan.half);
      for (float& cost : own_costs) cost /= static_cast<float>(used);
    }
  });
  const Chain chain = chainAlong(costs, plan.step_deviation, context.line.closed);
  StripLine line{chain.mean, chain.deviation, {}};
  for (std::size_t i = 0; i < n; ++i) {
    const Extent extent = extents[i * count + static_cast<std::size_t>(chain.likeliest[i])];
    line.extents.push_back(widened(extent, chain.mean[i], around[i], plan.depth));
  }
  return line;
}

std::vector<Finding> LineRound::findingsOf(const SideContext& context, const StripLine& line) const {
  std::vector<Finding> findings(context.line.points.size());
  tbb::parallel_for(tbb::blocked_range<int>(0, context.line.size(), kGrain), [&](const auto& points) {
    for (int i = points.begin(); i < points.end(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      Finding& f = findings[at];
      f.sides = sidesAt(context, line, i, kFinalGuard);
      f.offset = line.offsets[at];
      f.deviation = line.deviations[at];
      f.variance = std::max(context.variance, std::min(f.sides.left.variance(), f.sides.right.variance()));
      f.evidence = (f.sides.joined.residual - f.sides.left.residual - f.sides.right.residual) / f.variance;
    }
  });
  decideLocated(context.line, context.variance, findings);
  return findings;
}

LocatedLine LineRound::run(SampleWindow& window, const JobControl& job) const {
  const Polyline& line = lines[static_cast<std::size_t>(own)];
  const Strip strip = stripAlong(line, window, plan.depth, plan.tangent_half);
  const LineNeighbours neighbours = neighboursOf(index, own, strip.tangents, strip.depth);
  const std::vector<Surroundings> around =
      surroundingsOf(line, neighbours, stage, strong[static_cast<std::size_t>(own)], strong);
  std::vector<OffsetRange> ranges;
  ranges.reserve(around.size());
  for (const Surroundings& here : around) ranges.push_back(here.range);
  const SideContext context{line, strip, window, ranges, plan.half, kInflation * noise * noise};

  StripLine found = coarse(context, around, job);
  refine(context, found);
  LocatedLine located;
  located.findings = findingsOf(context, found);
  located.strong = standsOut(located.findings, noise);
  noteMisfits(context, found, located.findings, noise, window);
  Polyline moved = line;
  for (int i = 0; i < line.size(); ++i)
    moved.points[static_cast<std::size_t>(i)] += strip.normal(i) * found.offsets[static_cast<std::size_t>(i)];
  located.points = smoothed(moved, plan.smoothing);
  return located;
}

}  // namespace fettle::engine
