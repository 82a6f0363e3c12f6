#include "engine/filter/line_windows.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace fettle::engine {

namespace {

class LineWindows final : public BlockFilter {
 public:
  LineWindows(std::unique_ptr<BlockFilter> windows, int radius)
      : windows_(std::move(windows)), radius_(radius) {}

  bool run(const Block& block, const JobControl& job) override {
    if (!windows_->run(block, job)) return false;
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

  // The cut links of the block, and which outputs have a window with one. False when there are none.
  bool findLines(const Block& block) {
    bool any = false;
    for (int r = 0; r < block.rows; ++r)
      for (const LineCut& cut : block.cuts->row(block.low + r)) {
        const int c = cut.column - block.left;
        if (c < 0 || c >= block.columns) continue;
        if (!std::exchange(any, true)) {
          links_.assign(at(block.columns, 0, block.rows), 0);
          crossed_.assign(at(block.out_columns, 0, block.out_rows), 0);
        }
        links_[at(block.columns, c, r)] = cut.links;
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
      if (std::exchange(reached_[at(window.columns, c, r)], std::uint8_t{1}) != 0) return;
      heights_[at(static_cast<int>(window.stride), c, r)] = block.row(r0 + r)[c0 + c];
      next_.emplace_back(c, r);
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
    window.heights = heights_.data();
    float results[kOutputs];
    window.out = results;
    if (!windows_->run(window, job)) return false;
    out = results[0];
    return true;
  }

  static constexpr int kOutputs = 16;  // room for a vector
  std::unique_ptr<BlockFilter> windows_;
  int radius_;
  std::vector<std::uint8_t> links_, crossed_, reached_;
  std::vector<float> heights_;
  std::vector<std::pair<int, int>> next_;
};

}  // namespace

std::unique_ptr<BlockFilter> endingAtLines(std::unique_ptr<BlockFilter> windows, int radius) {
  return std::make_unique<LineWindows>(std::move(windows), radius);
}

}  // namespace fettle::engine
