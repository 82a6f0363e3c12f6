#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace fettle::engine {

// Random numbers without a state: a hash of (seed, stream, column, row), so that a value does not depend on
// earlier calls, on the thread, or on the size of the part of the field.
//   Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2, 3 (2011): the idea.
//   Steele, Lea, Flood: Fast splittable pseudorandom number generators (2014): the mixing step (SplitMix64).
//   Box, Muller: A note on the generation of random normal deviates (1958): uniform to normal.

/// SplitMix64's finaliser: a bijection of 64-bit words in which every input bit affects every output bit.
[[nodiscard]] constexpr std::uint64_t mixBits(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

/// One independent stream of numbers over the plane.
class CounterRandom {
 public:
  constexpr CounterRandom(std::uint64_t seed, std::uint64_t stream) noexcept
      : key_(mixBits(mixBits(seed) ^ mixBits(~stream))) {}

  /// 64 equally likely bits for the sample (column, row); either may be negative.
  [[nodiscard]] constexpr std::uint64_t bits(std::int32_t column, std::int32_t row) const noexcept {
    const std::uint64_t counter =
        (std::uint64_t{static_cast<std::uint32_t>(row)} << 32) | static_cast<std::uint32_t>(column);
    return mixBits(mixBits(counter ^ key_) + key_);
  }

  /// Uniform in [0, 1), a multiple of 2^-53.
  [[nodiscard]] constexpr double uniform(std::int32_t column, std::int32_t row) const noexcept {
    return static_cast<double>(bits(column, row) >> 11) * 0x1p-53;
  }

  /// Standard normal; within +-6.7 by the 32 bits behind its radius.
  [[nodiscard]] double normal(std::int32_t column, std::int32_t row) const noexcept {
    const std::uint64_t word = bits(column, row);
    const double u = (static_cast<double>(word >> 32) + 0.5) * 0x1p-32;  // in (0, 1)
    const double turn = static_cast<double>(word & 0xffffffffU) * 0x1p-32;
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * turn);
  }

 private:
  std::uint64_t key_;
};

}  // namespace fettle::engine
