#include "engine/filter/block_pass.h"

#include <algorithm>
#include <cmath>

#include "engine/field/live_field.h"
#include "engine/filter/limit_change.h"
#include "engine/simd/prefetch.h"

namespace fettle::engine {

namespace {

void fetchRows(const Tile& tile, int begin, int end) noexcept {
  constexpr int kLine = 16;  // samples in a line of the cache
  for (int i = begin * kTileSide; i < end * kTileSide; i += kLine) fetchAhead(tile.samples.data() + i);
}

// All of a tile but its samples and blocks, which a merge reads.
void fetchSummary(const Tile& tile) noexcept {
  for (std::size_t row = 0; row < kTileSide; row += 8) fetchAhead(&tile.marks[row]);
  fetchAhead(&tile.bounds);
}

// Orders tiles as a walk over the tree meets them, and so as changedTiles does: eight by eight on every
// level.
std::uint64_t placeInTree(std::int32_t column, std::int32_t row) noexcept {
  std::uint64_t place = 0;
  for (int shift = 27; shift >= 0; shift -= 3)
    place = place << 6 | static_cast<std::uint64_t>((row >> shift & 7) << 3 | (column >> shift & 7));
  return place;
}

}  // namespace

BlockPass::BlockPass(const Version& input, const Version& original, const FilterSpec& spec, int radius,
                     int halo, CpuLevel level)
    : input_(input),
      memory_(*input.memory()),
      reader_(input.reader()),
      original_(original.reader()),
      spec_(spec),
      radius_(radius),
      halo_(halo),
      same_field_(&reader_.root() == &original_.root()),
      level_(level),
      cuts_(input.lineCuts()) {}

// Whether any sample of the tile can come out different.
bool BlockPass::mayChange(std::int32_t tc, std::int32_t tr) const noexcept {
  // The tile itself is mostly not near the core yet.
  const auto [tile, bounds, marked, holed] = reader_.entry(tc, tr);
  if (bounds.empty()) return false;
  const auto [columns, rows] = extent(tc, tr);
  if (spec_.scope == FilterScope::kOnlyMarks && !marked) return false;
  if (spec_.scope == FilterScope::kKeepMarks && marked &&
      tile->marked_samples == static_cast<std::uint32_t>(columns * rows))
    return false;
  const bool limit_may_act = spec_.max_change.has_value() && !same_field_ && &original_.tile(tc, tr) != tile;
  if (limit_may_act) return true;
  if (radius_ == 0) return false;
  // A window in which all samples are equal has them for its mean and its median, and nothing to smooth.
  return !(bounds.min == bounds.max && flatAround(tc, tr, bounds.min));
}

bool BlockPass::flatAround(std::int32_t tc, std::int32_t tr, float height) const noexcept {
  const std::int32_t reach = (radius_ + kTileSide - 1) / kTileSide;
  for (std::int32_t y = std::max(tr - reach, 0); y <= std::min(tr + reach, reader_.tileRows() - 1); ++y)
    for (std::int32_t x = std::max(tc - reach, 0); x <= std::min(tc + reach, reader_.tileColumns() - 1);
         ++x) {
      const HeightBounds b = reader_.entry(x, y).bounds;
      if (!b.empty() && !(b.min == height && b.max == height)) return false;
    }
  return true;
}

std::pair<int, int> BlockPass::extent(std::int32_t tc, std::int32_t tr) const noexcept {
  return {std::min(kTileSide, reader_.width() - tc * kTileSide),
          std::min(kTileSide, reader_.height() - tr * kTileSide)};
}

TileRect BlockPass::toChange(const TileRect& rect) const noexcept {
  TileRect kept{rect.column1, rect.row1, rect.column0, rect.row0};
  for (std::int32_t tr = rect.row0; tr < rect.row1; ++tr)
    for (std::int32_t tc = rect.column0; tc < rect.column1; ++tc)
      if (mayChange(tc, tr))
        kept = {std::min(kept.column0, tc), std::min(kept.row0, tr), std::max(kept.column1, tc + 1),
                std::max(kept.row1, tr + 1)};
  return kept.column0 < kept.column1 ? kept : TileRect{0, 0, 0, 0};
}

std::int64_t BlockPass::samplesOf(const TileRect& rect) const noexcept {
  const std::int64_t columns = std::min(rect.column1 * kTileSide, reader_.width()) - rect.column0 * kTileSide;
  const std::int64_t rows = std::min(rect.row1 * kTileSide, reader_.height()) - rect.row0 * kTileSide;
  return columns * rows;
}

Block BlockPass::gather(const TileRect& rect, BlockScratch& scratch) const {
  const std::int32_t c0 = rect.column0 * kTileSide;
  const std::int32_t r0 = rect.row0 * kTileSide;
  const std::int32_t c1 = std::min(rect.column1 * kTileSide, reader_.width());
  const std::int32_t r1 = std::min(rect.row1 * kTileSide, reader_.height());
  const std::int32_t left = std::max(c0 - halo_, 0);
  const std::int32_t low = std::max(r0 - halo_, 0);
  Block block;
  block.columns = std::min(c1 + halo_, reader_.width()) - left;
  block.rows = std::min(r1 + halo_, reader_.height()) - low;
  // Rows end with room for a vector, so that kernels may read and write beyond them.
  block.stride = (block.columns + 31) / 16 * 16;
  block.first_column = c0 - left;
  block.first_row = r0 - low;
  block.out_columns = c1 - c0;
  block.out_rows = r1 - r0;
  block.out_stride = (rect.column1 - rect.column0) * kTileSide;
  scratch.out_stride = block.out_stride;
  scratch.heights.resize(static_cast<std::size_t>(block.stride) * static_cast<std::size_t>(block.rows));
  scratch.out.resize(static_cast<std::size_t>(block.out_stride) * static_cast<std::size_t>(block.out_rows));
  reader_.readHeights(left, low, block.columns, block.rows, scratch.heights.data(), block.stride);
  block.heights = scratch.heights.data();
  block.cuts = cuts_;
  block.left = left;
  block.low = low;
  block.out = scratch.out.data();
  surveyTiles(left, low, block);
  return block;
}

// What the tiles under a block's samples know about them: whether there are holes, and the magnitudes.
void BlockPass::surveyTiles(std::int32_t column, std::int32_t row, Block& block) const noexcept {
  for (std::int32_t tr = row / kTileSide; tr * kTileSide < row + block.rows; ++tr)
    for (std::int32_t tc = column / kTileSide; tc * kTileSide < column + block.columns; ++tc) {
      const Tile& tile = reader_.tile(tc, tr);
      const auto [c, r] = extent(tc, tr);
      block.holes |= tile.nan_samples > static_cast<std::uint32_t>(kTileSamples - c * r);
      if (!tile.bounds.empty())
        block.magnitude = std::max({block.magnitude, std::fabs(tile.bounds.min), std::fabs(tile.bounds.max)});
    }
}

bool BlockPass::merge(const TileRect& rect, float sign, std::int32_t to_next, BlockScratch& scratch,
                      std::vector<NewTile>& made) {
  for (std::int32_t tr = rect.row0; tr < rect.row1; ++tr)
    for (std::int32_t tc = rect.column0; tc < rect.column1; ++tc) {
      if (!mayChange(tc, tr)) continue;
      const float* results = scratch.out.data() + (tr - rect.row0) * kTileSide * scratch.out_stride +
                             (tc - rect.column0) * kTileSide;
      const bool more = to_next > 0 && tc + to_next + 1 < reader_.tileColumns();
      const Tile* ahead = more ? &reader_.tile(tc + to_next + 1, tr) : nullptr;
      if (!mergeOne(tc, tr, results, sign, ahead, scratch, made)) return false;
    }
  return true;
}

std::optional<TileAround> BlockPass::around(std::int32_t tc, std::int32_t tr) const noexcept {
  if (tc < 1 || tr < 1 || tc + 1 >= reader_.tileColumns() || tr + 1 >= reader_.tileRows()) return {};
  TileAround around;
  for (std::int32_t r = 0; r < 3; ++r)
    for (std::int32_t c = 0; c < 3; ++c) {
      const FieldReader::TileEntry entry = reader_.entry(tc + c - 1, tr + r - 1);
      const auto [columns, rows] = extent(tc + c - 1, tr + r - 1);
      if (entry.holed || columns < kTileSide || rows < kTileSide) return {};
      around[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = entry.tile->samples.data();
    }
  return around;
}

bool BlockPass::mergeTileAt(std::int32_t tc, std::int32_t tr, BlockScratch& scratch,
                            std::vector<NewTile>& made) {
  // While it computes a tile a window reads a part of the next one as well.
  const Tile* ahead = tc + 2 < reader_.tileColumns() ? &reader_.tile(tc + 2, tr) : nullptr;
  if (ahead != nullptr) {
    fetchSummary(*ahead);
    const int rows = std::min(radius_, kBlockSide);
    fetchRows(reader_.tile(tc + 2, tr - 1), kTileSide - rows, kTileSide);
    fetchRows(reader_.tile(tc + 2, tr + 1), 0, rows);
  }
  scratch.out_stride = kTileSide;
  return mergeOne(tc, tr, scratch.results.data(), 1.0F, ahead, scratch, made);
}

// Puts the results of one tile together with what must stay, and makes a tile of it if any bit changed.
bool BlockPass::mergeOne(std::int32_t tc, std::int32_t tr, const float* results, float sign,
                         const Tile* ahead, BlockScratch& scratch, std::vector<NewTile>& made) {
  const Tile& before = reader_.tile(tc, tr);
  const auto [columns, rows] = extent(tc, tr);
  std::ptrdiff_t stride = scratch.out_stride;
  if (spec_.max_change.has_value() || columns < kTileSide || rows < kTileSide) {
    clampToOriginal(tc, tr, results, stride, sign, scratch.one_tile.data());
    results = scratch.one_tile.data();
    stride = kTileSide;
    sign = 1.0F;
  }
  TileRef after = TileRef::adopt(memory_.bulk().acquire());
  if (!after) {
    // Relaxed: read after the join of the parallel loop, which orders everything.
    out_of_memory_.store(true, std::memory_order_relaxed);
    return false;
  }
  const TileReport report = mergeTile(before, results, stride, sign, spec_.scope, *after, level_, ahead);
  if (report.changed != 0) made.push_back({tc, tr, std::move(after), report});
  return true;
}

// Results as a tile holds them, without the version's sign, and within the largest change allowed; 0 where
// there is no sample.
void BlockPass::clampToOriginal(std::int32_t tc, std::int32_t tr, const float* results, std::ptrdiff_t stride,
                                float sign, float* stored) const noexcept {
  const auto [columns, rows] = extent(tc, tr);
  const float* old = reader_.tile(tc, tr).samples.data();
  const float* origin = original_.tile(tc, tr).samples.data();
  std::fill_n(stored, kTileSamples, 0.0F);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int at = r * kTileSide + c;
      if (old[at] != old[at]) continue;
      const float result = sign * results[r * stride + c];
      stored[at] =
          spec_.max_change.has_value() ? limitedChange(result, origin[at], *spec_.max_change) : result;
    }
}

Result<PassResult> BlockPass::finish(std::vector<NewTile> tiles) const {
  std::vector<std::pair<std::uint64_t, NewTile*>> placed;
  placed.reserve(tiles.size());
  for (NewTile& t : tiles) placed.emplace_back(placeInTree(t.column, t.row), &t);
  std::ranges::sort(placed, {}, &std::pair<std::uint64_t, NewTile*>::first);
  PassResult result;
  result.reports.reserve(placed.size());
  LiveField live(input_, Growth::kAllowed);
  bool room = !outOfMemory();
  constexpr std::size_t kAhead = 16;  // tiles whose bounds are fetched meanwhile
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (i + kAhead < placed.size()) fetchAhead(&placed[i + kAhead].second->tile->bounds);
    NewTile& t = *placed[i].second;
    result.reports.push_back(t.report);
    room = room && live.replaceTile(t.column, t.row, std::move(t.tile));
  }
  if (!room) return failure("memory for the filtered samples could not be had", "filter");
  result.field = live.snapshot();
  return result;
}

}  // namespace fettle::engine
