#include "engine/filter/gaussian_regression.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/gaussian_regression-inl.h"
#include "engine/simd/each_cpu-inl.h"

// (1 + q) exp(-q) = 1/2 at the cut-off, where a Gaussian of cut-off C = L alpha sqrt(pi / ln 2) leaves exp(-q) = 2^-(C / L)^2.
constexpr double kHalf = 1.678346990016661;
// The first and the last of three Gaussians [steps]: weights that sums over nodes instead of integrals give are off by less than
// 2e-8 of a moment of order 4 with cut-offs from kLeast on.
constexpr double kShort = 8.0, kLeast = 16.0;
// Beyond so many steps of cut-off, as of one that is long beside the field, two Gaussians do.
constexpr double kMost = 33.0;
constexpr double kReach = 1.25;      // [cut-offs]
constexpr std::int32_t kNodes = 16;  // samples from which on there are nodes
constexpr int kBehind = 48;          // elements that kernels may read or write beyond a row

double weightOf(double distance, double cut_off) {
  const double x = distance / cut_off;
  return std::exp(-std::min(std::numbers::pi * std::numbers::pi / std::numbers::ln2 * x * x, 690.0));
}

// Standard deviation of a Gaussian of a cut-off.
double deviationOf(double cut_off) {
  return std::sqrt(0.5 * std::numbers::ln2) / std::numbers::pi * cut_off;
}

std::int32_t reachWithin(double cut_off, double most) {
  return static_cast<std::int32_t>(std::min(std::floor(kReach * cut_off), most));
}

double hermite(std::size_t k, double x) {
  const double x2 = x * x;
  return k == 0 ? 1.0 : k == 1 ? x : k == 2 ? x2 - 1.0 : k == 3 ? (x2 - 3.0) * x : (x2 - 6.0) * x2 + 3.0;
}

// Products alone: the same bits with any C library.
double power(double x, std::size_t k) {
  double product = 1.0;
  for (std::size_t i = 0; i < k; ++i) product *= x;
  return product;
}

}  // namespace

RegressionAxis regressionAxis(double nesting, std::int32_t samples) {
  RegressionAxis axis;
  GaussianAxis& nodes = axis.nodes;
  const double cut_off = nesting * std::sqrt(kHalf / std::numbers::ln2);
  double others = 0.0, last = cut_off;
  if (cut_off < kLeast || samples < kNodes) {
    nodes.b = {1.0};
    nodes.up_before = reachWithin(cut_off, samples - 1.0);
    nodes.nodes_up = 2 * nodes.up_before + 1;
  } else {
    nodes.step = static_cast<std::int32_t>(
        std::bit_floor(static_cast<std::uint32_t>(std::min(cut_off / kLeast, samples / 8.0))));
    const double step = nodes.step, first = kShort * step;
    nodes.near = reachWithin(first, 1e9);
    for (std::int32_t d = -nodes.near; d <= nodes.near; ++d) nodes.a.push_back(weightOf(d, first));
    nodes.a.resize((nodes.a.size() + 7) / 8 * 8, 0.0);
    if (cut_off < kMost * step) {
      const double middle = std::sqrt(cut_off * cut_off - 2.0 * first * first);
      nodes.far = reachWithin(middle / step, samples / step + 2.0 * kReach * kShort + 2.0);
      for (std::int32_t d = -nodes.far; d <= nodes.far; ++d) nodes.b.push_back(weightOf(d * step, middle));
      last = first;
    } else {
      nodes.b = {1.0};
      last = std::sqrt(cut_off * cut_off - first * first);
    }
    others = std::sqrt(cut_off * cut_off - last * last);
    nodes.up_before = reachWithin(last / step, samples / step + kReach * kShort + 2.0);
    nodes.nodes_up = 2 * nodes.up_before + 2;
  }
  const std::int32_t lane = (nodes.step + 7) / 8 * 8;
  const double whole = deviationOf(cut_off);
  const double turn = others / last, spread = deviationOf(others) * last / cut_off;
  for (std::size_t k = 0; k < RegressionAxis::kOrders; ++k) {
    axis.up[k].assign(static_cast<std::size_t>(nodes.nodes_up * lane), 0.0);
    for (std::int32_t t = 0; t < nodes.nodes_up; ++t)
      for (std::int32_t p = 0; p < nodes.step; ++p) {
        // From the sample to the node.
        const double d = (t - nodes.up_before) * nodes.step - p;
        if (std::fabs(d) > kReach * last) continue;
        axis.up[k][static_cast<std::size_t>(t * lane + p)] =
            weightOf(d, last) *
            (others == 0.0 ? power(d / whole, k) : power(turn, k) * hermite(k, d / spread));
      }
  }
  if (others > 0.0) {
    // All three, or both, at distance 0, as integrals: what sums over nodes are.
    const double step = nodes.step, first = kShort * step;
    const double root = std::sqrt(2.0 * std::numbers::pi) * deviationOf(1.0);
    const double middle = std::sqrt(std::max(others * others - first * first, 0.0));
    axis.one = nodes.far == 0 ? root * first * last / cut_off / step
                              : root * root * first * middle * last / cut_off / (step * step);
  }
  return axis;
}

