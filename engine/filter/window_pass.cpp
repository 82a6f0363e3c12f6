#include "engine/filter/window_pass.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "engine/field/live_field.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/limit_change.h"
#include "engine/filter/line_windows.h"
#include "engine/filter/merge.h"

namespace fettle::engine {

namespace {

/// Tiles [column0, column1) x [row0, row1).
struct TileRect {
  std::int32_t column0, row0, column1, row1;
};

struct Scratch {
  std::unique_ptr<BlockFilter> filter;
  std::unique_ptr<BoxStrip> strip;
  std::vector<float> heights, out;
  std::ptrdiff_t out_stride = 0;
  alignas(64) std::array<float, kTileSamples> one_tile;
};

struct NewTile {
  std::int32_t column, row;
  TileRef tile;
  TileReport report;
};

class Pass {
 public:
  Pass(const WindowFilter& filter, const Version& input, const Version& original, const FilterSpec& spec,
       CpuLevel level)
      : filter_(filter),
        memory_(*input.memory()),
        reader_(input.reader()),
        original_(original.reader()),
        spec_(spec),
        radius_(filter.squares.side > 0 ? filter.squares.halo : filterOf(spec.kind).reach(spec)),
        same_field_(&reader_.root() == &original_.root()),
        halo_(filter.squares.side > 0 ? radius_
                                      : radius_ + (reachOf(spec, input) - reachOf(spec)) / spec.passes),
        level_(level),
        cuts_(input.lineCuts()) {}

  // Filters one rectangle of tiles; appends the tiles that changed. False when cancelled or out of memory.
  bool run(TileRect rect, Scratch& scratch, const JobControl& job, std::vector<NewTile>& made) {
    // The next block is mostly the right neighbour.
    const std::int32_t to_next = rect.column1 - rect.column0;
    const TileRect all = rect;
    shrink(rect);
    if (rect.column0 == rect.column1) return true;
    if (filter_.squares.side > 0) rect = all;
    if (filter_.strip != nullptr && radius_ > 0 && cuts_ == nullptr) {
      if (!scratch.strip) scratch.strip = filter_.strip(radius_, level_);
      if (scratch.strip) return runStrip(rect, scratch, job, made);
    }
    if (!gatherAndFilter(rect, scratch, job)) return false;
    return mergeAll(rect, reader_.sign(), to_next, scratch, made);
  }

  [[nodiscard]] bool outOfMemory() const noexcept { return out_of_memory_.load(std::memory_order_relaxed); }

 private:
  // As run, with a strip: one row of tiles after the other, with sums that run on from one to the next.
  bool runStrip(const TileRect& rect, Scratch& scratch, const JobControl& job, std::vector<NewTile>& made) {
    const std::int32_t c0 = rect.column0 * kTileSide;
    const std::int32_t c1 = std::min(rect.column1 * kTileSide, reader_.width());
    const std::int32_t r1 = std::min(rect.row1 * kTileSide, reader_.height());
    bool begun = false;
    for (std::int32_t tr = rect.row0; tr < rect.row1; ++tr) {
      if (job.cancelled()) return false;
      const TileRect band{rect.column0, tr, rect.column1, tr + 1};
      const std::int32_t r0 = tr * kTileSide;
      if (!begun) scratch.strip->begin(reader_, c0, c1, r0, r1 - r0);
      scratch.out_stride = (rect.column1 - rect.column0) * kTileSide;
      scratch.out.resize(static_cast<std::size_t>(scratch.out_stride) * kTileSide);
      begun = scratch.strip->rows(std::min(r1 - r0, kTileSide), scratch.out.data(), scratch.out_stride);
      if (!begun && !gatherAndFilter(band, scratch, job)) return false;
      if (!mergeAll(band, begun ? 1.0F : reader_.sign(), 0, scratch, made)) return false;
    }
    return true;
  }

  // Merges scratch.out, which has the sign `sign`, into the tiles of a rectangle, and fetches the tiles that
  // lie `to_next` further meanwhile, if any.
  bool mergeAll(const TileRect& rect, float sign, std::int32_t to_next, Scratch& scratch,
                std::vector<NewTile>& made) {
    for (std::int32_t tr = rect.row0; tr < rect.row1; ++tr)
      for (std::int32_t tc = rect.column0; tc < rect.column1; ++tc) {
        if (!mayChange(tc, tr)) continue;
        const float* results = scratch.out.data() + (tr - rect.row0) * kTileSide * scratch.out_stride +
                               (tc - rect.column0) * kTileSide;
        const bool more = to_next > 0 && tc + to_next + 1 < reader_.tileColumns();
        const Tile* ahead = more ? &reader_.tile(tc + to_next + 1, tr) : nullptr;
        if (!merge(tc, tr, results, sign, ahead, scratch, made)) return false;
      }
    return true;
  }

