#include "engine/filter/gaussian_weights.h"

#include <cmath>
#include <cstddef>

namespace fettle::engine {

std::vector<double> gaussianHalfWeights(const FilterSpec& spec) {
  const int radius = spec.window / 2;
  std::vector<long double> exact(static_cast<std::size_t>(radius) + 1);
  if (spec.sigma == 0.0) {
    // C(n - 1, k) / 2^(n - 1): at most 2.7e299 before the scaling, and exact as long as it has 64 bits.
    long double c = 1.0L;
    for (int k = 0; k <= radius; ++k) {
      exact[static_cast<std::size_t>(radius - k)] = std::ldexp(c, -2 * radius);
      c = c * (2 * radius - k) / (k + 1);
    }
  } else {
    const auto sigma = static_cast<long double>(spec.sigma);
    long double sum = 0.0L;
    for (int k = radius; k >= 0; --k) {
      const long double w = std::exp(-0.5L * (k / sigma) * (k / sigma));
      exact[static_cast<std::size_t>(k)] = w;
      sum += k == 0 ? w : 2 * w;
    }
    for (long double& w : exact) w /= sum;
  }
  long double dropped = 0.0L;
  while (exact.size() > 1 && dropped + 2 * exact.back() <= std::ldexp(1.0L, -54)) {
    dropped += 2 * exact.back();
    exact.pop_back();
  }
  return {exact.begin(), exact.end()};
}

}  // namespace fettle::engine
