#include "engine/filter/each_block.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <mutex>
#include <optional>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

namespace fettle::engine {

namespace {

std::vector<TileRect> blocksOf(const FieldReader& reader, const BlockCut& cut) {
  std::vector<TileRect> blocks;
  for (std::int32_t r = 0; r < reader.tileRows(); r += cut.rows)
    for (std::int32_t c = 0; c < reader.tileColumns(); c += cut.columns)
      blocks.push_back(
          {c, r, std::min(c + cut.columns, reader.tileColumns()), std::min(r + cut.rows, reader.tileRows())});
  return blocks;
}

// Hands out blocks, each once, in an order that may change meanwhile.
class WishedBlocks {
 public:
  WishedBlocks(FilterWork& work, std::vector<TileRect> blocks) : work_(work), left_(std::move(blocks)) {}

  TileRect next() {
    const std::scoped_lock lock(mutex_);
    if (const std::uint64_t wish = work_.wish(); wish != followed_) {
      followed_ = wish;
      sort();
    }
    const TileRect block = left_.back();
    left_.pop_back();
    return block;
  }

 private:
  void sort() {
    std::vector<std::pair<double, TileRect>> ranked;
    ranked.reserve(left_.size());
    for (const TileRect& block : left_) ranked.emplace_back(work_.rank(block), block);
    std::ranges::stable_sort(ranked, [](const auto& a, const auto& b) { return a.first > b.first; });
    std::ranges::transform(ranked, left_.begin(), [](const auto& each) { return each.second; });
  }

  FilterWork& work_;
  std::mutex mutex_;
  std::vector<TileRect> left_;  // guarded by mutex_
  std::uint64_t followed_ = 0;  // guarded by mutex_
};

}  // namespace

Result<PassResult> passOverBlocks(const BlockPass& blocks, const BlockCut& cut, FilterWork* work,
                                  const RunBlock& run, JobControl& job) {
  assert(cut.columns > 0 && cut.rows > 0);
  const std::vector<TileRect> all = blocksOf(blocks.reader(), cut);
  // Row by row a worker's next block is mostly the right neighbour, which is fetched meanwhile.
  std::optional<WishedBlocks> wished;
  if (work != nullptr && work->wish() != 0) wished.emplace(*work, all);
  tbb::enumerable_thread_specific<std::vector<NewTile>> made;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, all.size(), 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          if (job.cancelled() || blocks.outOfMemory()) return;
          const TileRect rect = wished ? wished->next() : all[i];
          if (work == nullptr || !work->isDone(rect)) {
            std::vector<NewTile>& mine = made.local();
            const std::size_t first = mine.size();
            if (!run(rect, mine)) return;
            if (work != nullptr) work->done(rect, mine, first);
          }
          job.advance(static_cast<std::uint64_t>(blocks.samplesOf(rect)));
        }
      },
      tbb::simple_partitioner());
  if (job.cancelled()) return cancelled();

  std::vector<NewTile> tiles;
  for (std::vector<NewTile>& some : made)
    tiles.insert(tiles.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
  if (work != nullptr) work->addMade(tiles);
  return blocks.finish(std::move(tiles));
}

}  // namespace fettle::engine
