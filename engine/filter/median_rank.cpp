// The median of any window, with any holes, after J. Suomela, Median filtering is equivalent to sorting,
// arXiv:1406.1717, 2014: the samples of a block are replaced by their ranks, the window is a set of bits, one
// a rank, and a pivot follows the median from word to word. A sample that enters or leaves flips its bit and
// changes the count of those below the pivot. Exact, because ranks are.
//
// Sixteen neighbouring windows go down the block together and share what they have in common, after
// B. Weiss, Fast median and bilateral filtering, 2006: most columns are in all of them and flip one bit for
// sixteen; those at the sides are in the first or the last few, and go to a tree of sets, each for 8, 4, 2 or
// 1 of the windows, so that a column flips a bit in at most four and a window is the union of five. An output
// costs 2 (n + 49) / 16 flips for a window of n, not 2 n.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include <tbb/cache_aligned_allocator.h>

#include "engine/filter/median.h"
#include "engine/filter/ranks.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

constexpr int kMaxLanes = 16;
constexpr int kMostSets = 2 * kMaxLanes - 1;
// Words in a line of the cache: each set begins with one, and the first pivot is the lowest rank of one.
constexpr std::size_t kLineWords = 8;

/// A column that not all windows of a group have: the lanes that have it, and the sets that make these up.
struct Column {
  alignas(64) std::int32_t lanes[kMaxLanes];  // 1 or 0
  int count = 0;
  int sets[4];
};

/// Neighbouring windows. Set 0 is for all lanes, sets 1 and 2 for half of them each, and so on.
struct WindowGroup {
  alignas(64) std::int32_t pivots[kMaxLanes];  // each the first rank of a word, with AVX-512 of a line
  alignas(64) std::int32_t below[kMaxLanes];   // ranks of the window below the pivot
  alignas(64) std::int32_t sizes[kMaxLanes];   // samples of the window
  alignas(64) std::int32_t all_lanes[kMaxLanes];
  std::uint64_t* sets[kMostSets];
  const Column* columns;  // those at the left, then those at the right
  int lanes;              // a power of two, 2 .. 16 and no more than the window
  int window;
  std::uint32_t hole_rank;  // ranks from here on are no samples
};

#define FETTLE_KERNEL "engine/filter/median_rank-inl.h"
#include "engine/simd/each_cpu-inl.h"

class RankMedian final : public BlockFilter {
 public:
  RankMedian(int window, CpuLevel level)
      : radius_(window / 2),
        enter_(FETTLE_AT_LEVEL(level, moveGroup<1>)),
        leave_(FETTLE_AT_LEVEL(level, moveGroup<-1>)),
        medians_(FETTLE_AT_LEVEL(level, groupMedians)) {
    group_.window = window;
    // As many as have a column in common.
    group_.lanes = std::min(static_cast<int>(std::bit_floor(static_cast<unsigned>(window))), kMaxLanes);
    const int n = group_.lanes;
    columns_.resize(static_cast<std::size_t>(2 * n));
    for (int x = 0; x < n; ++x) columns_[static_cast<std::size_t>(x)] = columnOf(0, x + 1);
    for (int x = 0; x < n; ++x) columns_[static_cast<std::size_t>(n + x)] = columnOf(x + 1, n);
    group_.columns = columns_.data();
    std::fill_n(group_.all_lanes, kMaxLanes, 1);
  }

  bool run(const Block& block, const JobControl& job) override {
    ranks_.sort(block);
    const std::size_t words = (ranks_.words() + kLineWords - 1) / kLineWords * kLineWords;
    const auto sets = static_cast<std::size_t>(2 * group_.lanes - 1);
    words_.resize(words * sets);
    for (std::size_t s = 0; s < sets; ++s) group_.sets[s] = words_.data() + s * words;
    group_.hole_rank = ranks_.holeRank();
    // Where the first window's median is likely to be: the block's.
    std::int32_t pivot = static_cast<std::int32_t>(group_.hole_rank / (128 * kLineWords) * (64 * kLineWords));
    for (int c = 0; c < block.out_columns; c += group_.lanes)
      if (!runGroup(block, c, pivot, job)) return false;
    return true;
  }

