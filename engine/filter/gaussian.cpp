// The weighted mean of a square window with weights that are a product, w(dx) * w(dy): one pass down, one
// along, in fused multiply-adds. The order of additions is fixed for each output, first sample of its window
// to last; a sample that is not there adds a zero. So an output depends on its window alone, and a block with
// a hole somewhere else has the same bits as one without.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include <tbb/cache_aligned_allocator.h>

#include "engine/filter/block.h"
#include "engine/filter/gaussian_weights.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

// What a kernel works on: some rows of outputs at once, all that their windows reach, and what is between the
// pass down and the pass along.
struct GaussianGroup {
  const double* weights;      // by distance
  const double* all_weights;  // of the whole window, first to last
  int taps;
  const float* const* rows;  // of the block, as many as the outputs' windows reach; from the first column
  int columns;               // that windows reach and the field has
  double* value;             // sums down the columns, from the first column
  double* there;             // sums of the weights of samples that there are; only with holes
  std::ptrdiff_t stride;     // of both: from row to row, in the large kernels from plane to plane
  double* strip;             // of the large kernels: (rows + 2 radius) x kSide samples, twice with holes
  const double* inverse;     // of the weight that each output's window has in all; only without holes
  float* const* out;         // of each row
  int out_columns;
};

// Rows of outputs in a group of the small kernels, and of the large ones: the more, the fewer times a sample
// is fetched for another group's windows; what is between the passes must stay near the core.
constexpr int kSmallRows = 4;
constexpr int kLargeRows = 32;
// Columns or rows that the large kernels take side by side.
constexpr int kSide = 16;

#define FETTLE_KERNEL "engine/filter/gaussian-inl.h"
#include "engine/simd/each_cpu-inl.h"

using Kernel = void (*)(const GaussianGroup&, bool holes);

constexpr int kSmallRadius = 3;  // from here on the turned kernels are faster

template <int kRadius>
std::pair<Kernel, Kernel> smallKernels(int radius, CpuLevel level) noexcept {
  if constexpr (kRadius < kSmallRadius)
    if (radius != kRadius) return smallKernels<kRadius + 1>(radius, level);
  return {FETTLE_AT_LEVEL(level, smallDown<kRadius>), FETTLE_AT_LEVEL(level, smallFinish<kRadius>)};
}

// Rows in groups: down the columns first, with the sums kept in double, then along the rows. The small
// kernels take the second pass from memory at every distance; the large ones turn rows and columns in
// between, so that they add whole vectors in both passes and a weight is fetched once for two of them.
class GaussianFilter final : public BlockFilter {
 public:
  GaussianFilter(const FilterSpec& spec, CpuLevel level)
      : weights_(gaussianHalfWeights(spec)), radius_(static_cast<int>(weights_.size()) - 1) {
    for (int k = -radius_; k <= radius_; ++k)
      all_weights_.push_back(weights_[static_cast<std::size_t>(std::abs(k))]);
    small_ = radius_ <= kSmallRadius;
    if (small_)
      std::tie(down_, finish_) = smallKernels<0>(radius_, level);
    else
      std::tie(down_, finish_) =
          std::pair<Kernel, Kernel>(FETTLE_AT_LEVEL(level, largeDown), FETTLE_AT_LEVEL(level, largeFinish));
  }

