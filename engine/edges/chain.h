#pragma once

#include <vector>

#include "engine/edges/offsets.h"

namespace fettle::engine {

/// Costs of the offsets at each point of a line: chi-square, [point * offsets.count() + k].
struct ChainCosts {
  Offsets offsets;
  std::vector<float> costs;
};

/// Where a line runs: at each point the offset of the likeliest way, the mean around it and its standard
/// deviation [samples].
struct Chain {
  std::vector<int> likeliest;  ///< number of the offset
  std::vector<double> mean;
  std::vector<double> deviation;
};

/// The likeliest way through the offsets when they change by a normal deviate of `step_deviation` [samples] from
/// point to point, at most three offsets: Viterbi, Error bounds for convolutional codes (1967). The cost of the
/// best way through each offset, as the exponent of a density, gives mean and standard deviation: what a
/// least-squares solution has if the costs are quadratic. `closed`: the last point is followed by the first.
[[nodiscard]] Chain chainAlong(const ChainCosts& costs, double step_deviation, bool closed);

}  // namespace fettle::engine
