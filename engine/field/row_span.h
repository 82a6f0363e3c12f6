#pragma once

#include <cstdint>

namespace fettle::engine {

/// Rows [first, first + count) of a field, counted from the one with the lowest y.
struct RowSpan {
  std::int32_t first = 0, count = 0;

  [[nodiscard]] std::int32_t end() const noexcept { return first + count; }
  friend bool operator==(const RowSpan&, const RowSpan&) = default;
};

}  // namespace fettle::engine
