#include "engine/filter/line_windows.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "engine/filter/rank_set.h"
#include "engine/filter/ranks.h"
#include "engine/filter/whole_heights.h"

namespace fettle::engine {

namespace {

// One bit for each sample of a row of a window; its first column is bit 0.
using WindowRow = std::uint64_t;
static_assert(kMostLineWindow < 64 - 2);

// One bit for each sample of a block, with room for windows that reach beyond it.
class BitRows {
 public:
  void assign(int columns, int rows) {
    words_ = static_cast<std::size_t>(columns + 2 * kMargin) / 64 + 2;
    bits_.assign(words_ * static_cast<std::size_t>(rows), 0);
  }
  void set(int column, int row) noexcept {
    const auto at = static_cast<std::size_t>(column + kMargin);
    bits_[static_cast<std::size_t>(row) * words_ + at / 64] |= std::uint64_t{1} << (at % 64);
  }
  [[nodiscard]] bool at(int column, int row) const noexcept { return (from(column, row) & 1U) != 0; }
  // 64 columns from `column` on, -kMargin at least.
  [[nodiscard]] WindowRow from(int column, int row) const noexcept {
    const auto at = static_cast<std::size_t>(column + kMargin);
    const std::uint64_t* const words = &bits_[static_cast<std::size_t>(row) * words_ + at / 64];
    return at % 64 == 0 ? words[0] : words[0] >> (at % 64) | words[1] << (64 - at % 64);
  }

 private:
  static constexpr int kMargin = 64;
  std::size_t words_ = 0;
  std::vector<std::uint64_t> bits_;
};

// All that whole links of a row lead to; bit i of `cut`: not from i to i + 1. In steps of 1, 2, 4 .. samples.
WindowRow alongRow(WindowRow reached, WindowRow cut, WindowRow window) noexcept {
  if ((cut & window) == 0) return reached != 0 ? window : 0;
  WindowRow whole = ~cut;  // over so many links from i on
  for (int step = 1; step < 64; step *= 2) {
    reached |= (reached & whole) << step | (reached >> step & whole);
    whole &= whole >> step;
  }
  return reached & window;
}

void forEachBit(WindowRow bits, auto&& visit) {
  for (; bits != 0; bits &= bits - 1) visit(std::countr_zero(bits));
}

class LineWindows final : public BlockFilter {
 public:
  LineWindows(std::unique_ptr<BlockFilter> windows, int radius)
      : windows_(std::move(windows)), radius_(radius) {}

  bool run(const Block& block, const JobControl& job) override {
    if (!windows_->run(windowsOnly(block), job)) return false;
    if (block.cuts == nullptr || !findLines(block)) return true;
    findKnown(block);
    ranks_.sort(block);
    for (RankSet& side : sides_) side.begin(ranks_);
    taken_ = {};
    const std::int64_t side = 2 * radius_ + 1;
    means_ = windows_->isMean() && whole_.take(block, side * side);
    for (int r = 0; r < block.out_rows; ++r) {
      if (job.cancelled()) return false;
      for (int c = 0; c < block.out_columns; ++c) {
        if (crossed_[at(block.out_columns, c, r)] == 0) continue;
        const int column = block.first_column + c, row = block.first_row + r;
        if (!known_.at(column, row)) continue;
        float& out = block.out[r * block.out_stride + c];
        if (!runWindow(block, column, row, job, out)) return false;
      }
    }
    return true;
  }

 private:
  static std::size_t at(int columns, int c, int r) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(c);
  }

  // The block without the samples that no window reaches: they are only there for the lines around.
  [[nodiscard]] Block windowsOnly(const Block& block) const {
    Block inner = block;
    const int columns = std::max(block.first_column - radius_, 0);
    const int rows = std::max(block.first_row - radius_, 0);
    inner.heights = block.row(rows) + columns;
    inner.first_column -= columns;
    inner.first_row -= rows;
    inner.left += columns;
    inner.low += rows;
    inner.columns = std::min(block.columns - columns, inner.first_column + block.out_columns + radius_);
    inner.rows = std::min(block.rows - rows, inner.first_row + block.out_rows + radius_);
    return inner;
  }

