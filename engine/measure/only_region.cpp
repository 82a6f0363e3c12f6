#include "engine/measure/only_region.h"

#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "engine/field/live_field.h"

namespace fettle::engine {

namespace {

// Bit c: the sample of a row has a height and is in the region.
std::uint64_t regionOfRow(const Tile& tile, int r, Region region) noexcept {
  std::uint64_t bits = 0;
  for (int c = 0; c < kTileSide; ++c)
    bits |= std::uint64_t{!std::isnan(tile.samples[static_cast<std::size_t>(r * kTileSide + c)])} << c;
  const std::uint64_t marks = tile.marks[static_cast<std::size_t>(r)];
  return region == Region::kAll ? bits : region == Region::kMarked ? bits & marks : bits & ~marks;
}

}  // namespace

Result<Version> onlyRegion(const Version& field, const Version& by, Region region, JobControl& job) {
  assert(field.grid().width == by.grid().width && field.grid().height == by.grid().height);
  const char* const stage = "leaving out other samples";
  const auto no_memory = [&] { return failure("there is not enough memory for the field", stage); };
  LiveField live(field, Growth::kAllowed);
  const FieldReader of = field.reader(), from = by.reader();
  bool any = false;
  job.begin(stage, static_cast<std::uint64_t>(of.tileRows()));
  for (std::int32_t tr = 0; tr < of.tileRows(); ++tr) {
    if (job.cancelled()) return cancelled();
    for (std::int32_t tc = 0; tc < of.tileColumns(); ++tc) {
      const Tile &old = of.tile(tc, tr), &chosen = from.tile(tc, tr);
      TileRef fresh;
      for (int r = 0; r < kTileSide; ++r) {
        const std::uint64_t gone = regionOfRow(old, r, Region::kAll) & ~regionOfRow(chosen, r, region);
        if (gone == 0) continue;
        if (!fresh) {
          fresh = live.newTile();
          if (!fresh) return no_memory();
          *fresh = old;
        }
        for (int c = 0; c < kTileSide; ++c)
          if ((gone >> c & 1U) != 0)
            fresh->samples[static_cast<std::size_t>(r * kTileSide + c)] =
                std::numeric_limits<float>::quiet_NaN();
        fresh->marks[static_cast<std::size_t>(r)] &= ~gone;
        fresh->nan_samples += static_cast<std::uint32_t>(std::popcount(gone));
      }
      if (!fresh) continue;
      any = true;
      refreshBounds(*fresh, 0, 0, kTileSide, kTileSide);
      refreshMarks(*fresh);
      if (!live.replaceTile(tc, tr, std::move(fresh))) return no_memory();
    }
    job.advance();
  }
  return any ? live.snapshot() : field;
}

}  // namespace fettle::engine
