#include "engine/edges/chain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>

namespace fettle::engine {

namespace {

constexpr int kMostChange = 3;  // offsets from one point to the next
constexpr int kAround = 6;      // offsets around the likeliest that count for the mean
// A closed line is searched with its start and its end repeated, by some correlation lengths.
constexpr int kLead = 100;
constexpr float kImpossible = 1e18F;

using ChangeCosts = std::array<float, 2 * kMostChange + 1>;

// The least cost of arriving at each offset from those of `from`.
void step(const float* from, const ChangeCosts& change, int count, float* to) {
  for (int k = 0; k < count; ++k) {
    float least = kImpossible;
    const int low = std::max(0, k - kMostChange), high = std::min(count - 1, k + kMostChange);
    for (int e = low; e <= high; ++e)
      least = std::min(least, from[e] + change[static_cast<std::size_t>(k - e + kMostChange)]);
    to[k] = least;
  }
}

}  // namespace

Chain chainAlong(const ChainCosts& costs, double step_deviation, bool closed) {
  const int count = costs.offsets.count();
  const int n = static_cast<int>(costs.costs.size()) / count;
  const int lead = closed ? std::min(n, kLead) : 0;
  const int places = n + 2 * lead;
  ChangeCosts change;
  for (int e = -kMostChange; e <= kMostChange; ++e)
    change[static_cast<std::size_t>(e + kMostChange)] =
        static_cast<float>((e * Offsets::kStep) * (e * Offsets::kStep) / (step_deviation * step_deviation));
  const auto row = [&](int place) {
    return static_cast<std::size_t>(place) * static_cast<std::size_t>(count);
  };
  const auto costAt = [&](int place) { return costs.costs.data() + row((place - lead + n) % n); };

  // before: with the costs of the place itself; after: without.
  std::vector<float> before(row(places)), after(row(places), 0.0F);
  for (int place = 0; place < places; ++place) {
    float* here = before.data() + row(place);
    if (place > 0) step(before.data() + row(place - 1), change, count, here);
    std::transform(here, here + count, costAt(place), here, std::plus<>());
    // Only differences between offsets count: without the common part, floats stay exact on long lines.
    const float least = *std::min_element(here, here + count);
    for (float& cost : std::span(here, static_cast<std::size_t>(count))) cost -= least;
  }
  std::vector<float> next(static_cast<std::size_t>(count));
  for (int place = places - 2; place >= 0; --place) {
    const float* const later = after.data() + row(place + 1);
    std::transform(later, later + count, costAt(place + 1), next.begin(), std::plus<>());
    const float least = *std::min_element(next.begin(), next.end());
    for (float& cost : next) cost -= least;
    step(next.data(), change, count, after.data() + row(place));
  }

  Chain chain;
  for (int i = 0; i < n; ++i) {
    const float* left = before.data() + row(i + lead);
    const float* right = after.data() + row(i + lead);
    int best = 0;
    for (int k = 1; k < count; ++k)
      if (left[k] + right[k] < left[best] + right[best]) best = k;
    double weight = 0.0, sum = 0.0, squares = 0.0;
    for (int k = std::max(0, best - kAround); k <= std::min(count - 1, best + kAround); ++k) {
      const double w =
          std::exp(-0.5 * (double{left[k]} + double{right[k]} - double{left[best]} - double{right[best]}));
      const double off = (k - best) * Offsets::kStep;
      weight += w;
      sum += w * off;
      squares += w * off * off;
    }
    const double mean = sum / weight;
    chain.likeliest.push_back(best);
    chain.mean.push_back(costs.offsets.at(best) + mean);
    chain.deviation.push_back(std::sqrt(std::max(0.0, squares / weight - mean * mean)));
  }
  return chain;
}

}  // namespace fettle::engine
