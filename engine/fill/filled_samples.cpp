#include "engine/fill/filled_samples.h"

#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "engine/field/live_field.h"
#include "engine/field/mark_setter.h"

namespace fettle::engine {

namespace {

// Bit c of row r of a tile: filled.
std::uint64_t filledOfRow(const Tile& tile, const Tile& original, int r) {
  std::uint64_t bits = 0;
  for (int c = 0; c < kTileSide; ++c) {
    const auto at = static_cast<std::size_t>(r * kTileSide + c);
    bits |= std::uint64_t{std::isnan(original.samples[at]) && !std::isnan(tile.samples[at])} << c;
  }
  return bits;
}

bool mayHaveFilled(const Tile& tile, const Tile& original) {
  return &tile != &original && original.nan_samples > 0 && tile.nan_samples < kTileSamples;
}

// A copy of `base` with change(tile, row, filled bits) applied to tiles with samples that were filled from `original` to `field`
// and that `takes` of the tile, row by row; bounds are computed again.
template <typename Takes, typename Change>
Result<Version> changed(const Version& base, const Version& field, const Version& original, const char* stage,
                        JobControl& job, const Takes& takes, const Change& change) {
  LiveField live(base, Growth::kAllowed);
  const FieldReader of = base.reader(), from = field.reader(), first = original.reader();
  bool any = false;
  job.begin(stage, static_cast<std::uint64_t>(from.tileRows()));
  for (std::int32_t tr = 0; tr < from.tileRows(); ++tr) {
    if (job.cancelled()) return cancelled();
    for (std::int32_t tc = 0; tc < from.tileColumns(); ++tc) {
      const Tile &now = from.tile(tc, tr), &was = first.tile(tc, tr);
      if (!mayHaveFilled(now, was)) continue;
      TileRef fresh;
      for (int r = 0; r < kTileSide; ++r) {
        const Tile& old = of.tile(tc, tr);
        const std::uint64_t filled = filledOfRow(now, was, r) & takes(old, r);
        if (filled == 0) continue;
        if (!fresh) {
          fresh = live.newTile();
          if (!fresh) return failure("there is not enough memory for the field", stage);
          *fresh = old;
        }
        change(*fresh, r, filled);
      }
      if (!fresh) continue;
      any = true;
      refreshBounds(*fresh, 0, 0, kTileSide, kTileSide);
      refreshMarks(*fresh);
      if (!live.replaceTile(tc, tr, std::move(fresh)))
        return failure("there is not enough memory for the field", stage);
    }
    job.advance();
  }
  return any ? live.snapshot() : base;
}

// All samples of a row.
constexpr auto kAny = [](const Tile&, int) { return ~std::uint64_t{0}; };

// Those with a height.
std::uint64_t heightsOfRow(const Tile& tile, int r) {
  std::uint64_t bits = 0;
  for (int c = 0; c < kTileSide; ++c)
    bits |= std::uint64_t{!std::isnan(tile.samples[static_cast<std::size_t>(r * kTileSide + c)])} << c;
  return bits;
}

// Holes in place of these samples, which have a height.
void takeHeights(Tile& tile, int r, std::uint64_t samples) {
  for (int c = 0; c < kTileSide; ++c)
    if ((samples >> c & 1U) != 0)
      tile.samples[static_cast<std::size_t>(r * kTileSide + c)] = std::numeric_limits<float>::quiet_NaN();
  tile.nan_samples += static_cast<std::uint32_t>(std::popcount(samples));
}

}  // namespace

Result<Version> withoutReplaced(const Version& original, const Version& between, const Version& field,
                                JobControl& job) {
  return changed(original, field, between, "leaving out replaced samples", job, heightsOfRow, takeHeights);
}

std::int64_t countFilled(const Version& field, const Version& original) {
  assert(field.grid().width == original.grid().width && field.grid().height == original.grid().height);
  const FieldReader now = field.reader(), was = original.reader();
  std::int64_t count = 0;
  for (std::int32_t tr = 0; tr < now.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < now.tileColumns(); ++tc)
      if (mayHaveFilled(now.tile(tc, tr), was.tile(tc, tr)))
        for (int r = 0; r < kTileSide; ++r)
          count += std::popcount(filledOfRow(now.tile(tc, tr), was.tile(tc, tr), r));
  return count;
}

Result<Version> withoutFilled(const Version& field, const Version& original, JobControl& job) {
  return changed(field, field, original, "leaving out filled samples", job, kAny, takeHeights);
}

Result<Version> withFilledMarked(const Version& field, const Version& original, OtherMarks others,
                                 JobControl& job) {
  Version start = field;
  if (others == OtherMarks::kGo) {
    MarkSetter setter(field);
    const std::vector<unsigned char> none(static_cast<std::size_t>(field.grid().width));
    for (std::int32_t r = field.grid().height - 1; r >= 0; --r)
      if (!setter.take(r, none.data()))
        return failure("there is not enough memory for the marks", "the field");
    start = setter.result();
  }
  return changed(
      start, start, original, "marking filled samples", job, kAny,
      [](Tile& tile, int r, std::uint64_t filled) { tile.marks[static_cast<std::size_t>(r)] |= filled; });
}

}  // namespace fettle::engine
