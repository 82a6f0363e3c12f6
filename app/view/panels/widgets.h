#pragma once

#include <cstdint>
#include <string>

namespace fettle::app {

/// "name      value" on one line of a panel.
void figure(const char* name, const std::string& value);

/// "17.2 kB".
[[nodiscard]] std::string bytesText(double bytes);

[[nodiscard]] constexpr double microseconds(std::int64_t ns) noexcept {
  return 1e-3 * static_cast<double>(ns);
}

}  // namespace fettle::app
