#pragma once

#include <cstdint>

namespace fettle::engine {

/// contentHash() (version.h) of a field whose rows come one after another, from row 0 on: for fields that are in memory in
/// parts only. One pass, in order: the hash of a whole does not follow from those of its parts.
/// Threading: one thread at a time.
class ContentHash {
 public:
  ContentHash(std::int32_t width, std::int32_t height) noexcept;

  /// The next row: `width` heights with the sign applied, and as many marks (0 or 1), or null for a row without any.
  void addRow(const float* heights, const std::uint8_t* marks) noexcept;

  /// Of all rows, once each was added.
  [[nodiscard]] std::uint64_t value() const noexcept { return hash_; }

 private:
  std::int32_t width_;
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

}  // namespace fettle::engine
