// The mean of a square window, at a cost that does not depend on the window: column sums that gain the row
// that enters and lose the row that leaves, and a sum of columns that slides along the row (M. J. McDonnell,
// Box-filtering techniques, 1981). Running sums are usually given up for exactness' sake; here they are
// exact, see exact_sum.h, so each output is the rounding of the one true sum, however it was come by.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/filter/block.h"
#include "engine/filter/exact_sum.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

// Column sums, one array a lane, and with holes one array more that counts samples. Element j of each stands
// for the column first_column - radius + j of the block; where the field has no such column it stays 0.
struct Columns {
  double* sums;
  std::ptrdiff_t lane_stride;
  int begin, end;  // the part that lies in the field
};

struct RowWork {
  const float* enter;
  const float* leave;
  const double* cut;
  int radius;
  double rows;              // samples that the window has in a column, without holes
  const double* row_count;  // columns that the window of each output has, without holes
  double* window;           // lanes x n sums, then n counts
  float* out;
  int n;
};

#define FETTLE_KERNEL "engine/filter/box-inl.h"
#include "engine/simd/each_cpu-inl.h"

class BoxFilter final : public BlockFilter {
 public:
  BoxFilter(int radius, CpuLevel level) : radius_(radius), level_(level) {}

  bool run(const Block& block, const JobControl& job) override {
    const int n = block.out_columns;
    const int width = n + 2 * radius_;
    const std::int64_t side = 2 * radius_ + 1;
    const SumLanes lanes =
        chooseLanes(block.heights, block.stride, block.columns, block.rows, block.magnitude, side * side);

    sums_.assign(static_cast<std::size_t>(SumLanes::kMaxLanes + 1) * width, 0.0);
    window_.resize(sums_.size());
    count_.resize(static_cast<std::size_t>(n));
    const int first = block.first_column - radius_;
    const Columns at{sums_.data(), width, std::max(0, -first), std::min(width, block.columns - first)};
    for (int c = 0; c < n; ++c)
      count_[static_cast<std::size_t>(c)] = std::min(c + 2 * radius_ + 1, at.end) - std::max(c, at.begin);

    const auto rowAt = [&](int r) {
      return r >= 0 && r < block.rows ? block.row(r) + first + at.begin : nullptr;
    };
    const auto add =
        block.holes ? FETTLE_AT_LEVEL(level_, addOnly<true>) : FETTLE_AT_LEVEL(level_, addOnly<false>);
    for (int r = block.first_row - radius_; r < block.first_row + radius_; ++r) {
      if (job.cancelled()) return false;
      add(rowAt(r), at, lanes);
    }
    const auto row = block.holes ? rowOf<true>(lanes.lanes) : rowOf<false>(lanes.lanes);
    for (int r = 0; r < block.out_rows; ++r) {
      if (job.cancelled()) return false;
      const int centre = block.first_row + r;
      const int rows = std::min(centre + radius_ + 1, block.rows) - std::max(centre - radius_, 0);
      row(at,
          {rowAt(centre + radius_), r == 0 ? nullptr : rowAt(centre - radius_ - 1), lanes.cut, radius_,
           static_cast<double>(rows), count_.data(), window_.data(), block.out + r * block.out_stride, n});
    }
    return true;
  }

  [[nodiscard]] bool isMean() const noexcept override { return true; }

 private:
  using Row = void (*)(const Columns& at, const RowWork& work) noexcept;

  // With as many lanes of sums.
  template <bool kHoles>
  [[nodiscard]] Row rowOf(int lanes) const noexcept {
    if (lanes == 1) return FETTLE_AT_LEVEL(level_, doRow<1, kHoles>);
    if (lanes == 2) return FETTLE_AT_LEVEL(level_, doRow<2, kHoles>);
    return FETTLE_AT_LEVEL(level_, doRow<SumLanes::kMaxLanes, kHoles>);
  }

  int radius_;
  CpuLevel level_;
  std::vector<double> sums_, window_, count_;
};

}  // namespace

std::unique_ptr<BlockFilter> makeBoxFilter(const FilterSpec& spec, CpuLevel level) {
  return std::make_unique<BoxFilter>(spec.window / 2, level);
}

}  // namespace fettle::engine
