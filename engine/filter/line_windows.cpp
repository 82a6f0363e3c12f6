#include "engine/filter/line_windows.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "engine/filter/median.h"

namespace fettle::engine {

namespace {

class LineWindows final : public BlockFilter {
 public:
  LineWindows(std::unique_ptr<BlockFilter> windows, int radius)
      : windows_(std::move(windows)), radius_(radius) {}

  bool run(const Block& block, const JobControl& job) override {
    if (!windows_->run(windowsOnly(block), job)) return false;
    if (block.cuts == nullptr || !findLines(block)) return true;
    for (int r = 0; r < block.out_rows; ++r) {
      if (job.cancelled()) return false;
      for (int c = 0; c < block.out_columns; ++c) {
        if (crossed_[at(block.out_columns, c, r)] == 0) continue;
        const int column = block.first_column + c, row = block.first_row + r;
        if (std::isnan(block.row(row)[column])) continue;
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
          links_.assign(at(block.columns, 0, block.rows), 0);
          near_.assign(links_.size(), 0);
          crossed_.assign(at(block.out_columns, 0, block.out_rows), 0);
        }
        links_[at(block.columns, c, r)] = cut.links;
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

  // The samples within kLineReach of a cut link, whose second sample is to the right or above. Every window asks this of
  // all its samples.
  void markNear(const Block& block, int column, int row) {
    const int c0 = std::max(column + 1 - kLineReach, 0);
    const int c1 = std::min(column + kLineReach, block.columns - 1);
    for (int r = std::max(row + 1 - kLineReach, 0); r <= std::min(row + kLineReach, block.rows - 1); ++r)
      std::fill_n(near_.begin() + static_cast<std::ptrdiff_t>(at(block.columns, c0, r)), c1 - c0 + 1,
                  std::uint8_t{1});
  }

  // The filter on a window of its own, without what lies beyond a line.
  bool runWindow(const Block& block, int column, int row, const JobControl& job, float& out) {
    const int c0 = std::max(column - radius_, 0), c1 = std::min(column + radius_, block.columns - 1);
    const int r0 = std::max(row - radius_, 0), r1 = std::min(row + radius_, block.rows - 1);
    Block window;
    window.columns = c1 - c0 + 1;
    window.rows = r1 - r0 + 1;
    window.stride = (window.columns + 31) / 16 * 16;
    window.first_column = column - c0;
    window.first_row = row - r0;
    window.out_columns = window.out_rows = 1;
    window.out_stride = kOutputs;
    window.holes = true;
    window.magnitude = block.magnitude;
    heights_.assign(at(static_cast<int>(window.stride), 0, window.rows),
                    std::numeric_limits<float>::quiet_NaN());
    reached_.assign(at(window.columns, 0, window.rows), 0);
    const auto reach = [&](int c, int r) {
      if (std::exchange(reached_[at(window.columns, c, r)], std::uint8_t{1}) == 0) next_.emplace_back(c, r);
    };
    const auto whole = [&](int c, int r, int link) {
      return (links_[at(block.columns, c0 + c, r0 + r)] & link) == 0;
    };
    reach(window.first_column, window.first_row);
    while (!next_.empty()) {
      const auto [c, r] = next_.back();
      next_.pop_back();
      if (c + 1 < window.columns && whole(c, r, LineCut::kRight)) reach(c + 1, r);
      if (c > 0 && whole(c - 1, r, LineCut::kRight)) reach(c - 1, r);
      if (r + 1 < window.rows && whole(c, r, LineCut::kUp)) reach(c, r + 1);
      if (r > 0 && whole(c, r - 1, LineCut::kUp)) reach(c, r - 1);
    }
    const auto height = [&](int c, int r) { return block.row(r0 + r)[c0 + c]; };
    const std::uint8_t own = settleSides(window, c0, r0, block, height);
    for (int r = 0; r < window.rows; ++r)
      for (int c = 0; c < window.columns; ++c)
        if (reached_[at(window.columns, c, r)] == own)
          heights_[at(static_cast<int>(window.stride), c, r)] = height(c, r);
    window.heights = heights_.data();
    float results[kOutputs];
    window.out = results;
    if (!windows_->run(window, job)) return false;
    out = results[0];
    return true;
  }

  // A located line is some tenths of a sample off. Where both sides of the window differ by far more than each varies,
  // the samples next to the line are on the side whose height they are nearer to. Returns the side of the middle.
  std::uint8_t settleSides(const Block& window, int c0, int r0, const Block& block, auto&& height) {
    const auto isNear = [&](int c, int r) { return near_[at(block.columns, c0 + c, r0 + r)] != 0; };
    for (std::vector<float>& side : sides_) side.clear();
    for (int r = 0; r < window.rows; ++r)
      for (int c = 0; c < window.columns; ++c)
        if (const float z = height(c, r); z == z) sides_[reached_[at(window.columns, c, r)]].push_back(z);
    const float own = medianOf(sides_[1]);
    const float own_spread = spreadOf(sides_[1], own);
    // A window may hold no more of the other side than samples that the line has on this one.
    const bool one_side = sides_[0].empty();
    const float other = one_side ? own : medianOf(sides_[0]);
    const float spread = one_side ? own_spread : std::max(own_spread, spreadOf(sides_[0], other));
    if (!one_side && !(std::fabs(own - other) > kFarApart * spread)) return 1;
    const auto standsOut = [&](int c, int r) { return std::fabs(height(c, r) - own) > kStandsOut * spread; };
    if (one_side)
      for (int r = 0; r < window.rows; ++r)
        for (int c = 0; c < window.columns; ++c)
          // A way around the end of the line leads to the other side.
          if (standsOut(c, r) && !isNear(c, r)) return 1;
    for (int r = 0; r < window.rows; ++r)
      for (int c = 0; c < window.columns; ++c) {
        if (!isNear(c, r)) continue;
        const bool fits =
            one_side ? !standsOut(c, r) : std::fabs(height(c, r) - own) <= std::fabs(height(c, r) - other);
        reached_[at(window.columns, c, r)] = fits ? 1 : 0;
      }
    return reached_[at(window.columns, window.first_column, window.first_row)];
  }

  // Of an even number the mean of the middle two: the same upside down.
  static float medianOf(std::vector<float>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return values.size() % 2 != 0 ? *middle : midpoint(*std::max_element(values.begin(), middle), *middle);
  }
  // Median of the distances from the median.
  static float spreadOf(std::vector<float>& values, float median) {
    for (float& value : values) value = std::fabs(value - median);
    return medianOf(values);
  }

  static constexpr int kLineReach = 2;        // [samples] from a cut link
  static constexpr float kFarApart = 9.0F;    // six standard deviations, in medians of distances
  static constexpr float kStandsOut = 27.0F;  // of one sample among a few
  static constexpr int kOutputs = 16;         // room for a vector
  std::unique_ptr<BlockFilter> windows_;
  int radius_;
  std::vector<std::uint8_t> links_, near_, crossed_, reached_;
  std::vector<float> heights_, sides_[2];
  std::vector<std::pair<int, int>> next_;
};

}  // namespace

std::unique_ptr<BlockFilter> endingAtLines(std::unique_ptr<BlockFilter> windows, int radius) {
  return std::make_unique<LineWindows>(std::move(windows), radius);
}

}  // namespace fettle::engine
