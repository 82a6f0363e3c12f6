#include "engine/filter/window_pass.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/task_arena.h>

#include "engine/filter/block_pass.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/each_block.h"
#include "engine/filter/line_windows.h"

namespace fettle::engine {

namespace {

struct Scratch {
  std::unique_ptr<BlockFilter> filter;
  std::unique_ptr<BoxStrip> strip;
  std::unique_ptr<TileWindow> tile;
  BlockScratch block;
};

class Pass {
 public:
  Pass(const WindowFilter& filter, const Version& input, const Version& original, const FilterSpec& spec,
       CpuLevel level)
      : filter_(filter),
        spec_(spec),
        radius_(filter.squares.side > 0 ? filter.squares.halo : filterOf(spec.kind).reach(spec)),
        blocks_(input, original, spec, radius_,
                filter.squares.side > 0 ? radius_
                                        : radius_ + (reachOf(spec, input) - reachOf(spec)) / spec.passes,
                level) {}

  // Filters one rectangle of tiles; appends the tiles that changed. False when cancelled or out of memory.
  bool run(const TileRect& rect, Scratch& scratch, const JobControl& job, std::vector<NewTile>& made) {
    const TileRect to_change = blocks_.toChange(rect);
    if (to_change.empty()) return true;
    const TileRect& filtered = filter_.squares.side > 0 ? rect : to_change;
    if (radius_ > 0 && blocks_.cuts() == nullptr) {
      if (filter_.tile != nullptr && !scratch.tile) scratch.tile = filter_.tile(spec_, blocks_.level());
      if (filter_.strip != nullptr && !scratch.strip) scratch.strip = filter_.strip(radius_, blocks_.level());
      if (scratch.tile) return runTiles(filtered, scratch, job, made);
      if (scratch.strip) return runStrip(filtered, scratch, job, made);
    }
    if (!gatherAndFilter(filtered, scratch, job)) return false;
    // The next block is mostly the right neighbour.
    return blocks_.merge(filtered, blocks_.reader().sign(), rect.column1 - rect.column0, scratch.block, made);
  }

  [[nodiscard]] const BlockPass& blocks() const noexcept { return blocks_; }

 private:
  // As run, with a strip: one row of tiles after the other, with sums that run on from one to the next.
  bool runStrip(const TileRect& rect, Scratch& scratch, const JobControl& job, std::vector<NewTile>& made) {
    const std::int32_t c0 = rect.column0 * kTileSide;
    const std::int32_t c1 = std::min(rect.column1 * kTileSide, blocks_.reader().width());
    const std::int32_t r1 = std::min(rect.row1 * kTileSide, blocks_.reader().height());
    bool begun = false;
    for (std::int32_t tr = rect.row0; tr < rect.row1; ++tr) {
      if (job.cancelled()) return false;
      const TileRect band{rect.column0, tr, rect.column1, tr + 1};
      const std::int32_t r0 = tr * kTileSide;
      if (!begun) scratch.strip->begin(blocks_.reader(), c0, c1, r0, r1 - r0);
      scratch.block.out_stride = (rect.column1 - rect.column0) * kTileSide;
      scratch.block.out.resize(static_cast<std::size_t>(scratch.block.out_stride) * kTileSide);
      begun = scratch.strip->rows(std::min(r1 - r0, kTileSide), scratch.block.out.data(),
                                  scratch.block.out_stride);
      if (!begun && !gatherAndFilter(band, scratch, job)) return false;
      if (!blocks_.merge(band, begun ? 1.0F : blocks_.reader().sign(), 0, scratch.block, made)) return false;
    }
    return true;
  }

