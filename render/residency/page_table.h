#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/vec2.hpp>

#include "engine/field/reader.h"
#include "shaders/layout.h"

namespace fettle::render {

/// A field lies on the device in levels: all samples, and copies with every 4th, 16th and 64th of them.
inline constexpr int kDataLevels = gpu::kDataLevels;
/// log2 of the step between the samples of a level.
[[nodiscard]] constexpr int dataShift(int level) noexcept {
  return 2 * level;
}

/// Samples of one level, the last ones included.
struct LevelSpan {
  int level = 0;
  glm::ivec2 low{0}, high{0};
};

/// The levels of a field cut into square pages of 2^log2_side samples of their level, numbered: level by
/// level from the finest, row by row, and behind them the pages of the rim - the last column and the last row
/// of the field at full resolution, one sample after the other, because coarse patches have vertices there
/// that lie on no coarse level.
///
///   level 0  +--+--+--+-    level 1  +--+-    rim  +--+
///            | 0| 1| 2|              |12|          |17|  column: sample (last, y) is number y
///            +--+--+--+-             +--+-         +--+  row: sample (x, last) is number rimRow() + x
///
/// Threading: immutable.
class PageGrid {
 public:
  PageGrid() = default;
  /// Width and height > 0; log2_side >= 6, so that no tile lies on two pages of a level.
  PageGrid(std::int32_t width, std::int32_t height, int log2_side);

  [[nodiscard]] int log2Side() const noexcept { return log2_side_; }
  /// Columns and rows of a level's samples.
  [[nodiscard]] glm::ivec2 samples(int level) const noexcept {
    return (size_ - 1) / (1 << dataShift(level)) + 1;
  }
  /// Pages across and up a level.
  [[nodiscard]] glm::ivec2 pages(int level) const noexcept {
    return ((samples(level) - 1) >> log2_side_) + 1;
  }
  [[nodiscard]] int entry(int level, glm::ivec2 page) const noexcept {
    return first_[static_cast<std::size_t>(level)] + page.y * pages(level).x + page.x;
  }
  /// Where the entries of a level begin; level kDataLevels: those of the rim.
  [[nodiscard]] int first(int level) const noexcept { return first_[static_cast<std::size_t>(level)]; }
  [[nodiscard]] int entries() const noexcept { return entries_; }
  /// Level (kDataLevels: rim) and page of an entry; the pages of the rim form one row.
  struct Place {
    int level = 0;
    glm::ivec2 page{0};
  };
  [[nodiscard]] Place place(int entry) const noexcept;
  /// Number of the rim's first sample of the last row: a multiple of a tile's side.
  [[nodiscard]] int rimRow() const noexcept { return rim_row_; }
  [[nodiscard]] int rimSamples() const noexcept { return rim_row_ + size_.x; }
  /// Calls `visit(entry)` for the pages that contain a part of a span, clipped to its level.
  void over(LevelSpan span, const auto& visit) const {
    const glm::ivec2 last = samples(span.level) - 1;
    const glm::ivec2 low = glm::clamp(span.low, glm::ivec2(0), last) >> log2_side_;
    const glm::ivec2 high = glm::clamp(span.high, glm::ivec2(0), last) >> log2_side_;
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) visit(entry(span.level, {x, y}));
  }

  /// Identifies the content of a page without reading it: the tiles, or nodes of a version's tree, that the
  /// page consists of. Equal keys mean equal content as long as the versions they came from exist. Only null
  /// pointers: no key (the rim has none).
  using Key = std::array<const void*, 16>;
  [[nodiscard]] Key key(int entry, const engine::FieldReader& reader) const noexcept;

 private:
  glm::ivec2 size_{1, 1};
  int log2_side_ = 6;
  std::array<int, kDataLevels + 1> first_{};
  int entries_ = 0;
  int rim_row_ = 0;
};

/// The samples that patch (x, y) of a level needs for its vertices. `holed`: some of them may be holes, and
/// take the height of a finer neighbour (shaders/field.glsl, drawnZ).
[[nodiscard]] LevelSpan geometrySpan(int patch_level, glm::ivec2 patch, bool holed) noexcept;
/// The samples that it needs for colours at data level `level`, where differences are taken over `step`
/// samples.
[[nodiscard]] LevelSpan shadeSpan(int patch_level, glm::ivec2 patch, int level, int step) noexcept;

}  // namespace fettle::render
