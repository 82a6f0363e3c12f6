// Medians of windows with few samples, by comparing and exchanging only, one output in each vector lane. Windows that
// leave the field or hold a hole have any number of samples: few of them go one by one, many by their ranks.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "engine/filter/median.h"
#include "engine/filter/sorting_network.h"
#include "engine/filter/tile_window.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

template <int kN>
struct Sorting {
  static constexpr auto kList = sortingNetwork(kN);
};

template <int kCount>
struct Selecting {
  static constexpr auto kList = [] {
    auto list = sortingNetwork(kCount);
    list.prune(kCount / 2, kCount / 2 + 1, kCount);
    return list;
  }();
};

template <int kA, int kB, int kBegin, int kEnd>
struct Merging {
  static constexpr auto kList = mergingNetwork(kA, kB, kBegin, kEnd);
};

#define FETTLE_KERNEL "engine/filter/median_small-inl.h"
#include "engine/simd/each_cpu-inl.h"

using Strip = void (*)(const float* corner, std::ptrdiff_t stride, int last_row, int out_rows, float* out,
                       std::ptrdiff_t out_stride);

Strip chooseStrip(int window, CpuLevel level) noexcept {
  switch (window) {
    case 3:
      return FETTLE_AT_LEVEL(level, medianStrip<3>);
    case 5:
      return FETTLE_AT_LEVEL(level, medianStrip<5>);
    case 7:
      return FETTLE_AT_LEVEL(level, medianStrip<7>);
    case 9:
      return FETTLE_AT_LEVEL(level, medianStrip<9>);
    default:
      return FETTLE_AT_LEVEL(level, medianStrip<11>);
  }
}

class SmallMedian final : public BlockFilter {
 public:
  SmallMedian(int window, CpuLevel level)
      : radius_(window / 2),
        strip_(chooseStrip(window, level)),
        columns_at_once_(FETTLE_AT_LEVEL(level, medianColumns)()),
        holes_of_(FETTLE_AT_LEVEL(level, holesOf)),
        any_hole_(FETTLE_AT_LEVEL(level, anyHole)),
        middle_(window == 3   ? FETTLE_AT_LEVEL(level, middleOfLanes<9>)
                : window == 5 ? FETTLE_AT_LEVEL(level, middleOfLanes<25>)
                              : nullptr),
        by_ranks_(makeRankMedian(window, level)) {}

  bool run(const Block& block, const JobControl& job) override {
    for (int c = 0; c < block.out_columns; c += kAcross)
      if (!runColumns(block, c, std::min(kAcross, block.out_columns - c), job)) return false;
    return true;
  }

 private:
  static constexpr int kAcross = 64;  // outputs side by side: bits of a word
  // Windows that are worth sorting a block for.
  static constexpr int kManyWindows = 256;
  static constexpr int kMostLanes = 16, kMostInLanes = 25;

  // Outputs [first, first + n).
  bool runColumns(const Block& block, int first, int n, const JobControl& job) {
    // Outputs whose windows lie in the field, columns and rows.
    const int c0 = std::clamp(radius_ - block.first_column, first, first + n);
    int c1 = std::clamp(block.columns - radius_ - block.first_column, c0, first + n);
    if (c1 - c0 < columns_at_once_) c1 = c0;
    const int r0 = std::clamp(radius_ - block.first_row, 0, block.out_rows);
    const int r1 = std::clamp(block.rows - radius_ - block.first_row, r0, block.out_rows);
    const int top = block.first_row + r0 - radius_;
    if (r0 < r1)
      for (int next = c0; next < c1; next += columns_at_once_) {
        if (job.cancelled()) return false;
        const int c = std::min(next, c1 - columns_at_once_);  // the last ones may be done twice
        strip_(block.row(top) + block.first_column + c - radius_, block.stride, block.rows - 1 - top, r1 - r0,
               block.out + r0 * block.out_stride + c, block.out_stride);
      }

    // What is left: windows that leave the field or hold a hole.
    if (!block.holes && c1 - c0 == n && r1 - r0 == block.out_rows) return true;
    const std::uint64_t all = n == kAcross ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1;
    const std::uint64_t inside =
        c1 - c0 == kAcross ? ~std::uint64_t{0} : ((std::uint64_t{1} << (c1 - c0)) - 1) << (c0 - first);
    left_.assign(static_cast<std::size_t>(block.out_rows), all);
    for (int r = r0; r < r1; ++r) left_[static_cast<std::size_t>(r)] = all & ~inside;
    if (block.holes) addHoles(block, first, n);
    int windows = 0;
    for (const std::uint64_t row : left_) windows += std::popcount(row);
    if (windows == 0) return true;
    if (middle_ != nullptr) return runLanes(block, first, job);
    if (windows >= kManyWindows) return runRanks(block, first, job);
    for (int r = 0; r < block.out_rows; ++r)
      for (std::uint64_t row = left_[static_cast<std::size_t>(r)]; row != 0; row &= row - 1) {
        const int c = first + std::countr_zero(row);
        block.out[r * block.out_stride + c] = one(block, c, r);
      }
    return true;
  }

