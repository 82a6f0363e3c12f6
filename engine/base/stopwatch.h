#pragma once

#include <chrono>

namespace fettle::engine {

/// Wall time since `start` [s], by a clock that is never set back.
[[nodiscard]] inline double secondsSince(std::chrono::steady_clock::time_point start) noexcept {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The same in milliseconds.
[[nodiscard]] inline double msSince(std::chrono::steady_clock::time_point start) noexcept {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace fettle::engine