  bool run(const Block& block, const JobControl& job) override {
    const int group = small_ ? kSmallRows : kLargeRows;
    const int n = block.out_columns;
    const int width = n + 2 * radius_;
    const int first = block.first_column - radius_;
    const int begin = std::max(0, -first);
    const int end = std::min(width, block.columns - first);
    // Room for a vector more than there are columns; what lies outside the field is 0 and stays so.
    const std::size_t room = static_cast<std::size_t>(width + 31) / 8 * 8;
    value_.assign(room * static_cast<std::size_t>(group), 0.0);
    there_.clear();
    inverse_.resize(static_cast<std::size_t>(n) + 8);
    double weight_before = -1.0;
    no_row_.assign(static_cast<std::size_t>(block.columns) + 16, std::numeric_limits<float>::quiet_NaN());

    GaussianGroup g{};
    g.weights = weights_.data();
    g.all_weights = all_weights_.data();
    g.taps = 2 * radius_ + 1;
    g.columns = end - begin;
    g.stride = static_cast<std::ptrdiff_t>(small_ ? room : room * kSide);
    g.out_columns = n;
    if (!small_) strip_.resize(static_cast<std::size_t>(2 * kSide * (kLargeRows + 2 * radius_)));
    g.strip = strip_.data();
    const std::ptrdiff_t a_column = small_ ? 1 : kSide;
    rows_.resize(static_cast<std::size_t>(group + 2 * radius_));
    out_.resize(static_cast<std::size_t>(group));
    spare_.resize(static_cast<std::size_t>(n) + 8);
    for (int r = 0; r < block.out_rows; r += group) {
      if (job.cancelled()) return false;
      const int top = block.first_row + r - radius_;
      bool holes = block.holes;
      for (int i = 0; i < group + 2 * radius_; ++i) {
        const bool there = top + i >= 0 && top + i < block.rows;
        rows_[static_cast<std::size_t>(i)] = there ? block.row(top + i) + first + begin : no_row_.data();
        holes |= !there;
      }
      for (int j = 0; j < group; ++j)
        out_[static_cast<std::size_t>(j)] =
            r + j < block.out_rows ? block.out + (r + j) * block.out_stride : spare_.data();
      if (holes && there_.size() < value_.size()) there_.assign(value_.size(), 0.0);
      g.rows = rows_.data();
      g.out = out_.data();
      g.value = value_.data() + begin * a_column;
      g.there = holes ? there_.data() + begin * a_column : nullptr;
      down_(g, holes);
      // The last vector may have reached beyond the field.
      for (int c = end; c < std::min(begin + (end - begin + 15) / 16 * 16, static_cast<int>(room)); ++c)
        for (int j = 0; j < group; ++j) {
          const std::ptrdiff_t row = small_ ? j * g.stride : j / kSide * g.stride + j % kSide;
          value_[static_cast<std::size_t>(c * a_column + row)] = 0.0;
          if (holes) there_[static_cast<std::size_t>(c * a_column + row)] = 0.0;
        }
      g.value = value_.data();
      if (holes) {
        g.there = there_.data();
      } else {
        weigh(begin, end, n, weight_before);
        g.inverse = inverse_.data();
      }
      finish_(g, holes);
    }
    return true;
  }

 private:
  // The weight of each output's window where no sample is missing but beyond the sides, inverted: the same
  // operations as with holes, done once for all rows.
  void weigh(int begin, int end, int n, double& before) {
    double column = 0.0;
    for (const double w : all_weights_) column = std::fma(w, 1.0, column);
    if (column == before) return;
    before = column;
    const int taps = 2 * radius_ + 1;
    double whole = 0.0;  // of a window that no side cuts, once there is one
    for (int c = 0; c < n; ++c) {
      const int from = std::max(begin - c, 0);
      const int to = std::min(end - c, taps);
      double& inverse = inverse_[static_cast<std::size_t>(c)];
      if (to - from == taps && whole != 0.0) {
        inverse = whole;
        continue;
      }
      double weight = 0.0;
      for (int i = from; i < to; ++i)
        weight = std::fma(all_weights_[static_cast<std::size_t>(i)], column, weight);
      inverse = 1.0 / weight;
      if (to - from == taps) whole = inverse;
    }
  }

  std::vector<double> weights_;
  int radius_;
  std::vector<double> all_weights_;
  bool small_ = false;
  Kernel down_ = nullptr;
  Kernel finish_ = nullptr;
  std::vector<const float*> rows_;
  std::vector<float*> out_;
  std::vector<float> spare_, no_row_;
  // A vector that lies across two cache lines is fetched twice.
  using Aligned = std::vector<double, tbb::cache_aligned_allocator<double>>;
  Aligned value_, there_, strip_;
  std::vector<double> inverse_;
};

}  // namespace

std::unique_ptr<BlockFilter> makeGaussianFilter(const FilterSpec& spec, CpuLevel level) {
  return std::make_unique<GaussianFilter>(spec, level);
}

}  // namespace fettle::engine
