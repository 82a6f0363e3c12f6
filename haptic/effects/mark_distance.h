#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/field/line_cuts.h"
#include "engine/field/reader.h"
#include "engine/field/sample_rect.h"

namespace fettle::haptic {

/// Distance from samples to the nearest marked sample, or sample that an edge line passes, horizontal, in millimetres,
/// up to a reach. Exact for any spacings: Euclidean distance transform by two passes, columns then lower envelopes of parabolas.
/// Sparse: only tiles with a sample nearer than the reach have memory, 16 KiB each, in addition to 17 bytes
/// per tile of the field.
///
/// Follows the marks. markChanged() names what a tool changed, rescan() requests a check of every tile's
/// marks after the field was replaced; each advance() then does one slice of work, at most kLinesASlice
/// columns or rows of one tile, or the marks of kTilesASlice tiles. A tile takes at most 40 slices, so at 1
/// kHz a mark is in the field after about a tenth of a second. The constructor runs the same slices to
/// completion. A tile is replaced as a whole.
///
/// Source: Felzenszwalb and Huttenlocher, "Distance transforms of sampled functions" (2012), sections 2.1
/// and 3; rows cut at the reach, which a truncated distance allows.
/// Threading: constructed anywhere (allocates), then one thread: noexcept, allocates nothing. When the
/// preallocated tiles (kSpareTiles beyond those needed at first) are used up, a tile stays without distances,
/// counted.
class MarkDistance {
 public:
  static constexpr int kMostReach = 63;  // [samples]
  static constexpr int kSpareTiles = 128;
  static constexpr int kColumnsASlice = 8;
  static constexpr int kRowsASlice = 4;
  static constexpr int kTilesASlice = 64;

  /// `reach_mm` > 0; clamped to longestReachMm().
  /// `lines`: of the field, null without edge lines.
  MarkDistance(const engine::FieldReader& reader, const engine::LineCuts* lines, double reach_mm);

  /// 63 samples of the finer spacing.
  [[nodiscard]] static double longestReachMm(const engine::Grid& grid) noexcept;

  [[nodiscard]] double reachMm() const noexcept { return reach_mm_; }
  /// Distance of a sample of the field [mm]; the reach (rounded up to a float) when it is at least that far.
  [[nodiscard]] float at(std::int32_t column, std::int32_t row) const noexcept {
    const std::int32_t slot = slots_[static_cast<std::size_t>((row >> engine::kTileShift) * tile_columns_ +
                                                              (column >> engine::kTileShift))];
    if (slot < 0) return far_;
    const int within =
        (row & (engine::kTileSide - 1)) * engine::kTileSide + (column & (engine::kTileSide - 1));
    return memory_[static_cast<std::size_t>(slot) * engine::kTileSamples + static_cast<std::size_t>(within)];
  }

  /// Marks within the rectangle may have changed; it may reach beyond the field.
  void markChanged(std::int32_t column, std::int32_t row, std::int32_t columns, std::int32_t rows) noexcept;
  /// Marks anywhere may have changed.
  void rescan() noexcept { next_tile_ = 0; }
  /// One slice of work, if there is any. `reader` is of the same grid, whatever its marks are now.
  void advance(const engine::FieldReader& reader, const engine::LineCuts* lines) noexcept;
  /// Whether no work is left.
  [[nodiscard]] bool upToDate() const noexcept {
    return waiting_count_ == 0 && job_tile_ < 0 && next_tile_ >= tiles();
  }

  /// Tiles that could not have distances since construction.
  [[nodiscard]] std::int64_t refused() const noexcept { return refused_; }
  [[nodiscard]] std::size_t bytesHeld() const noexcept;
  /// Tiles with distances.
  [[nodiscard]] std::int32_t tilesHeld() const noexcept;

 private:
  static constexpr int kLongest = engine::kTileSide + 2 * kMostReach;  // of a line with its margins

  [[nodiscard]] std::int32_t tiles() const noexcept { return tile_columns_ * tile_rows_; }
  void requestTile(std::int32_t tc, std::int32_t tr) noexcept;
  void scanSlice(const engine::FieldReader& reader, const engine::LineCuts* lines) noexcept;
  void startJob(const engine::FieldReader& reader, const engine::LineCuts* lines) noexcept;
  void columnSlice(const engine::FieldReader& reader, const engine::LineCuts* lines) noexcept;
  void addLines(const engine::LineCuts& lines, const engine::SampleRect& block) noexcept;
  void rowSlice() noexcept;
  void finishJob() noexcept;

  std::int32_t tile_columns_, tile_rows_, width_, height_;
  double sx_, sy_, reach_mm_;
  float far_;
  int reach_columns_, reach_rows_;

  std::vector<std::int32_t> slots_;      // by tile: its place in memory_ or -1
  std::vector<std::uint64_t> prints_;    // by tile: hash of its marks and lines when last read, 0 without
  std::vector<std::uint8_t> requested_;  // by tile: waits
  std::vector<std::int32_t> waiting_;    // ring of tiles
  std::size_t waiting_head_ = 0, waiting_count_ = 0;
  std::vector<float> memory_;
  std::vector<std::int32_t> free_slots_;
  std::int32_t next_tile_ = 0;
  std::int64_t refused_ = 0;

  // The job: one tile, its columns with the margins on both sides, then its rows.
  std::int32_t job_tile_ = -1;
  int job_line_ = 0;
  bool job_within_reach_ = false;  // some sample is nearer than the reach
  bool job_in_rows_ = false;
  std::array<std::uint8_t, static_cast<std::size_t>(kColumnsASlice) * kLongest> marks_{};
  std::array<std::uint8_t, static_cast<std::size_t>(engine::kTileSide) * kLongest> vertical_{};
  std::array<float, engine::kTileSamples> result_{};
};

}  // namespace fettle::haptic
