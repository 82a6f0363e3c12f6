// The mean of a square window, at a cost that does not depend on the window: column sums that gain the row
// that enters and lose the row that leaves, and a sum of columns that slides along the row (M. J. McDonnell,
// Box-filtering techniques, 1981). Running sums are usually given up for exactness' sake; here they are
// exact, see exact_sum.h, so each output is the rounding of the one true sum, however it was come by.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/filter/block.h"
#include "engine/filter/exact_sum.h"

namespace fettle::engine {

namespace {

// Column sums, one array a lane, and with holes one array more that counts samples. Element j of each stands
// for the column first_column - radius + j of the block; where the field has no such column it stays 0.
struct Columns {
  double* sums;
  std::ptrdiff_t lane_stride;
  int begin, end;  // the part that lies in the field
};

template <int kLanes>
FETTLE_INTO_EACH_CPU void cutUp(double x, const double* cut, double* parts) noexcept {
  for (int l = 0; l + 1 < kLanes; ++l) {
    parts[l] = (x + cut[l]) - cut[l];
    x -= parts[l];
  }
  parts[kLanes - 1] = x;
}

// Adds the row `enter` (0 if null) and takes away the row `leave` (likewise), n samples each.
template <int kLanes, bool kHoles, bool kEnter, bool kLeave>
FETTLE_INTO_EACH_CPU void moveRow(const float* __restrict enter, const float* __restrict leave, int n,
                                  double* __restrict sums, std::ptrdiff_t lane_stride,
                                  const double* cut) noexcept {
  for (int i = 0; i < n; ++i) {
    double in[kLanes] = {};
    double out[kLanes] = {};
    double counted = 0.0;
    if constexpr (kEnter) {
      const float v = enter[i];
      const bool there = !kHoles || v == v;
      cutUp<kLanes>(there ? static_cast<double>(v) : 0.0, cut, in);
      counted += there ? 1.0 : 0.0;
    }
    if constexpr (kLeave) {
      const float v = leave[i];
      const bool there = !kHoles || v == v;
      cutUp<kLanes>(there ? static_cast<double>(v) : 0.0, cut, out);
      counted -= there ? 1.0 : 0.0;
    }
    for (int l = 0; l < kLanes; ++l) sums[l * lane_stride + i] += in[l] - out[l];
    if constexpr (kHoles) sums[kLanes * lane_stride + i] += counted;
  }
}

template <int kLanes, bool kHoles>
FETTLE_INTO_EACH_CPU void moveRows(const float* enter, const float* leave, const Columns& at,
                                   const double* cut) noexcept {
  double* sums = at.sums + at.begin;
  const int n = at.end - at.begin;
  if (enter != nullptr && leave != nullptr)
    moveRow<kLanes, kHoles, true, true>(enter, leave, n, sums, at.lane_stride, cut);
  else if (enter != nullptr)
    moveRow<kLanes, kHoles, true, false>(enter, nullptr, n, sums, at.lane_stride, cut);
  else if (leave != nullptr)
    moveRow<kLanes, kHoles, false, true>(nullptr, leave, n, sums, at.lane_stride, cut);
}

// window[c] = sum of columns[c .. c + 2 radius].
FETTLE_INTO_EACH_CPU void slide(const double* __restrict columns, int radius, double* __restrict window,
                                int n) noexcept {
  double sum = 0.0;
  for (int j = 0; j <= 2 * radius; ++j) sum += columns[j];
  window[0] = sum;
  const double* enter = columns + 2 * radius;
  const double* leave = columns - 1;
  int c = 1;
  // Four steps at once, so that the chain from one sum to the next is one addition for four samples. The
  // partial steps are differences of two window sums: SumLanes leaves room for them.
  for (; c + 3 < n; c += 4) {
    const double d0 = enter[c] - leave[c];
    const double d1 = d0 + (enter[c + 1] - leave[c + 1]);
    const double d2 = d1 + (enter[c + 2] - leave[c + 2]);
    const double d3 = d2 + (enter[c + 3] - leave[c + 3]);
    window[c] = sum + d0;
    window[c + 1] = sum + d1;
    window[c + 2] = sum + d2;
    window[c + 3] = sum + d3;
    sum += d3;
  }
  for (; c < n; ++c) window[c] = sum += enter[c] - leave[c];
}

// out = sum / count, in double, then one rounding to float.
template <int kLanes>
FETTLE_INTO_EACH_CPU void divide(const double* __restrict window, std::ptrdiff_t lane_stride,
                                 const double* __restrict count, double rows, float* __restrict out,
                                 int n) noexcept {
  for (int c = 0; c < n; ++c) {
    double sum = window[c];
    if constexpr (kLanes == 2) sum += window[lane_stride + c];
    if constexpr (kLanes > 2) sum = roundedSum(window + c, kLanes, lane_stride);
    out[c] = static_cast<float>(sum / (count[c] * rows));
  }
}

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

template <int kLanes, bool kHoles>
FETTLE_INTO_EACH_CPU void doRow(const Columns& at, const RowWork& w) noexcept {
  moveRows<kLanes, kHoles>(w.enter, w.leave, at, w.cut);
  for (int l = 0; l < kLanes + (kHoles ? 1 : 0); ++l)
    slide(at.sums + l * at.lane_stride, w.radius, w.window + l * at.lane_stride, w.n);
  if constexpr (kHoles)
    divide<kLanes>(w.window, at.lane_stride, w.window + kLanes * at.lane_stride, 1.0, w.out, w.n);
  else
    divide<kLanes>(w.window, at.lane_stride, w.row_count, w.rows, w.out, w.n);
}

FETTLE_EACH_CPU void rowPlain(const Columns& at, const RowWork& w) {
  doRow<1, false>(at, w);
}
FETTLE_EACH_CPU void rowHoles(const Columns& at, const RowWork& w) {
  doRow<1, true>(at, w);
}
FETTLE_EACH_CPU void rowPlain2(const Columns& at, const RowWork& w) {
  doRow<2, false>(at, w);
}
FETTLE_EACH_CPU void rowHoles2(const Columns& at, const RowWork& w) {
  doRow<2, true>(at, w);
}
void rowPlainAll(const Columns& at, const RowWork& w) {
  doRow<SumLanes::kMaxLanes, false>(at, w);
}
void rowHolesAll(const Columns& at, const RowWork& w) {
  doRow<SumLanes::kMaxLanes, true>(at, w);
}

template <bool kHoles>
void addOnly(const float* enter, const Columns& at, const SumLanes& lanes) noexcept {
  switch (lanes.lanes) {
    case 1:
      return moveRows<1, kHoles>(enter, nullptr, at, lanes.cut);
    case 2:
      return moveRows<2, kHoles>(enter, nullptr, at, lanes.cut);
    default:
      return moveRows<SumLanes::kMaxLanes, kHoles>(enter, nullptr, at, lanes.cut);
  }
}

class BoxFilter final : public BlockFilter {
 public:
  explicit BoxFilter(int radius) : radius_(radius) {}

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
    for (int r = block.first_row - radius_; r < block.first_row + radius_; ++r) {
      if (job.cancelled()) return false;
      if (block.holes)
        addOnly<true>(rowAt(r), at, lanes);
      else
        addOnly<false>(rowAt(r), at, lanes);
    }
    const auto row = lanes.lanes == 1   ? (block.holes ? rowHoles : rowPlain)
                     : lanes.lanes == 2 ? (block.holes ? rowHoles2 : rowPlain2)
                                        : (block.holes ? rowHolesAll : rowPlainAll);
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

 private:
  int radius_;
  std::vector<double> sums_, window_, count_;
};

}  // namespace

std::unique_ptr<BlockFilter> makeBoxFilter(const FilterSpec& spec, CpuLevel) {
  return std::make_unique<BoxFilter>(spec.window / 2);
}

}  // namespace fettle::engine
