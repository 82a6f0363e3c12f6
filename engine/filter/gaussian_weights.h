#pragma once

#include <vector>

#include "engine/filter/filter.h"

namespace fettle::engine {

/// weights[k] of kGaussian for the distance k = 0 .. radius; their sum over -radius .. radius is 1 up to rounding. Weights far
/// out are dropped as long as all that is dropped is below 2^-54 of the whole: it and what renormalising makes of it are
/// below a fiftieth of what the double roundings may lose anyway, and of a binomial window of 101 that leaves 79.
[[nodiscard]] std::vector<double> gaussianHalfWeights(const FilterSpec& spec);

}  // namespace fettle::engine