  // Whether any sample of the tile can come out different.
  [[nodiscard]] bool mayChange(std::int32_t tc, std::int32_t tr) const noexcept {
    const Tile& tile = reader_.tile(tc, tr);
    if (tile.nan_samples == kTileSamples) return false;
    const auto [columns, rows] = extent(tc, tr);
    if (spec_.scope == FilterScope::kOnlyMarks && tile.marked_samples == 0) return false;
    if (spec_.scope == FilterScope::kKeepMarks &&
        tile.marked_samples == static_cast<std::uint32_t>(columns * rows))
      return false;
    const bool limit_may_act =
        spec_.max_change.has_value() && !same_field_ && &original_.tile(tc, tr) != &tile;
    if (limit_may_act) return true;
    if (radius_ == 0) return false;
    // A window in which all samples are equal has them for its mean and its median, and nothing to smooth.
    return !(tile.bounds.min == tile.bounds.max && flatAround(tc, tr, tile.bounds.min));
  }

  [[nodiscard]] bool flatAround(std::int32_t tc, std::int32_t tr, float height) const noexcept {
    const std::int32_t reach = (radius_ + kTileSide - 1) / kTileSide;
    for (std::int32_t y = std::max(tr - reach, 0); y <= std::min(tr + reach, reader_.tileRows() - 1); ++y)
      for (std::int32_t x = std::max(tc - reach, 0); x <= std::min(tc + reach, reader_.tileColumns() - 1);
           ++x) {
        const HeightBounds& b = reader_.tile(x, y).bounds;
        if (!b.empty() && !(b.min == height && b.max == height)) return false;
      }
    return true;
  }

  [[nodiscard]] std::pair<int, int> extent(std::int32_t tc, std::int32_t tr) const noexcept {
    return {std::min(kTileSide, reader_.width() - tc * kTileSide),
            std::min(kTileSide, reader_.height() - tr * kTileSide)};
  }

  // Leaves out what lies outside the smallest rectangle of tiles that may change.
  void shrink(TileRect& rect) const noexcept {
    TileRect kept{rect.column1, rect.row1, rect.column0, rect.row0};
    for (std::int32_t tr = rect.row0; tr < rect.row1; ++tr)
      for (std::int32_t tc = rect.column0; tc < rect.column1; ++tc)
        if (mayChange(tc, tr))
          kept = {std::min(kept.column0, tc), std::min(kept.row0, tr), std::max(kept.column1, tc + 1),
                  std::max(kept.row1, tr + 1)};
    rect = kept.column0 < kept.column1 ? kept : TileRect{0, 0, 0, 0};
  }

  bool gatherAndFilter(const TileRect& rect, Scratch& scratch, const JobControl& job) {
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
    if (radius_ == 0) {
      for (int r = 0; r < block.out_rows; ++r)
        std::copy_n(block.row(r), block.out_columns, block.out + r * block.out_stride);
      return true;
    }
    if (!scratch.filter) {
      scratch.filter = filter_.make(spec_, level_);
      const Filter& kind = filterOf(spec_.kind);
      if (cuts_ != nullptr && kind.knows_lines && kind.window.exists())
        scratch.filter = endingAtLines(std::move(scratch.filter), radius_);
    }
    return scratch.filter->run(block, job);
  }

  // What the tiles under a block's samples know about them: whether there are holes, and the magnitudes.
  void surveyTiles(std::int32_t column, std::int32_t row, Block& block) const noexcept {
    for (std::int32_t tr = row / kTileSide; tr * kTileSide < row + block.rows; ++tr)
      for (std::int32_t tc = column / kTileSide; tc * kTileSide < column + block.columns; ++tc) {
        const Tile& tile = reader_.tile(tc, tr);
        const auto [c, r] = extent(tc, tr);
        block.holes |= tile.nan_samples > static_cast<std::uint32_t>(kTileSamples - c * r);
        if (!tile.bounds.empty())
          block.magnitude =
              std::max({block.magnitude, std::fabs(tile.bounds.min), std::fabs(tile.bounds.max)});
      }
  }

