#pragma once

#include <chrono>
#include <cstdint>

namespace fettle::engine {

/// Nanoseconds of std::chrono::steady_clock, which is CLOCK_MONOTONIC: changes of the wall clock do not affect
/// it. Any thread, wait-free.
[[nodiscard]] inline std::int64_t steadyNs() noexcept {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Time since it was made or assigned, by that clock.
class Stopwatch {
 public:
  [[nodiscard]] double ns() const noexcept { return static_cast<double>(steadyNs() - start_ns_); }
  [[nodiscard]] double ms() const noexcept { return 1e-6 * ns(); }
  [[nodiscard]] double seconds() const noexcept { return 1e-9 * ns(); }

 private:
  std::int64_t start_ns_ = steadyNs();
};

}  // namespace fettle::engine
