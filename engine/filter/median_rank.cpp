// The median of any window, with any holes, after J. Suomela, Median filtering is equivalent to sorting,
// arXiv:1406.1717, 2014: the samples of a block are replaced by their ranks, the window is a set of bits, one
// a rank, and a pivot walks over it. A sample that enters or leaves flips its bit and tells the pivot whether
// it lies below; the pivot then moves over the few words that the median moved. Exact, because ranks are.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "engine/filter/median.h"
#include "engine/filter/ranks.h"

namespace fettle::engine {

namespace {

struct Window {
  std::uint64_t* words;
  std::uint32_t word;       // the pivot: all ranks below 64 * word are counted by `below`
  std::int32_t below;       // ranks of the set below the pivot
  std::int32_t size;        // ranks of the set
  std::uint32_t hole_rank;  // ranks from here on are no samples
};

// Flips n samples, `stride` apart, into the window (kSign = 1) or out of it (-1).
template <int kSign>
FETTLE_INTO_EACH_CPU void flip(Window& w, const std::uint32_t* ranks, int n, std::ptrdiff_t stride) noexcept {
  const std::uint32_t pivot = w.word * 64;
  std::int32_t below = 0;
  std::int32_t samples = 0;
  for (int i = 0; i < n; ++i) {
    const std::uint32_t rank = ranks[i * stride];
    w.words[rank >> 6] ^= std::uint64_t{1} << (rank & 63U);
    below += rank < pivot ? 1 : 0;
    samples += rank < w.hole_rank ? 1 : 0;
  }
  w.below += kSign * below;
  w.size += kSign * samples;
}

// Moves the pivot to the word that holds the k-th smallest of the set, k from 0.
FETTLE_INTO_EACH_CPU void seek(Window& w, std::int32_t k) noexcept {
  while (w.below > k) w.below -= std::popcount(w.words[--w.word]);
  for (;;) {
    const std::int32_t here = std::popcount(w.words[w.word]);
    if (w.below + here > k) return;
    w.below += here;
    ++w.word;
  }
}

// Median of a set that is not empty.
FETTLE_INTO_EACH_CPU float median(Window& w, const float* heights) noexcept {
  const std::int32_t k = (w.size - 1) / 2;
  seek(w, k);
  std::uint64_t bits = w.words[w.word];
  for (std::int32_t i = w.below; i < k; ++i) bits &= bits - 1;
  const float low = heights[w.word * 64 + static_cast<std::uint32_t>(std::countr_zero(bits))];
  if (w.size % 2 != 0) return low;
  bits &= bits - 1;
  std::uint32_t word = w.word;
  while (bits == 0) bits = w.words[++word];
  return midpoint(low, heights[word * 64 + static_cast<std::uint32_t>(std::countr_zero(bits))]);
}

struct Column {
  const std::uint32_t* ranks;  // of the block
  const float* heights;        // of the ranks
  int columns, rows;           // of the block
  int left, right;             // columns of the window: left .. right
  int radius;
  std::ptrdiff_t out_stride;
};

// `steps` outputs from block row `row` on, downwards (step = -1) or upwards (1); the window is at `row` when
// it starts and one step further when it ends.
FETTLE_EACH_CPU void sweep(Window& window, const Column& at, int row, int step, int steps, float* out) {
  Window w = window;
  const int n = at.right - at.left + 1;
  const std::uint32_t* ranks = at.ranks + at.left;
  for (int i = 0; i < steps; ++i, row += step, out += step * at.out_stride) {
    // A window without a sample has a hole for its centre: nobody reads its output.
    if (w.size > 0) *out = median(w, at.heights);
    const int leave = row - step * at.radius;
    const int enter = row + step * (at.radius + 1);
    if (leave >= 0 && leave < at.rows)
      flip<-1>(w, ranks + static_cast<std::ptrdiff_t>(leave) * at.columns, n, 1);
    if (enter >= 0 && enter < at.rows)
      flip<1>(w, ranks + static_cast<std::ptrdiff_t>(enter) * at.columns, n, 1);
  }
  window = w;
}

class RankMedian final : public BlockFilter {
 public:
  explicit RankMedian(int radius) : radius_(radius) {}

  bool run(const Block& block, const JobControl& job) override {
    ranks_.sort(block);
    words_.assign(ranks_.words(), 0);
    Window w{words_.data(), 0, 0, 0, ranks_.holeRank()};
    const int first = std::max(block.first_column - radius_, 0);
    Column at{ranks_.ranks(), ranks_.heights(), block.columns, block.rows,
              first,          first - 1,        radius_,       block.out_stride};

    // Serpentine: down one column of outputs, up the next, so that the window only ever moves by one sample.
    int row = block.first_row;
    int step = 1;
    for (int c = 0; c < block.out_columns; ++c) {
      const int centre = block.first_column + c;
      const int right = std::min(centre + radius_, block.columns - 1);
      const int left = std::max(centre - radius_, 0);
      const int low = std::max(row - radius_, 0);
      const int high = std::min(row + radius_, block.rows - 1);
      for (; at.left < left; ++at.left) moveColumn<-1>(w, at.left, low, high, block.columns);
      for (; at.right < right;) moveColumn<1>(w, ++at.right, low, high, block.columns);

      float* out = block.out + c + (row - block.first_row) * block.out_stride;
      constexpr int kStretch = 16;  // between looks at the job: 50 us at the largest window
      int todo = block.out_rows;
      while (todo > 0) {
        if (job.cancelled()) return false;
        const int steps = std::min(todo, kStretch);
        sweep(w, at, row, step, steps, out);
        row += steps * step;
        out += steps * step * block.out_stride;
        todo -= steps;
      }
      // The window stands one step past the last output: take that step back.
      row -= step;
      undoStep(w, at, row, step);
      step = -step;
    }
    return true;
  }

 private:
  template <int kSign>
  void moveColumn(Window& w, int column, int low, int high, int columns) const noexcept {
    flip<kSign>(w, ranks_.ranks() + static_cast<std::ptrdiff_t>(low) * columns + column, high - low + 1,
                columns);
  }

  void undoStep(Window& w, const Column& at, int row, int step) const noexcept {
    const int leave = row - step * radius_;
    const int enter = row + step * (radius_ + 1);
    const int n = at.right - at.left + 1;
    const std::uint32_t* ranks = at.ranks + at.left;
    if (enter >= 0 && enter < at.rows)
      flip<-1>(w, ranks + static_cast<std::ptrdiff_t>(enter) * at.columns, n, 1);
    if (leave >= 0 && leave < at.rows)
      flip<1>(w, ranks + static_cast<std::ptrdiff_t>(leave) * at.columns, n, 1);
  }

  int radius_;
  Ranks ranks_;
  std::vector<std::uint64_t> words_;
};

}  // namespace

std::unique_ptr<BlockFilter> makeRankMedian(int window) {
  return std::make_unique<RankMedian>(window / 2);
}

}  // namespace fettle::engine
