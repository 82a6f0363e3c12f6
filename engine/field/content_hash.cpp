#include "engine/field/content_hash.h"

#include <bit>
#include <cmath>
#include <utility>

namespace fettle::engine {

namespace {

// Word by word where FNV takes bytes: one multiplication per sample. The shift mixes the high half into the
// low bits, which a multiplication alone would not do.
inline std::uint64_t mixed(std::uint64_t hash, std::uint32_t word) noexcept {
  constexpr std::uint64_t kPrime = 0x100000001b3;
  hash = (hash ^ word) * kPrime;
  return hash ^ hash >> 32;
}

}  // namespace

ContentHash::ContentHash(std::int32_t width, std::int32_t height) noexcept : width_(width) {
  hash_ = mixed(mixed(hash_, static_cast<std::uint32_t>(width)), static_cast<std::uint32_t>(height));
}

void ContentHash::addRow(const float* heights, const std::uint8_t* marks) noexcept {
  std::uint64_t hash = hash_;
  for (std::int32_t c = 0; c < width_; ++c)
    hash = mixed(hash, std::isnan(heights[c]) ? 0x7fc00000U : std::bit_cast<std::uint32_t>(heights[c]));
  std::uint32_t word = 0;
  for (std::int32_t c = 0; c < width_; ++c) {
    word = word << 1 | (marks != nullptr ? marks[c] : 0U);
    if (c % 32 == 31 || c + 1 == width_) hash = mixed(hash, std::exchange(word, 0U));
  }
  hash_ = hash;
}

}  // namespace fettle::engine