  // Adds the outputs whose windows hold a hole, but not those that are holes.
  void addHoles(const Block& block, int first, int n) {
    const int left = std::max(block.first_column + first - radius_, 0);
    const int right = std::min(block.first_column + first + n + radius_, block.columns);
    for (int y = 0; y < block.rows; ++y) {
      if (!any_hole_(block.row(y) + left, right - left)) continue;
      std::uint64_t reached = 0;
      for (int x = left; x < right; ++x) {
        if (const float v = block.row(y)[x]; v == v) continue;
        const int begin = std::clamp(x - radius_ - block.first_column - first, 0, n);
        const int end = std::clamp(x + radius_ + 1 - block.first_column - first, begin, n);
        if (begin == end) continue;
        reached |= (~std::uint64_t{0} >> (kAcross - (end - begin))) << begin;
      }
      for (int r = std::max(y - radius_ - block.first_row, 0);
           r <= std::min(y + radius_ - block.first_row, block.out_rows - 1); ++r)
        left_[static_cast<std::size_t>(r)] |= reached;
    }
    for (int r = 0; r < block.out_rows; ++r)
      if (left_[static_cast<std::size_t>(r)] != 0)
        left_[static_cast<std::size_t>(r)] &=
            ~holes_of_(block.row(block.first_row + r) + block.first_column + first, n);
  }

  // The windows left, one in each lane. Samples that a window lacks are taken as so many below all others and so many above
  // that the middle one of all is the one wanted; of an even number the mean of two.
  bool runLanes(const Block& block, int first, const JobControl& job) {
    alignas(64) float upper[kMostInLanes * kMostLanes], lower[kMostInLanes * kMostLanes];
    float* outs[kMostLanes];
    int lanes = 0;
    const auto finish = [&] {
      middle_(upper);
      middle_(lower);
      for (int lane = 0; lane < lanes; ++lane) *outs[lane] = midpoint(lower[lane], upper[lane]);
      lanes = 0;
    };
    // What lanes without a window hold: any numbers.
    std::ranges::fill(upper, 0.0F);
    std::ranges::fill(lower, 0.0F);
    for (int r = 0; r < block.out_rows; ++r) {
      if (job.cancelled()) return false;
      for (std::uint64_t row = left_[static_cast<std::size_t>(r)]; row != 0; row &= row - 1) {
        const int c = first + std::countr_zero(row);
        takeWindow(block, c, r, upper + lanes, lower + lanes);
        outs[lanes++] = block.out + r * block.out_stride + c;
        if (lanes == columns_at_once_) finish();
      }
    }
    if (lanes > 0) finish();
    return true;
  }

  void takeWindow(const Block& block, int c, int r, float* upper, float* lower) const noexcept {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    const int column = block.first_column + c, row = block.first_row + r;
    const int all = (2 * radius_ + 1) * (2 * radius_ + 1);
    int n = 0;
    for (int y = std::max(row - radius_, 0); y <= std::min(row + radius_, block.rows - 1); ++y)
      for (int x = std::max(column - radius_, 0); x <= std::min(column + radius_, block.columns - 1); ++x) {
        const float v = block.row(y)[x];
        upper[n * columns_at_once_] = lower[n * columns_at_once_] = v;  // a hole's place is the next one's
        n += v == v ? 1 : 0;
      }
    const int below_upper = all / 2 - n / 2, below_lower = all / 2 - (n - 1) / 2;
    for (int i = n; i < all; ++i) {
      upper[i * columns_at_once_] = i - n < below_upper ? -kInf : kInf;
      lower[i * columns_at_once_] = i - n < below_lower ? -kInf : kInf;
    }
  }

