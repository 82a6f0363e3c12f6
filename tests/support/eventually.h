#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace fettle::tests {

/// Whether `holds` comes true within 30 s; looks again every millisecond. For what another thread or process
/// does.
[[nodiscard]] inline bool eventually(const std::function<bool()>& holds) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace fettle::tests
