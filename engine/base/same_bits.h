#pragma once

#include <cstring>
#include <type_traits>

namespace fettle::engine {

/// Whether two objects without padding have the same bits: equal NaN are the same, zeros of both signs are not.
template <class T>
[[nodiscard]] bool sameBits(const T& a, const T& b) noexcept {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::memcmp(static_cast<const void*>(&a), static_cast<const void*>(&b), sizeof(T)) == 0;
}

}  // namespace fettle::engine
