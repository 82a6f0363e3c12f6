// C. Tomasi and R. Manduchi, Bilateral filtering for gray and color images (1998), with a weight over height
// differences that ends: (1 - d^2 / (32 R^2))^16 is a Gaussian of standard deviation R to within 0.019, takes
// no exponential, and gives an outlier no weight at all where a Gaussian gives it a little.
//
// Differences are taken before all else and in float, so that a scan at 5000 m loses nothing of its noise of
// millimetres. The two samples opposite each other across the centre are added to each other first: over a
// plane they cancel exactly.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/filter/block.h"
#include "engine/filter/padded_block.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

constexpr int kChunk = 32;       // outputs whose sums stay in registers
constexpr float kBeyond = 6.0F;  // [range sigmas], past the last weight at sqrt(32)

#define FETTLE_KERNEL "engine/filter/bilateral-inl.h"
#include "engine/simd/each_cpu-inl.h"

class BilateralFilter final : public BlockFilter {
 public:
  BilateralFilter(const FilterSpec& spec, CpuLevel level)
      : level_(level), range_(spec.range_sigma), radius_(spec.window / 2), side_(spec.window) {
    const double sigma = spec.sigma > 0.0 ? spec.sigma : 0.25 * spec.window;
    weights_.resize(static_cast<std::size_t>(radius_ + 1) * static_cast<std::size_t>(side_));
    for (int dy = 0; dy <= radius_; ++dy)
      for (int dx = -radius_; dx <= radius_; ++dx) {
        const double y = dy / sigma, x = dx / sigma;
        weights_[static_cast<std::size_t>(dy * side_ + dx + radius_)] =
            static_cast<float>(std::exp(-0.5 * (x * x + y * y)));
      }
  }

  bool run(const Block& block, const JobControl& job) override {
    // Past the field's other side there are holes alone, which add nothing.
    const int reach_x = std::min(radius_, block.columns - 1), reach_y = std::min(radius_, block.rows - 1);
    padded_.fill(block, radius_, kChunk);
    const int chunks = (block.out_columns + kChunk - 1) / kChunk;
    const auto per_range = static_cast<float>(1.0 / range_);
    const auto add_rows = FETTLE_AT_LEVEL(level_, addRows);
    const auto finish_row = FETTLE_AT_LEVEL(level_, finishRow);
    for (int r = 0; r < block.out_rows; ++r) {
      sum_.assign(static_cast<std::size_t>(chunks * kChunk), 0.0);
      sum_weight_.assign(static_cast<std::size_t>(chunks * kChunk), 1.0);  // the centre's own
      const float* centre = padded_.row(r);
      for (int dy = 0; dy <= reach_y; ++dy) {
        if (job.cancelled()) return false;
        add_rows(centre, padded_.row(r + dy), padded_.row(r - dy), weights_.data() + dy * side_ + radius_,
                 dy == 0 ? 1 : -reach_x, reach_x, per_range, chunks, sum_.data(), sum_weight_.data());
      }
      finish_row(centre, sum_.data(), sum_weight_.data(), range_, block.out_columns,
                 block.out + r * block.out_stride);
    }
    return true;
  }

 private:
  CpuLevel level_;
  double range_;
  int radius_;
  int side_;
  std::vector<float> weights_;  // radius + 1 rows of side
  PaddedBlock padded_;
  std::vector<double> sum_, sum_weight_;
};

}  // namespace

std::unique_ptr<BlockFilter> makeBilateralFilter(const FilterSpec& spec, CpuLevel level) {
  return std::make_unique<BilateralFilter>(spec, level);
}

}  // namespace fettle::engine
