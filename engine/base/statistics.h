#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace fettle::engine {

/// Figures of errors >= 0; all 0 without errors.
struct ErrorSummary {
  double mean = 0.0;
  double p99 = 0.0;  ///< 99th percentile, nearest rank
  double worst = 0.0;
};
[[nodiscard]] ErrorSummary errorSummary(std::vector<double> errors);

/// Figures of repeated times.
struct TimeSpread {
  double median = 0.0;
  double worst = 0.0;
};
/// `times` is not empty; asserted.
[[nodiscard]] TimeSpread timeSpread(std::vector<double> times);

/// FNV-1a (Fowler, Noll, Vo) over the bytes of doubles.
[[nodiscard]] std::uint64_t hashOf(std::span<const double> values);

}  // namespace fettle::engine