GaussianRegression::GaussianRegression(const FieldReader& field, double nesting_mm, CpuLevel level)
    : reader_(field),
      x_(regressionAxis(nesting_mm / field.grid().spacingXMm(), field.width())),
      y_(regressionAxis(nesting_mm / field.grid().spacingYMm(), field.height())),
      level_(level),
      sums_(x_.nodes, y_.nodes, level) {}

bool GaussianRegression::prepare(const SampleValues& samples, const JobControl& job) {
  samples_ = samples;
  // Sums of the whole would be many times the field: blocks have their own.
  return inBlocks() || sums_.make(reader_, samples_, {0, 0, reader_.width(), reader_.height()}, true, job);
}

bool GaussianRegression::fill(const SampleRect& rect, float* out, std::ptrdiff_t stride,
                              const JobControl& job) {
  if (!inBlocks()) {
    heightsOf(sums_, rect, out, stride);
    return true;
  }
  GaussianPlane own(x_.nodes, y_.nodes, level_);
  if (!own.make(reader_, samples_, rect, false, job)) return false;
  heightsOf(own, rect, out, stride);
  return true;
}

void GaussianRegression::heightsOf(const GaussianPlane& plane, const SampleRect& rect, float* out,
                                   std::ptrdiff_t stride) {
  const auto slideRow = FETTLE_AT_LEVEL(level_, slide);
  const auto spreadRow = FETTLE_AT_LEVEL(level_, spreadOut);
  const auto regression = FETTLE_AT_LEVEL(level_, regressionRow);
  const GaussianAxis &x = x_.nodes, &y = y_.nodes;
  const GaussianPlane::Sums sums = plane.sumsFor(rect);
  const std::int32_t shift = rect.column % x.step;
  const std::int32_t steps = (rect.column + rect.columns - 1) / x.step - rect.column / x.step + 1;
  const std::ptrdiff_t wide = std::ptrdiff_t{steps} * x.step + kBehind, apart = wide * sums.rows;
  Scratch& scratch = scratches_.local();
  constexpr std::size_t kWeights = 5, kHeights = 3;
  scratch.planes.resize((kWeights + kHeights) * static_cast<std::size_t>(apart) + kBehind);
  for (std::size_t k = 0; k < kWeights + kHeights; ++k) {
    const bool heights = k >= kWeights;
    const double* const up = x_.up[heights ? k - kWeights : k].data();
    const double* const from = heights ? sums.value : sums.weight;
    double* const to = scratch.planes.data() + static_cast<std::ptrdiff_t>(k) * apart;
    for (std::int32_t r = 0; r < sums.rows; ++r)
      if (x.step > 1) {
        spreadRow(from + r * sums.stride, x.step, up, x.nodes_up, to + r * wide, steps);
      } else {
        // One weight for each node, 8 places apart.
        scratch.taps.resize(static_cast<std::size_t>(x.nodes_up));
        for (std::int32_t t = 0; t < x.nodes_up; ++t)
          scratch.taps[static_cast<std::size_t>(t)] = up[std::ptrdiff_t{t} * 8];
        slideRow(from + r * sums.stride, 1, scratch.taps.data(), x.nodes_up, to + r * wide, rect.columns);
      }
  }
  const std::int32_t lane = (y.step + 7) / 8 * 8;
  const auto taps = static_cast<std::size_t>(y.nodes_up);
  scratch.taps.resize(RegressionAxis::kOrders * taps);
  const double least = kLeastWeight * x_.one * y_.one;
  for (std::int32_t r = 0; r < rect.rows; ++r) {
    const std::int32_t phase = (rect.row + r) % y.step;
    const std::int32_t first = (rect.row + r) / y.step - rect.row / y.step;
    for (std::size_t k = 0; k < RegressionAxis::kOrders; ++k)
      for (std::size_t t = 0; t < taps; ++t)
        scratch.taps[k * taps + t] =
            y_.up[k][t * static_cast<std::size_t>(lane) + static_cast<std::size_t>(phase)];
    regression(scratch.planes.data() + first * wide + shift, apart, wide, scratch.taps.data(), y.nodes_up,
               least, kLeastDetermined, out + r * stride, rect.columns);
  }
}

}  // namespace fettle::engine
