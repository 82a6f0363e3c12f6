#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/field/reader.h"
#include "shaders/layout.h"

namespace fettle::render {

/// How far a coarse surface lies from the fine one, as measured.
///
/// The surface at level k has a vertex at every 2^k-th sample (and at the last column and row, where that
/// cuts a cell short), two triangles per cell, their common edge from the cell's upper left to its lower right
/// corner. Level 0 is the surface at full resolution. A patch of level k has kPatchCells x kPatchCells such
/// cells and covers a square of kPatchCells * 2^k samples; patch (x, y) begins at sample (x, y) * kPatchCells
/// * 2^k.
///
/// Two numbers per patch [height_unit, without the sign of the version]:
///
///   deviation  no point of the patch lies higher above or below the surface of level 0 than this. The edges
///              of a coarse cell and its diagonal are edges of the fine surface too, so the difference of the
///              two is linear on every fine triangle and largest at a sample: reading the samples is
///              enough. In cells cut short by the field's end the diagonals differ; their kink is added.
///              Levels 1 .. 6 are measured at every sample; above, the difference between level k and k - 1
///              is measured at the vertices of k - 1 and added to the deviation of the four patches below
///              (triangle inequality).
///   excess     upper limit of how far samples of a cell lie above the highest or below the lowest of its
///              vertices. A step between two samples has a large deviation and no excess: every height on it
///              is drawn, at most one cell away from its position. Infinite where a cell holds a hole.
///
/// A hole at a vertex takes the height that shaders/field.glsl gives it, so the drawn surface is what is
/// measured. Where no such height exists, the deviation is infinite if the cell shows anything. Rounding is
/// included: four units in the last place of the highest magnitude are added.
///
/// Measuring may be spread over many frames: begin() and invalidate() set what is unknown, and measureSome()
/// measures a part of it. Until a patch is known, both its numbers are infinite, which is a valid bound for
/// any surface; so are those of every patch above it.
///
/// Memory: about 0.03 bytes per sample. Threading: measuring uses all cores and blocks; reading while it runs
/// is a race. Determinism: the same bits for any thread count and for any order and division of the
/// measuring.
class DetailMeasure {
 public:
  struct Error {
    float deviation = 0.0F;
    float excess = 0.0F;
  };

  /// A field of which nothing is known yet. Cost: 0.03 bytes per sample are written.
  void begin(const engine::FieldReader& reader);
  /// What depends on the samples of these tiles (column, row) is unknown from now on; everything, where they are half of all.
  /// Requires begin().
  void invalidate(const engine::FieldReader& reader, std::span<const glm::ivec2> tiles);
  /// Measures up to `most` tiles of those that are unknown, the last invalidated ones first; returns their
  /// number. About 40 us of processor time each.
  std::size_t measureSome(const engine::FieldReader& reader, std::size_t most);
  /// Equal numbers where nothing was measured or invalidated in between, also for copies; never 0 after
  /// begin().
  [[nodiscard]] std::uint64_t state() const noexcept { return state_; }
  /// The same where nothing was invalidated: what was known then still is, and more may be.
  [[nodiscard]] std::uint64_t invalidated() const noexcept { return invalidated_; }
  /// Tiles that are not known.
  [[nodiscard]] std::size_t unknown() const noexcept { return waiting_.size(); }

  /// Measures all of a field, whatever was known before.
  void measure(const engine::FieldReader& reader);
  /// Measures again what depends on the samples of these tiles (column, row), and whatever else is unknown.
  void refresh(const engine::FieldReader& reader, std::span<const glm::ivec2> tiles);

  /// The level at which one patch covers the field.
  [[nodiscard]] int topLevel() const noexcept { return static_cast<int>(levels_.size()) - 1; }
  /// Patches across and up at level k, 0 <= k <= topLevel().
  [[nodiscard]] glm::ivec2 patches(int level) const noexcept;
  /// Of patch (x, y); zero at level 0.
  [[nodiscard]] Error error(int level, std::int32_t x, std::int32_t y) const noexcept {
    if (level == 0) return {};
    const Level& l = levels_[static_cast<std::size_t>(level)];
    return l.errors[static_cast<std::size_t>(y) * static_cast<std::size_t>(l.count.x) +
                    static_cast<std::size_t>(x)];
  }
  /// Samples along one side of a patch of this level.
  [[nodiscard]] static std::int32_t side(int level) noexcept { return gpu::kPatchCells << level; }

  /// Highest level that is measured tile by tile.
  static constexpr int kTileLevels = 6;

 private:
  struct Level {
    glm::ivec2 count{0, 0};
    std::vector<Error> errors;
  };
  [[nodiscard]] std::size_t indexOf(glm::ivec2 tile) const noexcept {
    return static_cast<std::size_t>(tile.y) * static_cast<std::size_t>(tiles_.x) +
           static_cast<std::size_t>(tile.x);
  }
  [[nodiscard]] std::vector<glm::ivec2> above(int level, std::span<const glm::ivec2> tiles) const;
  void measureTile(const engine::FieldReader& reader, glm::ivec2 tile);
  void gather(int level, glm::ivec2 patch);
  void nest(const engine::FieldReader& reader, int level, glm::ivec2 patch);

  glm::ivec2 size_{2, 2};  // virtual samples: see Placing
  glm::ivec2 tiles_{1, 1};
  std::vector<Level> levels_;
  // Of levels with patches larger than a tile: per tile, for each level up to kTileLevels.
  std::vector<std::array<Error, kTileLevels + 1>> tile_errors_;
  std::vector<glm::ivec2> waiting_;  // tiles that are not known, each once
  std::vector<bool> is_waiting_;     // by tile
  std::uint64_t state_ = 0;
  std::uint64_t invalidated_ = 0;
};

/// Height of a vertex as shaders/field.glsl computes it (drawnZ): the sample itself, or for a hole the first
/// height on the rings around it. NaN when there is none. `s` within the virtual field.
[[nodiscard]] float drawnHeight(const engine::FieldReader& reader, glm::ivec2 s,
                                std::int32_t stride) noexcept;

}  // namespace fettle::render
