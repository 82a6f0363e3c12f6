#pragma once

#include <cstdint>

namespace fettle::render {

/// Heights in [0, 256) without any order, the same on every machine.
inline double pebble(int c, int r) {
  const auto k = static_cast<std::uint32_t>(c) * 73856093U ^ static_cast<std::uint32_t>(r) * 19349663U;
  return static_cast<double>((k * 2654435761U) >> 20U) / 4096.0;
}

}  // namespace fettle::render