  // The rows with windows left, by their ranks.
  bool runRanks(const Block& block, int first, const JobControl& job) {
    for (int r = 0; r < block.out_rows;) {
      if (left_[static_cast<std::size_t>(r)] == 0) {
        ++r;
        continue;
      }
      std::uint64_t columns = 0;
      int end = r;
      for (; end < block.out_rows && left_[static_cast<std::size_t>(end)] != 0; ++end)
        columns |= left_[static_cast<std::size_t>(end)];
      const int begin_column = first + std::countr_zero(columns);
      const int end_column = first + kAcross - std::countl_zero(columns);
      const int left = std::max(block.first_column + begin_column - radius_, 0);
      const int low = std::max(block.first_row + r - radius_, 0);
      Block part = block;
      part.heights = block.row(low) + left;
      part.columns = std::min(block.first_column + end_column + radius_, block.columns) - left;
      part.rows = std::min(block.first_row + end + radius_, block.rows) - low;
      part.first_column = block.first_column + begin_column - left;
      part.first_row = block.first_row + r - low;
      part.out = block.out + r * block.out_stride + begin_column;
      part.out_columns = end_column - begin_column;
      part.out_rows = end - r;
      if (!by_ranks_->run(part, job)) return false;
      r = end;
    }
    return true;
  }

  [[nodiscard]] float one(const Block& block, int c, int r) const noexcept {
    std::array<float, kSmallMedianWindow * kSmallMedianWindow> window{};
    const int column = block.first_column + c;
    const int row = block.first_row + r;
    if (const float v = block.row(row)[column]; v != v) return v;
    std::ptrdiff_t n = 0;
    for (int y = std::max(row - radius_, 0); y <= std::min(row + radius_, block.rows - 1); ++y)
      for (int x = std::max(column - radius_, 0); x <= std::min(column + radius_, block.columns - 1); ++x) {
        const float v = block.row(y)[x];
        if (v == v) window[static_cast<std::size_t>(n++)] = v;
      }
    const auto middle = window.begin() + n / 2;
    std::nth_element(window.begin(), middle, window.begin() + n);
    return n % 2 != 0 ? *middle : midpoint(*std::max_element(window.begin(), middle), *middle);
  }

  int radius_;
  Strip strip_;
  int columns_at_once_;
  decltype(&plain::holesOf) holes_of_;
  decltype(&plain::anyHole) any_hole_;
  void (*middle_)(float* lanes) noexcept;  // null for windows that are too large for it
  std::unique_ptr<BlockFilter> by_ranks_;
  std::vector<std::uint64_t> left_;  // of each row of outputs, those that are not done yet
};

// The strips over one tile. A tile and what windows reach around it are copied, since a strip reads each sample for several
// outputs from places that are no multiple of a vector; the copy stays in the nearest cache.
class TileStrips final : public TileWindow {
 public:
  TileStrips(int window, CpuLevel level)
      : radius_(window / 2),
        strip_(chooseStrip(window, level)),
        columns_at_once_(FETTLE_AT_LEVEL(level, medianColumns)()) {}

  bool run(const TileAround& around, float* out) const noexcept override {
    constexpr int kBeside = 16;  // samples of the tiles to the left and right: a cache line
    constexpr std::ptrdiff_t kStride = kTileSide + 2 * kBeside;
    constexpr int kMostRows = kTileSide + 2 * (kSmallMedianWindow / 2);
    alignas(64) float samples[kMostRows * kStride];
    for (int y = -radius_; y < kTileSide + radius_; ++y) {
      const auto& tiles = around[y < 0 ? 0 : y < kTileSide ? 1 : 2];
      const std::ptrdiff_t at = (y & (kTileSide - 1)) * kTileSide;
      float* const to = samples + (y + radius_) * kStride;
      std::memcpy(to, tiles[0] + at + kTileSide - kBeside, kBeside * sizeof(float));
      std::memcpy(to + kBeside, tiles[1] + at, kTileSide * sizeof(float));
      std::memcpy(to + kBeside + kTileSide, tiles[2] + at, kBeside * sizeof(float));
    }
    for (int c = 0; c < kTileSide; c += columns_at_once_)
      strip_(samples + kBeside + c - radius_, kStride, kTileSide + 2 * radius_ - 1, kTileSide, out + c,
             kTileSide);
    return true;
  }

 private:
  int radius_;
  Strip strip_;
  int columns_at_once_;
};

}  // namespace

std::unique_ptr<TileWindow> makeTileStrips(int window, CpuLevel level) {
  return window <= kSmallMedianWindow ? std::make_unique<TileStrips>(window, level) : nullptr;
}

std::unique_ptr<BlockFilter> makeSmallMedian(int window, CpuLevel level) {
  return std::make_unique<SmallMedian>(window, level);
}

}  // namespace fettle::engine
