#include "engine/filter/surface_pass.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "engine/filter/block_pass.h"
#include "engine/filter/filter_work.h"

namespace fettle::engine {

namespace {

// Side of blocks [tiles]: every core has several of them.
std::int32_t blockTiles(const FilterTuning& tuning, const FieldReader& reader) noexcept {
  if (tuning.block_side > 0) return tuning.block_side / kTileSide;
  const std::int64_t cores = tbb::this_task_arena::max_concurrency();
  std::int32_t side = 8;
  const auto blocks = [&] {
    return std::int64_t{(reader.tileColumns() + side - 1) / side} * ((reader.tileRows() + side - 1) / side);
  };
  while (cores > 1 && side > 1 && blocks() < 4 * cores) side /= 2;
  return side;
}

}  // namespace

Result<PassResult> passOfSurface(const SurfaceOf& surface, std::int32_t reach, const Version& input,
                                 const Version& original, const FilterSpec& spec, const FilterTuning& tuning,
                                 JobControl& job) {
  BlockPass blocks(input, original, spec, reach, 0, std::min(tuning.level, bestCpuLevel()));
  const FieldReader& reader = blocks.reader();
  const std::int32_t side = blockTiles(tuning, reader);
  const std::int32_t across = (reader.tileColumns() + side - 1) / side;
  const std::int32_t up = (reader.tileRows() + side - 1) / side;
  tbb::enumerable_thread_specific<BlockScratch> scratches;
  tbb::enumerable_thread_specific<std::vector<NewTile>> made;
  const auto run = [&](const TileRect& rect, std::vector<NewTile>& tiles) {
    const TileRect wanted = blocks.toChange(rect);
    if (wanted.empty()) return true;
    BlockScratch& scratch = scratches.local();
    const std::int32_t column = wanted.column0 * kTileSide, row = wanted.row0 * kTileSide;
    const SampleRect samples{column, row, std::min(wanted.column1 * kTileSide, reader.width()) - column,
                             std::min(wanted.row1 * kTileSide, reader.height()) - row};
    scratch.out_stride = (wanted.column1 - wanted.column0) * kTileSide;
    scratch.out.resize(static_cast<std::size_t>(scratch.out_stride) *
                           static_cast<std::size_t>((wanted.row1 - wanted.row0) * kTileSide) +
                       16);
    return surface(samples, scratch.out.data(), scratch.out_stride) &&
           blocks.merge(wanted, reader.sign(), rect.column1 - rect.column0, scratch, tiles);
  };
  tbb::parallel_for(
      tbb::blocked_range<std::int64_t>(0, std::int64_t{across} * up, 1),
      [&](const tbb::blocked_range<std::int64_t>& range) {
        for (std::int64_t i = range.begin(); i != range.end(); ++i) {
          if (job.cancelled() || blocks.outOfMemory()) return;
          const auto bc = static_cast<std::int32_t>(i % across) * side;
          const auto br = static_cast<std::int32_t>(i / across) * side;
          const TileRect rect{bc, br, std::min(bc + side, reader.tileColumns()),
                              std::min(br + side, reader.tileRows())};
          if (tuning.work == nullptr || !tuning.work->isDone(rect)) {
            std::vector<NewTile>& mine = made.local();
            const std::size_t first = mine.size();
            if (!run(rect, mine)) return;
            if (tuning.work != nullptr) tuning.work->done(rect, mine, first);
          }
          job.advance(static_cast<std::uint64_t>(blocks.samplesOf(rect)));
        }
      },
      tbb::simple_partitioner());
  if (job.cancelled()) return cancelled();

  std::vector<NewTile> tiles;
  for (std::vector<NewTile>& some : made)
    tiles.insert(tiles.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
  if (tuning.work != nullptr) tuning.work->addMade(tiles);
  return blocks.finish(std::move(tiles));
}

}  // namespace fettle::engine