  // Puts the results of one tile together with what must stay, and makes a tile of it if any bit changed.
  bool merge(std::int32_t tc, std::int32_t tr, const float* results, float sign, const Tile* ahead,
             Scratch& scratch, std::vector<NewTile>& made) {
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
  void clampToOriginal(std::int32_t tc, std::int32_t tr, const float* results, std::ptrdiff_t stride,
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

  const WindowFilter& filter_;
  FieldMemory& memory_;
  FieldReader reader_;
  FieldReader original_;
  const FilterSpec& spec_;
  int radius_;
  bool same_field_;
  int halo_;  // of samples that a block needs: more than the radius where windows end at lines
  CpuLevel level_;
  const LineCuts* cuts_;  // null without lines
  std::atomic<bool> out_of_memory_{false};
};

// Orders tiles as a walk over the tree meets them, and so as changedTiles does: eight by eight on every
// level.
std::uint64_t placeInTree(std::int32_t column, std::int32_t row) noexcept {
  std::uint64_t place = 0;
  for (int shift = 27; shift >= 0; shift -= 3)
    place = place << 6 | static_cast<std::uint64_t>((row >> shift & 7) << 3 | (column >> shift & 7));
  return place;
}

/// How the field is cut, in samples.
struct Cut {
  int columns, rows;
};

// As the filter has it, in blocks small enough that every core has several to do.
Cut suitableCut(const WindowFilter& filter, const FilterSpec& spec, const Grid& grid) noexcept {
  const int wanted = (2 * spec.window + kTileSide - 1) / kTileSide * kTileSide;
  const auto sideOf = [wanted](const BlockSide& side) {
    return std::clamp(side.double_windows * wanted, side.least, side.most);
  };
  Cut cut{sideOf(filter.columns), sideOf(filter.rows)};
  const std::int64_t cores = tbb::this_task_arena::max_concurrency();
  const auto blocks = [&] {
    return std::int64_t{(grid.width + cut.columns - 1) / cut.columns} *
           ((grid.height + cut.rows - 1) / cut.rows);
  };
  while (cores > 1 && std::max(cut.columns, cut.rows) > kTileSide && blocks() < 4 * cores) {
    int& longer = cut.rows >= cut.columns ? cut.rows : cut.columns;
    longer = std::max(longer / 2 / kTileSide, 1) * kTileSide;
  }
  return cut;
}

}  // namespace

Result<PassResult> passInBlocks(const WindowFilter& filter, const Version& input, const Version& original,
                                const FilterSpec& spec, const FilterTuning& tuning, JobControl& job) {
  const Grid& grid = input.grid();
  const FieldReader reader = input.reader();
  const int side = filter.squares.side > 0 ? filter.squares.side : tuning.block_side;
  const Cut cut = side > 0 ? Cut{side, side} : suitableCut(filter, spec, grid);
  const std::int32_t wide = cut.columns / kTileSide;
  const std::int32_t high = cut.rows / kTileSide;
  assert(wide > 0 && high > 0);
  const std::int32_t across = (reader.tileColumns() + wide - 1) / wide;
  const std::int32_t up = (reader.tileRows() + high - 1) / high;

  Pass pass(filter, input, original, spec, std::min(tuning.level, bestCpuLevel()));
  tbb::enumerable_thread_specific<Scratch> scratches;
  tbb::enumerable_thread_specific<std::vector<NewTile>> made;
  tbb::parallel_for(
      tbb::blocked_range<std::int64_t>(0, std::int64_t{across} * up, 1),
      [&](const tbb::blocked_range<std::int64_t>& range) {
        for (std::int64_t i = range.begin(); i != range.end(); ++i) {
          if (job.cancelled() || pass.outOfMemory()) return;
          const auto bc = static_cast<std::int32_t>(i % across);
          const auto br = static_cast<std::int32_t>(i / across);
          const TileRect rect{bc * wide, br * high, std::min((bc + 1) * wide, reader.tileColumns()),
                              std::min((br + 1) * high, reader.tileRows())};
          if (!pass.run(rect, scratches.local(), job, made.local())) return;
          const std::int64_t columns =
              std::min(rect.column1 * kTileSide, grid.width) - rect.column0 * kTileSide;
          const std::int64_t rows = std::min(rect.row1 * kTileSide, grid.height) - rect.row0 * kTileSide;
          job.advance(static_cast<std::uint64_t>(columns * rows));
        }
      },
      tbb::simple_partitioner());
  if (job.cancelled()) return cancelled();

  std::vector<NewTile> tiles;
  for (std::vector<NewTile>& some : made)
    tiles.insert(tiles.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
  std::ranges::sort(tiles, {}, [](const NewTile& t) { return placeInTree(t.column, t.row); });
  PassResult result;
  result.reports.reserve(tiles.size());
  LiveField live(input, Growth::kAllowed);
  bool room = !pass.outOfMemory();
  for (NewTile& t : tiles) {
    result.reports.push_back(t.report);
    room = room && live.replaceTile(t.column, t.row, std::move(t.tile));
  }
  if (!room) return failure("memory for the filtered samples could not be had", "filter");
  result.field = live.snapshot();
  return result;
}

}  // namespace fettle::engine
