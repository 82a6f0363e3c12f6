#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <functional>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/tile_range.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// The marks of one tile: bit c of element r is sample (c, r), as Tile::marks.
using MarkRows = std::array<std::uint64_t, kTileSide>;

/// What to do with the samples that an outline or a list takes in.
enum class MarkChange : std::uint8_t {
  kMark,    ///< holes among them stay unmarked: there is nothing to keep
  kUnmark,  ///< every mark goes, a hole's too
};

/// The marks that a tile should have. `rows` comes with those it has; bits outside the field are cleared
/// afterwards. Called from several threads at once, for another tile each.
using TileMarking =
    std::function<void(std::int32_t tile_column, std::int32_t tile_row, const Tile& tile, MarkRows& rows)>;

/// The same heights, sign and grid with other marks; tiles whose marks do not change stay shared with
/// `field`. `range` is cut to the field. Advances the job by one a tile of the range. Tiles on all workers of
/// the calling arena; same result for any thread count. Errors: cancelled, memory exhausted. Throws what
/// `marking` does.
[[nodiscard]] Result<Version> changeMarks(const Version& field, TileRange range, const TileMarking& marking,
                                          JobControl& job);

/// Adds or takes away the marks that `chosen` has a bit for.
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

/// No mark at all.
[[nodiscard]] Result<Version> clearMarks(const Version& field, JobControl& job);
/// Marks what is not marked and the other way round; holes end unmarked.
[[nodiscard]] Result<Version> invertMarks(const Version& field, JobControl& job);

}  // namespace fettle::engine
