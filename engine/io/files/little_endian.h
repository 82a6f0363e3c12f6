#pragma once

#include <bit>
#include <cstring>
#include <string>

namespace fettle::engine {

static_assert(std::endian::native == std::endian::little, "numbers are taken as they lie in the file");

/// A number from any address, stored little-endian.
template <class T>
[[nodiscard]] T little(const char* bytes) noexcept {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// Appends a number, little-endian.
void appendLittle(std::string& bytes, auto number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

}  // namespace fettle::engine
