#pragma once

#include <cstdint>
#include <vector>

#include "engine/field/live_field.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// Replaces the marks of a field by those of a mask, row by row from the highest row to the lowest. Tiles whose marks do
/// not change stay shared with the field. Memory: one row of tiles of the mask. Thread: one at a time.
class MarkSetter {
 public:
  explicit MarkSetter(const Version& field);

  /// Row `row`, counted from the lowest, one less than in the call before; `mask`: `width` bytes, non-zero = marked. False,
  /// and the marks are not complete, when memory ran out.
  [[nodiscard]] bool take(std::int32_t row, const unsigned char* mask);

  /// The field with the marks, after row 0.
  [[nodiscard]] Version result() const { return live_.snapshot(); }

 private:
  [[nodiscard]] bool applyTileRow(std::int32_t tr);

  LiveField live_;
  std::int32_t width_;
  std::int32_t height_;
  std::vector<unsigned char> strip_;  // one tile row, lowest row first
};

}  // namespace fettle::engine