  // As run, with windows over one tile after the other, and by strips or from one rectangle that is gathered where tiles are near
  // a border or a hole.
  bool runTiles(const TileRect& rect, Scratch& scratch, const JobControl& job, std::vector<NewTile>& made) {
    const auto reached = [&](std::int32_t tc, std::int32_t tr) {
      return !blocks_.mayChange(tc, tr) || blocks_.around(tc, tr).has_value();
    };
    // What is left for strips may be narrow, so each run of such tiles in a row has a strip of its own.
    if (scratch.strip) {
      for (std::int32_t tr = rect.row0; tr < rect.row1; ++tr)
        for (std::int32_t tc = rect.column0; tc < rect.column1;) {
          std::int32_t end = tc;
          while (end < rect.column1 && !reached(end, tr)) ++end;
          if (end > tc ? !runStrip({tc, tr, end, tr + 1}, scratch, job, made)
                       : !runTile(tc, tr, scratch, job, made))
            return false;
          tc = std::max(end, tc + 1);
        }
      return true;
    }
    TileRect rest{rect.column1, rect.row1, rect.column0, rect.row0};
    for (std::int32_t tr = rect.row0; tr < rect.row1; ++tr)
      for (std::int32_t tc = rect.column0; tc < rect.column1; ++tc)
        if (!reached(tc, tr))
          rest = {std::min(rest.column0, tc), std::min(rest.row0, tr), std::max(rest.column1, tc + 1),
                  std::max(rest.row1, tr + 1)};
    for (std::int32_t tr = rect.row0; tr < rect.row1; ++tr)
      for (std::int32_t tc = rect.column0; tc < rect.column1; ++tc) {
        const bool gathered = tc >= rest.column0 && tc < rest.column1 && tr >= rest.row0 && tr < rest.row1;
        if (!gathered && !runTile(tc, tr, scratch, job, made)) return false;
      }
    if (rest.empty()) return true;
    return gatherAndFilter(rest, scratch, job) &&
           blocks_.merge(rest, blocks_.reader().sign(), 0, scratch.block, made);
  }

  // A tile far from borders and holes, or one in which nothing may change.
  bool runTile(std::int32_t tc, std::int32_t tr, Scratch& scratch, const JobControl& job,
               std::vector<NewTile>& made) {
    if (!blocks_.mayChange(tc, tr)) return true;
    if (job.cancelled()) return false;
    if (scratch.tile->run(*blocks_.around(tc, tr), scratch.block.results.data()))
      return blocks_.mergeTileAt(tc, tr, scratch.block, made);
    const TileRect own{tc, tr, tc + 1, tr + 1};
    if (scratch.strip) return runStrip(own, scratch, job, made);
    return gatherAndFilter(own, scratch, job) &&
           blocks_.merge(own, blocks_.reader().sign(), 0, scratch.block, made);
  }

  bool gatherAndFilter(const TileRect& rect, Scratch& scratch, const JobControl& job) {
    const Block block = blocks_.gather(rect, scratch.block);
    if (radius_ == 0) {
      for (int r = 0; r < block.out_rows; ++r)
        std::copy_n(block.row(r), block.out_columns, block.out + r * block.out_stride);
      return true;
    }
    if (!scratch.filter) {
      scratch.filter = filter_.make(spec_, blocks_.level());
      const Filter& kind = filterOf(spec_.kind);
      if (blocks_.cuts() != nullptr && kind.knows_lines && kind.window.exists())
        scratch.filter = endingAtLines(std::move(scratch.filter), radius_);
    }
    return scratch.filter->run(block, job);
  }

  const WindowFilter& filter_;
  const FilterSpec& spec_;
  int radius_;
  BlockPass blocks_;
};

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
  const int side = filter.squares.side > 0 ? filter.squares.side : tuning.block_side;
  const Cut cut = side > 0 ? Cut{side, side} : suitableCut(filter, spec, grid);
  Pass pass(filter, input, original, spec, std::min(tuning.level, bestCpuLevel()));
  tbb::enumerable_thread_specific<Scratch> scratches;
  return passOverBlocks(
      pass.blocks(), {cut.columns / kTileSide, cut.rows / kTileSide}, tuning.work,
      [&](const TileRect& rect, std::vector<NewTile>& made) {
        return pass.run(rect, scratches.local(), job, made);
      },
      job);
}

}  // namespace fettle::engine
