#pragma once

#include <ctime>

#include <algorithm>
#include <functional>
#include <vector>

#include "engine/base/stopwatch.h"

namespace fettle::bench {

/// Spacing of the synthetic parts that benchmarks touch and filter [mm], as `fettle synth` makes them.
inline constexpr double kSpacingMm = 0.05;

/// Wall time of one run of `work` [s].
[[nodiscard]] inline double secondsOf(const std::function<void()>& work) {
  const engine::Stopwatch watch;
  work();
  return watch.seconds();
}

/// Processor time of this process so far [s], of all its threads.
[[nodiscard]] inline double processorSeconds() noexcept {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

/// The middle one of repeated times, the upper of two. `values` is not empty.
[[nodiscard]] inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace fettle::bench
