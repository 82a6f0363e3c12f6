#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <functional>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// The marks of one tile: bit c of element r is sample (c, r), as Tile::marks.
using MarkRows = std::array<std::uint64_t, kTileSide>;

/// What to do with the samples inside an outline or in a list.
enum class MarkChange : std::uint8_t {
  kMark,    ///< holes among them stay unmarked: they have no height to keep
  kUnmark,  ///< every mark is removed, also of a hole
};

/// The marks that a tile should have. `rows` contains the present ones; bits outside the field are cleared
/// afterwards. Called from several threads at the same time, for different tiles.
using TileMarking =
    std::function<void(std::int32_t tile_column, std::int32_t tile_row, const Tile& tile, MarkRows& rows)>;

/// The same heights, sign and grid with other marks; tiles whose marks do not change stay shared with
/// `field`. `range` is clipped to the field. Advances the job by one per tile of the range. Tiles on all
/// workers of the calling arena; same result for any thread count. Errors: cancelled, memory exhausted.
/// Throws what `marking` throws.
[[nodiscard]] Result<Version> changeMarks(const Version& field, TileRange range, const TileMarking& marking,
                                          JobControl& job);

/// Adds or removes the marks that `chosen` has a bit for.
inline void applyChange(const Tile& tile, const MarkRows& chosen, MarkChange change,
                        MarkRows& rows) noexcept {
  for (int r = 0; r < kTileSide; ++r) {
    const auto i = static_cast<std::size_t>(r);
    if (change == MarkChange::kUnmark) {
      rows[i] &= ~chosen[i];
      continue;
    }
    std::uint64_t fresh = chosen[i] & ~rows[i];
    if (tile.nan_samples != 0)
      for (std::uint64_t left = fresh; left != 0; left &= left - 1) {
        const int c = std::countr_zero(left);
        const float height = tile.samples[i * kTileSide + static_cast<std::size_t>(c)];
        if (height != height) fresh &= ~(std::uint64_t{1} << c);
      }
    rows[i] |= fresh;
  }
}

/// Removes all marks.
[[nodiscard]] Result<Version> clearMarks(const Version& field, JobControl& job);
/// Marks what is not marked and vice versa; holes become unmarked.
[[nodiscard]] Result<Version> invertMarks(const Version& field, JobControl& job);

}  // namespace fettle::engine
