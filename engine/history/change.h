#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/field/sample_rect.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// How far apart two versions are.
struct Change {
  std::int64_t tiles = 0;  ///< places of the table whose tile is another object
  std::int64_t nodes = 0;  ///< inner nodes that are other objects
  /// Around those tiles, clipped to the field: whole tiles, unchanged samples included; and around the edge lines that
  /// only one of them has.
  SampleRect rect;
  bool inverted = false;       ///< whether the signs differ
  std::size_t line_bytes = 0;  ///< of the lines of the later version, where they are other ones
  bool lines = false;          ///< whether the edge lines are other ones

  [[nodiscard]] bool none() const noexcept { return tiles == 0 && !inverted && !lines; }
  /// Memory of one version that the other does not share [bytes].
  [[nodiscard]] std::size_t bytes() const noexcept {
    return static_cast<std::size_t>(tiles) * sizeof(Tile) + static_cast<std::size_t>(nodes) * sizeof(Node) +
           line_bytes;
  }
};

/// Compares pointers, not samples: O(changed tiles), nothing is allocated. Both versions have one size and
/// one memory. Any thread.
[[nodiscard]] Change measureChange(const Version& before, const Version& after) noexcept;

}  // namespace fettle::engine