  [[nodiscard]] bool isMedian() const noexcept override { return true; }

 private:
  using Move = void (*)(WindowGroup&, const std::uint32_t*, int, int, bool);
  using Medians = void (*)(WindowGroup&, const float*, int, float*);

  // The lanes [begin, end), which begin at the first lane or end at the last, as few sets as possible.
  [[nodiscard]] Column columnOf(int begin, int end) const noexcept {
    Column column{};
    for (int lane = begin; lane < end; ++lane) column.lanes[lane] = 1;
    int first_set = 0;
    for (int size = group_.lanes; size > 0; first_set = 2 * first_set + 1, size /= 2)
      for (int s = 0; s * size < group_.lanes; ++s) {
        const bool within = s * size >= begin && (s + 1) * size <= end;
        const int parent = s / 2 * 2 * size;
        const bool parent_within = size < group_.lanes && parent >= begin && parent + 2 * size <= end;
        if (within && !parent_within) column.sets[column.count++] = first_set + s;
      }
    return column;
  }

  // Outputs [first, first + lanes) of all rows. `pivot`: where to look for the first median, then where it
  // was.
  bool runGroup(const Block& block, int first, std::int32_t& pivot, const JobControl& job) {
    WindowGroup& g = group_;
    std::fill(words_.begin(), words_.end(), 0);
    std::fill_n(g.pivots, kMaxLanes, pivot);
    std::fill_n(g.below, kMaxLanes, 0);
    std::fill_n(g.sizes, kMaxLanes, 0);
    const int n = std::min(g.lanes, block.out_columns - first);
    const int left = block.first_column + first - radius_;  // of the first window, in the block
    const int begin = std::max(-left, 0);
    const int end = std::min(g.window + g.lanes - 1, block.columns - left);
    std::int32_t across[kMaxLanes] = {};  // columns of each window
    for (int lane = 0; lane < n; ++lane)
      across[lane] = std::min(lane + g.window, end) - std::max(lane, begin);
    const auto ranksOf = [&](int row) {
      return ranks_.ranks() + static_cast<std::ptrdiff_t>(row) * block.columns + left;
    };
    const auto there = [&](int row) { return row >= 0 && row < block.rows; };

    for (int row = block.first_row - radius_; row < block.first_row + radius_; ++row)
      if (there(row)) enter_(g, ranksOf(row), begin, end, block.holes);
    for (int r = 0; r < block.out_rows; ++r) {
      if (job.cancelled()) return false;
      const int row = block.first_row + r;
      if (there(row + radius_)) enter_(g, ranksOf(row + radius_), begin, end, block.holes);
      if (!block.holes) {
        const int tall = std::min(row + radius_ + 1, block.rows) - std::max(row - radius_, 0);
        for (int lane = 0; lane < n; ++lane) g.sizes[lane] = across[lane] * tall;
      }
      medians_(g, ranks_.heights(), n, block.out + r * block.out_stride + first);
      if (r == 0) pivot = g.pivots[n - 1];
      if (there(row - radius_)) leave_(g, ranksOf(row - radius_), begin, end, block.holes);
    }
    return true;
  }

  int radius_;
  Move enter_, leave_;
  Medians medians_;
  Ranks ranks_;
  WindowGroup group_{};
  std::vector<Column> columns_;
  std::vector<std::uint64_t, tbb::cache_aligned_allocator<std::uint64_t>> words_;
};

}  // namespace

std::unique_ptr<BlockFilter> makeRankMedian(int window, CpuLevel level) {
  return std::make_unique<RankMedian>(window, level);
}

}  // namespace fettle::engine
