#include "engine/edges/across.h"

#include <algorithm>
#include <cmath>

#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

// Prices, as chi-square: of a break where no stroke is, and of a stroke without a break. A plane has three
// parameters and its break one; 15 is what one chance in 500 gains by them, twice that keeps noise undivided.
constexpr double kFreeBreak = 30.0;
constexpr double kAbsentBreak = 15.0;
constexpr std::size_t kNarrowest = 4;  // bins of a segment: one sample
constexpr float kNever = 1e9F;

#define FETTLE_KERNEL "engine/edges/segments-inl.h"
#include "engine/simd/each_cpu-inl.h"

}  // namespace

AcrossSearch::AcrossSearch(const Model& model, CpuLevel level)
    : model_(model),
      fit_from_(FETTLE_AT_LEVEL(level, fitFrom)),
      bins_(static_cast<std::size_t>(std::lround(2.0 * model.depth / Offsets::kStep))),
      bin_(bins_),
      segments_((bins_ + 1) * (bins_ + 1), kNever),
      mirrored_(segments_) {
  for (std::vector<double>& sum : sums_) sum.resize(bins_ + 1);
}

void AcrossSearch::clear() {
  std::fill(bin_.begin(), bin_.end(), Moments{});
}

void AcrossSearch::add(const StripSample& sample, double s) noexcept {
  const double bin = std::floor((sample.d + model_.depth) / Offsets::kStep);
  if (bin >= 0.0 && bin < static_cast<double>(bins_))
    bin_[static_cast<std::size_t>(bin)].add(sample.d, s, sample.z);
}

void AcrossSearch::sumBins() {
  Moments sum;
  for (std::size_t edge = 0; edge <= bins_; ++edge) {
    const double parts[kMoments] = {sum.n,  sum.d, sum.s,  sum.dd, sum.ds,
                                    sum.ss, sum.z, sum.zd, sum.zs, sum.zz};
    for (std::size_t m = 0; m < kMoments; ++m) sums_[m][edge] = parts[m];
    if (edge < bins_) sum = sum + bin_[edge];
  }
}

Moments AcrossSearch::between(std::size_t low, std::size_t high) const noexcept {
  const auto part = [&](std::size_t m) { return sums_[m][high] - sums_[m][low]; };
  return {part(0), part(1), part(2), part(3), part(4), part(5), part(6), part(7), part(8), part(9)};
}

void AcrossSearch::fitSegments() {
  const double* sums[kMoments];
  for (std::size_t m = 0; m < kMoments; ++m) sums[m] = sums_[m].data();
  const std::size_t edges = bins_ + 1;
  for (std::size_t low = 0; low + kNarrowest < edges; ++low)
    fit_from_(sums, low, low + kNarrowest, edges, 1.0 / model_.variance, segments_.data() + low * edges);
  for (std::size_t low = 0; low + kNarrowest < edges; ++low)
    for (std::size_t high = low + kNarrowest; high < edges; ++high)
      mirrored_[(bins_ - high) * edges + bins_ - low] = segments_[low * edges + high];
}

float AcrossSearch::pull(double expected, std::size_t edge) const noexcept {
  const double off = (offsetOf(edge) - expected) / model_.deviation;
  return static_cast<float>(off * off);
}

void AcrossSearch::sweep(bool mirrored, std::span<const double> breaks, std::size_t levels, double temper,
                         bool free_breaks) {
  const std::size_t edges = bins_ + 1;
  const std::vector<float>& table = mirrored ? mirrored_ : segments_;
  Levels& costs = mirrored ? right_ : left_;
  costs.begin.assign((levels + 1) * edges, kNever);
  costs.end.assign((levels + 1) * edges, kNever);
  const auto price = static_cast<float>(temper);
  const float free_price = free_breaks ? price * static_cast<float>(kFreeBreak) : kNever;
  for (std::size_t level = 0; level <= levels; ++level) {
    float* begin = costs.begin.data() + level * edges;
    float* end = costs.end.data() + level * edges;
    if (level == 0) {
      begin[0] = 0.0F;
    } else {
      const double expected = mirrored ? breaks[breaks.size() - level] : breaks[level - 1];
      for (std::size_t b = 0; b < edges; ++b) {
        const float here = *(end - edges + b) + price * pull(expected, mirrored ? bins_ - b : b);
        const float absent = *(begin - edges + b) + price * static_cast<float>(kAbsentBreak);
        begin[b] = std::min(here, absent);
      }
    }
    for (std::size_t a = 0; a + kNarrowest < edges; ++a) {
      begin[a] = std::min(begin[a], end[a] + free_price);
      const float from = begin[a];
      if (from >= kNever) continue;
      const float* segment = table.data() + a * edges;
      for (std::size_t b = a + kNarrowest; b < edges; ++b) {
        const float to = from + segment[b];
        end[b] = to < end[b] ? to : end[b];
      }
    }
  }
}

void AcrossSearch::solve(std::span<const double> breaks, std::size_t own, std::span<float> costs,
                         std::span<Extent> extents) {
  sumBins();
  fitSegments();
  const std::size_t edges = bins_ + 1, after = breaks.size() - 1 - own;
  const auto first =
      static_cast<std::size_t>(std::lround((model_.depth - model_.offsets.reach) / Offsets::kStep));
  const auto count = static_cast<std::size_t>(model_.offsets.count());
  const double samples = std::max(1.0, sums_[0][bins_]);
  const auto leftOf = [&](std::size_t b) { return left_.end[own * edges + b]; };
  const auto rightOf = [&](std::size_t b) { return right_.end[after * edges + bins_ - b]; };

  double temper = 1.0;
  constexpr int kPasses = 3;  // without free breaks, with them, and with the final temper
  for (int pass = 0; pass < kPasses; ++pass) {
    sweep(false, breaks, own, temper, pass > 0);
    sweep(true, breaks, after, temper, pass > 0);
    if (pass + 1 == kPasses) break;
    float least = kNever;
    for (std::size_t b = first; b < first + count; ++b) least = std::min(least, leftOf(b) + rightOf(b));
    temper = std::max(1.0, double{least} / samples);
  }

  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t b = first + k;
    // The segments next to the break are those that gave the least cost.
    std::size_t low = 0, high = bins_;
    float best = kNever;
    for (std::size_t a = 0; a + kNarrowest <= b; ++a) {
      const float cost = left_.begin[own * edges + a] + segments_[a * edges + b];
      if (cost < best) best = cost, low = a;
    }
    best = kNever;
    for (std::size_t a = bins_; a >= b + kNarrowest; --a) {
      const float cost = right_.begin[after * edges + bins_ - a] + segments_[b * edges + a];
      if (cost < best) best = cost, high = a;
    }
    const double planes = double{leftOf(b)} + double{rightOf(b)};
    const double hinge = planes - double{segments_[low * edges + b]} - double{segments_[b * edges + high]} +
                         hingeResidual(between(low, b), between(b, high), offsetOf(b)) / model_.variance;
    costs[k] = static_cast<float>(std::min(planes, hinge) / temper) + pull(breaks[own], b);
    extents[k] = {static_cast<float>(offsetOf(low)), static_cast<float>(offsetOf(high))};
  }
}

}  // namespace fettle::engine
