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
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

constexpr float kStep = 0.2F;
constexpr double kSteepest = 1e15;  // [theta]; the squares of more would leave float

#define FETTLE_KERNEL "engine/filter/total_variation-inl.h"
#include "engine/simd/each_cpu-inl.h"

class TotalVariationFilter final : public BlockFilter {
 public:
  TotalVariationFilter(const FilterSpec& spec, CpuLevel level)
      : theta_(spec.range_sigma),
        steps_(spec.window / 2),
        differences_(FETTLE_AT_LEVEL(level, differences)),
        divergence_(FETTLE_AT_LEVEL(level, divergence)),
        climb_(FETTLE_AT_LEVEL(level, climb)),
        move_row_(FETTLE_AT_LEVEL(level, moveRow)) {}

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
        climb_(at(slope_along_, r), at(slope_across_, r), here_.data(), next_.data(), columns_, at(along_, r),
               at(across_, r));
        here_.swap(next_);
      }
    }
    for (int r = 0; r < block.out_rows; ++r) {
      divergenceOf(block.first_row + r, here_);
      move_row_(block.row(block.first_row + r) + block.first_column, here_.data() + block.first_column,
                theta_, block.out_columns, block.out + r * block.out_stride);
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
      differences_(row.data(), next.data(), 1.0 / theta_, columns_, at(slope_along_, r),
                   at(slope_across_, r));
    }
    std::fill(here_.begin(), here_.end(), 0.0F);
    std::fill(next_.begin(), next_.end(), 0.0F);
  }

  void divergenceOf(int row, std::vector<float>& out) {
    divergence_(at(along_, row), at(across_, row), at(across_, row - 1), columns_, out.data());
  }

  double theta_;
  int steps_;
  decltype(&plain::differences) differences_;
  decltype(&plain::divergence) divergence_;
  decltype(&plain::climb) climb_;
  decltype(&plain::moveRow) move_row_;
  int columns_ = 0;
  int rows_ = 0;
  std::ptrdiff_t stride_ = 0;
  std::vector<float> along_, across_;              // p
  std::vector<float> slope_along_, slope_across_;  // grad(f / theta)
  std::vector<float> here_, next_;                 // div p of two rows
};

}  // namespace

std::unique_ptr<BlockFilter> makeTotalVariationFilter(const FilterSpec& spec, CpuLevel level) {
  return std::make_unique<TotalVariationFilter>(spec, level);
}

}  // namespace fettle::engine
