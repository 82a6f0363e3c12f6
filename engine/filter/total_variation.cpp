// L. Rudin, S. Osher and E. Fatemi, Nonlinear total variation based noise removal algorithms (1992), worked
// out on the dual as in A. Chambolle, An algorithm for total variation minimization and applications (2004)
// and Total variation minimization and a class of binary MRF models (2005), section 3: a field p of vectors
// of length 1 at most, and u = f + theta div p,
//
//    p <- P(p + tau grad(f / theta + div p)),   P(v) = v / max(1, |v|),   p = 0 at first.
//
// grad takes the next sample less this one and is 0 where either is not there; div is minus its transpose. A
// step reaches one sample further, so after window / 2 steps an output has seen its window and no more: what
// is wrong at the rim of a block that was cut out of the field does not come as far as the outputs.
//
// grad(f / theta) is worked out once in double, from the difference of two heights: what is left to float is
// all of the order of 1, wherever the scan lies. No step with tau <= 1/4 moves two fields p apart
// (|grad|^2 <= 8), so roundings add up and never grow.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "engine/filter/block.h"

namespace fettle::engine {

namespace {

constexpr float kStep = 0.2F;
constexpr double kSteepest = 1e15;  // [theta]; the squares of more would leave float

// Differences to the next column and the next row in thetas; NaN where one of the two is missing.
FETTLE_EACH_CPU void differences(const float* row, const float* next, double per_theta, int n,
                                 float* __restrict along, float* __restrict across) noexcept {
  for (int c = 0; c < n; ++c) {
    const double here = static_cast<double>(row[c]);
    const double a = (static_cast<double>(row[c + 1]) - here) * per_theta;
    const double b = (static_cast<double>(next[c]) - here) * per_theta;
    // Shortened together, so that the direction stays.
    const double la = std::fabs(a), lb = std::fabs(b);
    double most = la > kSteepest ? la : kSteepest;  // not a number: the bound
    most = lb > most ? lb : most;
    const double shorter = kSteepest / most;
    along[c] = static_cast<float>(a * shorter);
    across[c] = static_cast<float>(b * shorter);
  }
}

// div p over a row; along[-1] is 0.
FETTLE_EACH_CPU void divergence(const float* along, const float* across, const float* across_before, int n,
                                float* __restrict out) noexcept {
  for (int c = 0; c < n; ++c) out[c] = (along[c] - along[c - 1]) + (across[c] - across_before[c]);
}

// One step of one row of p.
FETTLE_EACH_CPU void climb(const float* __restrict slope_along, const float* __restrict slope_across,
                           const float* __restrict here, const float* __restrict next, int n,
                           float* __restrict along, float* __restrict across) noexcept {
  for (int c = 0; c < n; ++c) {
    float a = along[c] + kStep * ((here[c + 1] - here[c]) + slope_along[c]);
    float b = across[c] + kStep * ((next[c] - here[c]) + slope_across[c]);
    a = a == a ? a : 0.0F;  // no neighbour, nothing flows
    b = b == b ? b : 0.0F;
    const float square = a * a + b * b;
    const float length = std::sqrt(square > 1.0F ? square : 1.0F);
    along[c] = a / length;
    across[c] = b / length;
  }
}

FETTLE_EACH_CPU void moveRow(const float* heights, const float* __restrict divergence, double theta, int n,
                             float* __restrict out) noexcept {
  for (int c = 0; c < n; ++c)
    out[c] = static_cast<float>(static_cast<double>(heights[c]) + theta * static_cast<double>(divergence[c]));
}

class TotalVariationFilter final : public BlockFilter {
 public:
  explicit TotalVariationFilter(const FilterSpec& spec) : theta_(spec.range_sigma), steps_(spec.window / 2) {}

  bool run(const Block& block, const JobControl& job) override {
    columns_ = block.columns;
    rows_ = block.rows;
    stride_ = columns_ + 1;  // a row begins with the sample before it, which has no flow
    const auto size = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows_ + 1);
    along_.assign(size, 0.0F);
    across_.assign(size, 0.0F);
    slope_along_.resize(size);
    slope_across_.resize(size);
    const auto width = static_cast<std::size_t>(columns_) + 1;
    here_.assign(width, 0.0F);
    next_.assign(width, 0.0F);
    takeSlopes(block);
    for (int step = 0; step < steps_; ++step) {
      divergenceOf(0, here_);
      for (int r = 0; r < rows_; ++r) {
        if (job.cancelled()) return false;
        // Of the row to come before this one moves: every step works on the one before alone.
        if (r + 1 < rows_) divergenceOf(r + 1, next_);
        climb(at(slope_along_, r), at(slope_across_, r), here_.data(), next_.data(), columns_, at(along_, r),
              at(across_, r));
        here_.swap(next_);
      }
    }
    for (int r = 0; r < block.out_rows; ++r) {
      divergenceOf(block.first_row + r, here_);
      moveRow(block.row(block.first_row + r) + block.first_column, here_.data() + block.first_column, theta_,
              block.out_columns, block.out + r * block.out_stride);
    }
    return true;
  }

 private:
  // Row 0 of the arrays is the row before the block's first.
  [[nodiscard]] float* at(std::vector<float>& values, int row) const noexcept {
    return values.data() + (row + 1) * stride_ + 1;
  }

  void takeSlopes(const Block& block) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    std::vector<float>& row = here_;
    std::vector<float>& next = next_;
    for (int r = 0; r < rows_; ++r) {
      std::copy_n(block.row(r), columns_, row.begin());
      row.back() = kNone;
      if (r + 1 < rows_)
        std::copy_n(block.row(r + 1), columns_, next.begin());
      else
        std::fill(next.begin(), next.end(), kNone);
      differences(row.data(), next.data(), 1.0 / theta_, columns_, at(slope_along_, r), at(slope_across_, r));
    }
    std::fill(here_.begin(), here_.end(), 0.0F);
    std::fill(next_.begin(), next_.end(), 0.0F);
  }

  void divergenceOf(int row, std::vector<float>& out) {
    divergence(at(along_, row), at(across_, row), at(across_, row - 1), columns_, out.data());
  }

  double theta_;
  int steps_;
  int columns_ = 0;
  int rows_ = 0;
  std::ptrdiff_t stride_ = 0;
  std::vector<float> along_, across_;              // p
  std::vector<float> slope_along_, slope_across_;  // grad(f / theta)
  std::vector<float> here_, next_;                 // div p of two rows
};

}  // namespace

std::unique_ptr<BlockFilter> makeTotalVariationFilter(const FilterSpec& spec, CpuLevel) {
  return std::make_unique<TotalVariationFilter>(spec);
}

}  // namespace fettle::engine
