#pragma once

#include <cstddef>

namespace fettle::engine {

/// Whether a table has one row for each of `count` values of an enumeration, in its order, so that a value is
/// the index of its row; `key`: the member of a row that holds the value. For static_assert.
template <class Rows, class Row, class Enum>
[[nodiscard]] constexpr bool inOrder(const Rows& rows, Enum Row::*key, Enum count) {
  std::size_t i = 0;
  for (const Row& row : rows)
    if (static_cast<std::size_t>(row.*key) != i++) return false;
  return i == static_cast<std::size_t>(count);
}

}  // namespace fettle::engine
