#include "engine/filter/surface_pass.h"

#include <algorithm>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/task_arena.h>

#include "engine/filter/block_pass.h"
#include "engine/filter/each_block.h"

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
  tbb::enumerable_thread_specific<BlockScratch> scratches;
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
  return passOverBlocks(blocks, {side, side}, tuning.work, run, job);
}

}  // namespace fettle::engine
