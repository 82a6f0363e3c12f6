#pragma once

namespace fettle::engine {

/// Whether it is one of 0 to 9, in every locale.
[[nodiscard]] constexpr bool isDigit(char c) noexcept {
  return c >= '0' && c <= '9';
}

}  // namespace fettle::engine