  // The cut links of the block, and which outputs have a window with one. False when there are none.
  bool findLines(const Block& block) {
    bool any = false;
    for (int r = 0; r < block.rows; ++r)
      for (const LineCut& cut : block.cuts->row(block.low + r)) {
        const int c = cut.column - block.left;
        if (c < 0 || c >= block.columns) continue;
        if (!std::exchange(any, true)) {
          for (BitRows* bits : {&cut_right_, &cut_up_, &near_}) bits->assign(block.columns, block.rows);
          crossed_.assign(at(block.out_columns, 0, block.out_rows), 0);
        }
        if ((cut.links & LineCut::kRight) != 0) cut_right_.set(c, r);
        if ((cut.links & LineCut::kUp) != 0) cut_up_.set(c, r);
        markNear(block, c, r);
        // Both samples of a link may lie in a window.
        const int c0 = std::max(c - radius_ - block.first_column, 0);
        const int c1 = std::min(c + 1 + radius_ - block.first_column, block.out_columns - 1);
        const int r0 = std::max(r - radius_ - block.first_row, 0);
        const int r1 = std::min(r + 1 + radius_ - block.first_row, block.out_rows - 1);
        for (int row = r0; row <= r1; ++row)
          if (c0 <= c1)
            std::fill_n(crossed_.begin() + static_cast<std::ptrdiff_t>(at(block.out_columns, c0, row)),
                        c1 - c0 + 1, std::uint8_t{1});
      }
    return any;
  }

  // The samples within kLineReach of a cut link, whose second sample is to the right or above.
  void markNear(const Block& block, int column, int row) {
    const int c0 = std::max(column + 1 - kLineReach, 0);
    const int c1 = std::min(column + kLineReach, block.columns - 1);
    for (int r = std::max(row + 1 - kLineReach, 0); r <= std::min(row + kLineReach, block.rows - 1); ++r)
      for (int c = c0; c <= c1; ++c) near_.set(c, r);
  }

  void findKnown(const Block& block) {
    known_.assign(block.columns, block.rows);
    for (int r = 0; r < block.rows; ++r)
      for (int c = 0; c < block.columns; ++c)
        if (!std::isnan(block.row(r)[c])) known_.set(c, r);
  }

  // A window in the block: its rows, and its columns from `left` on, which may be before the block.
  struct Window {
    int left = 0, low = 0, rows = 0;
    WindowRow columns = 0;  // those in the block
    int middle_row = 0;     // counted in the window

    // Of the block.
    [[nodiscard]] int row(std::size_t k) const noexcept { return low + static_cast<int>(k); }
  };
  using Rows = std::array<WindowRow, kMostLineWindow>;

  // visit(k) for each row of a window, from the lowest.
  static void eachRow(const Window& window, const auto& visit) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(window.rows); ++k) visit(k);
  }

  // The filter on a window of its own, without what lies beyond a line.
  bool runWindow(const Block& block, int column, int row, const JobControl& job, float& out) {
    Window window;
    window.left = column - radius_;
    window.low = std::max(row - radius_, 0);
    window.rows = std::min(row + radius_, block.rows - 1) - window.low + 1;
    window.middle_row = row - window.low;
    const int first = std::max(-window.left, 0);
    const int end = std::min(2 * radius_ + 1, block.columns - window.left);
    window.columns = (WindowRow{1} << end) - (WindowRow{1} << first);
    Rows known{}, reached{};
    findReached(window, reached);
    eachRow(window, [&](std::size_t k) {
      known[k] = known_.from(window.left, window.row(k)) & window.columns;
      reached[k] &= known[k];
    });
    take(block, window, known, reached);
    const float own = sides_[1].median();
    Rows settled = reached;
    const bool stays = settleSides(block, window, known, own, settled);
    if (windows_->isMedian()) {
      out = stays ? own : medianOf(block, window, reached, settled);
      return true;
    }
    if (means_) {
      out = meanOf(window, reached, settled, stays ? 1 : side_of_middle_);
      return true;
    }
    return runOn(block, window, settled, column, job, out);
  }

  // The samples to which a way leads from the middle, holes among them: up and down until nothing is new.
  void findReached(const Window& window, Rows& reached) const noexcept {
    Rows cut{}, cut_up{};
    eachRow(window, [&](std::size_t k) {
      cut[k] = cut_right_.from(window.left, window.row(k));
      cut_up[k] = cut_up_.from(window.left, window.row(k));
      reached[k] = 0;
    });
    const auto enter = [&](int r, WindowRow samples) {
      const auto k = static_cast<std::size_t>(r);
      if ((samples & ~reached[k]) == 0) return false;
      reached[k] = alongRow(reached[k] | samples, cut[k], window.columns);
      return true;
    };
    bool more = enter(window.middle_row, WindowRow{1} << radius_);
    while (std::exchange(more, false)) {
      for (int r = 1; r < window.rows; ++r) {
        const auto below = static_cast<std::size_t>(r - 1);
        more |= enter(r, reached[below] & ~cut_up[below]);
      }
      for (int r = window.rows - 2; r >= 0; --r) {
        const auto k = static_cast<std::size_t>(r);
        more |= enter(r, reached[k + 1] & ~cut_up[k]);
      }
    }
  }

  // Makes sides_ the samples of a window: 1 those that are reached, 0 the others. The next window of a row has most of
  // them in common with the one before.
  void take(const Block& block, const Window& window, const Rows& known, const Rows& reached) {
    const int moved = window.left - taken_.window.left;
    const bool near = taken_.any && taken_.window.low == window.low && taken_.window.rows == window.rows &&
                      moved >= 0 && moved < 64 - kMostLineWindow;
    if (!near) {
      for (RankSet& side : sides_) side.clear();
      sums_ = {};
    }
    const int left = near ? taken_.window.left : window.left;
    for (int r = 0; r < window.rows; ++r) {
      const auto k = static_cast<std::size_t>(r);
      const std::uint32_t* const ranks = ranksOf(block, left, window.low + r);
      const std::int64_t* const heights = means_ ? whole_.row(window.low + r) + left : nullptr;
      const auto become = [&](std::size_t side, WindowRow before, WindowRow now) {
        forEachBit(before & ~now, [&](int c) { sides_[side].remove(ranks[c]); });
        forEachBit(now & ~before, [&](int c) { sides_[side].add(ranks[c]); });
        if (means_) sums_[side] += sumOf(heights, now & ~before) - sumOf(heights, before & ~now);
      };
      const int shift = window.left - left;
      const WindowRow was = near ? taken_.reached[k] : 0, was_known = near ? taken_.known[k] : 0;
      become(1, was, reached[k] << shift);
      become(0, was_known & ~was, (known[k] & ~reached[k]) << shift);
    }
    taken_ = {true, window, known, reached};
  }

  [[nodiscard]] const std::uint32_t* ranksOf(const Block& block, int left, int row) const noexcept {
    return ranks_.ranks() + static_cast<std::ptrdiff_t>(row) * block.columns + left;
  }

  // A located line is some tenths of a sample off. Where both sides of the window differ by far more than each varies,
  // the samples next to the line are on the side whose height they are nearer to. `settled`, the samples that are reached,
  // become those on the side of the middle. True if they stay what they were.
  bool settleSides(const Block& block, const Window& window, const Rows& known, float own, Rows& settled) {
    const float own_spread = sides_[1].spread(own);
    // A window may hold no more of the other side than samples that the line has on this one.
    const bool one_side = sides_[0].size() == 0;
    const float other = one_side ? own : sides_[0].median();
    const float spread = one_side ? own_spread : std::max(own_spread, sides_[0].spread(other));
    if (one_side ? sides_[1].farthest(own) <= kStandsOut * spread
                 : !(std::fabs(own - other) > kFarApart * spread))
      return true;
    const auto standsOut = [&](float z) { return std::fabs(z - own) > kStandsOut * spread; };
    const auto heightsOf = [&](int r) { return block.row(window.low + r) + window.left; };
    const auto nearOf = [&](int r) { return near_.from(window.left, window.low + r); };
    if (one_side)
      for (int r = 0; r < window.rows; ++r) {
        bool far = false;
        forEachBit(known[static_cast<std::size_t>(r)] & ~nearOf(r),
                   [&](int c) { far = far || standsOut(heightsOf(r)[c]); });
        // A way around the end of the line leads to the other side.
        if (far) return true;
      }
    for (int r = 0; r < window.rows; ++r) {
      WindowRow& row = settled[static_cast<std::size_t>(r)];
      forEachBit(known[static_cast<std::size_t>(r)] & nearOf(r), [&](int c) {
        const float z = heightsOf(r)[c];
        const bool fits = one_side ? !standsOut(z) : std::fabs(z - own) <= std::fabs(z - other);
        row = (row & ~(WindowRow{1} << c)) | WindowRow{fits} << c;
      });
    }
    side_of_middle_ = settled[static_cast<std::size_t>(window.middle_row)] >> radius_ & 1U;
    if (side_of_middle_ == 0) eachRow(window, [&](std::size_t k) { settled[k] = known[k] & ~settled[k]; });
    return false;
  }

  // Of the samples that are settled, which are most of one side's.
  float medianOf(const Block& block, const Window& window, const Rows& reached, const Rows& settled) {
    const bool own = side_of_middle_ == 1;
    RankSet& side = sides_[side_of_middle_];
    const auto swap = [&](bool back) {
      eachRow(window, [&](std::size_t k) {
        const WindowRow before = own ? reached[k] : taken_.known[k] & ~reached[k];
        const std::uint32_t* const ranks = ranksOf(block, window.left, window.row(k));
        forEachBit(back ? before & ~settled[k] : settled[k] & ~before, [&](int c) { side.add(ranks[c]); });
        forEachBit(back ? settled[k] & ~before : before & ~settled[k], [&](int c) { side.remove(ranks[c]); });
      });
    };
    swap(false);
    const float median = side.median();
    swap(true);
    return median;
  }

  static std::int64_t sumOf(const std::int64_t* heights, WindowRow samples) noexcept {
    std::int64_t sum = 0;
    forEachBit(samples, [&](int c) { sum += heights[c]; });
    return sum;
  }

  // The same of the mean, `side` the one that most of them are of.
  [[nodiscard]] float meanOf(const Window& window, const Rows& reached, const Rows& settled,
                             std::size_t side) const noexcept {
    std::int64_t sum = sums_[side];
    int count = sides_[side].size();
    eachRow(window, [&](std::size_t k) {
      const WindowRow before = side == 1 ? reached[k] : taken_.known[k] & ~reached[k];
      if (before == settled[k]) return;
      const std::int64_t* const heights = whole_.row(window.row(k)) + window.left;
      sum += sumOf(heights, settled[k] & ~before) - sumOf(heights, before & ~settled[k]);
      count += std::popcount(settled[k]) - std::popcount(before);
    });
    return whole_.mean(sum, count);
  }

  bool runOn(const Block& block, const Window& inner, const Rows& samples, int column, const JobControl& job,
             float& out) {
    Block window;
    const int first = std::countr_zero(inner.columns);
    window.columns = std::popcount(inner.columns);
    window.rows = inner.rows;
    window.stride = (window.columns + 31) / 16 * 16;
    window.first_column = column - inner.left - first;
    window.first_row = inner.middle_row;
    window.out_columns = window.out_rows = 1;
    window.out_stride = kOutputs;
    window.holes = true;
    window.magnitude = block.magnitude;
    heights_.assign(at(static_cast<int>(window.stride), 0, window.rows),
                    std::numeric_limits<float>::quiet_NaN());
    for (int r = 0; r < window.rows; ++r) {
      const float* const from = block.row(inner.low + r) + inner.left;
      float* const to = &heights_[at(static_cast<int>(window.stride), 0, r)];
      forEachBit(samples[static_cast<std::size_t>(r)], [&](int c) { to[c - first] = from[c]; });
    }
    window.heights = heights_.data();
    float results[kOutputs];
    window.out = results;
    if (!windows_->run(window, job)) return false;
    out = results[0];
    return true;
  }

  static constexpr float kFarApart = 9.0F;    // six standard deviations, in medians of distances
  static constexpr float kStandsOut = 27.0F;  // of one sample among a few
  static constexpr int kOutputs = 16;         // room for a vector
  std::unique_ptr<BlockFilter> windows_;
  int radius_;
  BitRows cut_right_, cut_up_, near_, known_;
  std::vector<std::uint8_t> crossed_;
  Ranks ranks_;
  RankSet sides_[2];
  // What sides_ holds.
  struct Taken {
    bool any = false;
    Window window;
    Rows known{}, reached{};
  } taken_;
  std::size_t side_of_middle_ = 1;  // of the window at hand, once settled
  bool means_ = false;              // by sums_, those of sides_
  WholeHeights whole_;
  std::array<std::int64_t, 2> sums_{};
  std::vector<float> heights_;
};

}  // namespace

std::unique_ptr<BlockFilter> endingAtLines(std::unique_ptr<BlockFilter> windows, int radius) {
  return std::make_unique<LineWindows>(std::move(windows), radius);
}

}  // namespace fettle::engine
