// The weighted mean of a square window with weights that are a product, w(dx) * w(dy): one pass down, one
// along. The order of additions is fixed for each output and counted from its own centre, outermost pair
// first; a sample that is not there adds a zero. So an output depends on its window alone, and a block with a
// hole somewhere else has the same bits as one without.

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/filter/block.h"

namespace fettle::engine {

namespace {

// weights[k] for the distance k = 0 .. radius; their sum over -radius .. radius is 1 up to rounding. Weights
// far out are dropped as long as all that is dropped is below 2^-64 of the whole: a tenth of what the double
// roundings may lose anyway, and for a binomial window of 1001 that leaves 149 of 501.
std::vector<double> halfWeights(const FilterSpec& spec) {
  const int radius = spec.window / 2;
  std::vector<long double> exact(static_cast<std::size_t>(radius) + 1);
  if (spec.sigma == 0.0) {
    // C(n - 1, k) / 2^(n - 1): at most 2.7e299 before the scaling, and exact as long as it has 64 bits.
    long double c = 1.0L;
    for (int k = 0; k <= radius; ++k) {
      exact[static_cast<std::size_t>(radius - k)] = std::ldexp(c, -2 * radius);
      c = c * (2 * radius - k) / (k + 1);
    }
  } else {
    const auto sigma = static_cast<long double>(spec.sigma);
    long double sum = 0.0L;
    for (int k = radius; k >= 0; --k) {
      const long double w = std::exp(-0.5L * (k / sigma) * (k / sigma));
      exact[static_cast<std::size_t>(k)] = w;
      sum += k == 0 ? w : 2 * w;
    }
    for (long double& w : exact) w /= sum;
  }
  long double dropped = 0.0L;
  while (exact.size() > 1 && dropped + 2 * exact.back() <= std::ldexp(1.0L, -64)) {
    dropped += 2 * exact.back();
    exact.pop_back();
  }
  return {exact.begin(), exact.end()};
}

constexpr int kChunk = 32;  // accumulators that stay in registers or in the first lines of the cache

// One column of the window, both halves: rows above[k] and below[k] (null where the field has none), k >= 1.
struct Rows {
  const float* const* above;
  const float* const* below;
  const float* centre;
};

template <bool kHoles>
FETTLE_INTO_EACH_CPU void load(const float* row, int at, int n, double* __restrict value,
                               double* __restrict there) {
  for (int i = 0; i < n; ++i) {
    const float v = row[at + i];
    const bool is = !kHoles || v == v;
    value[i] = is ? static_cast<double>(v) : 0.0;
    if constexpr (kHoles) there[i] = is ? 1.0 : 0.0;
  }
}

// value[c] = sum over the column of w * height; with holes there[c] = sum of w over the samples there are.
template <bool kHoles>
FETTLE_INTO_EACH_CPU void down(const Rows& rows, const double* weights, int radius, int n,
                               double* __restrict value, double* __restrict there) {
  for (int c = 0; c < n; c += kChunk) {
    const int m = std::min(kChunk, n - c);
    double sum[kChunk] = {};
    double sum_there[kChunk] = {};
    double v0[kChunk], v1[kChunk], t0[kChunk], t1[kChunk];
    for (int k = radius; k >= 1; --k) {
      const float* above = rows.above[k];
      const float* below = rows.below[k];
      const double w = weights[k];
      if (!kHoles && m == kChunk && above != nullptr && below != nullptr) {
        for (int i = 0; i < kChunk; ++i)
          sum[i] += w * (static_cast<double>(above[c + i]) + static_cast<double>(below[c + i]));
        continue;
      }
      if (above == nullptr && below == nullptr) continue;
      if (above != nullptr) load<kHoles>(above, c, m, v0, t0);
      if (below != nullptr) load<kHoles>(below, c, m, v1, t1);
      for (int i = 0; i < m; ++i)
        sum[i] += w * ((above != nullptr ? v0[i] : 0.0) + (below != nullptr ? v1[i] : 0.0));
      if constexpr (kHoles)
        for (int i = 0; i < m; ++i)
          sum_there[i] += w * ((above != nullptr ? t0[i] : 0.0) + (below != nullptr ? t1[i] : 0.0));
    }
    load<kHoles>(rows.centre, c, m, v0, t0);
    for (int i = 0; i < m; ++i) value[c + i] = sum[i] + weights[0] * v0[i];
    if constexpr (kHoles)
      for (int i = 0; i < m; ++i) there[c + i] = sum_there[i] + weights[0] * t0[i];
  }
}

// out[c] = sum over k of w * in[c + radius +- k].
FETTLE_INTO_EACH_CPU void along(const double* __restrict in, const double* weights, int radius, int n,
                                double* __restrict out) {
  const double* centre = in + radius;
  int c = 0;
  for (; c + kChunk <= n; c += kChunk) {
    double sum[kChunk] = {};
    for (int k = radius; k >= 1; --k) {
      const double w = weights[k];
      const double* left = centre + c - k;
      const double* right = centre + c + k;
      for (int i = 0; i < kChunk; ++i) sum[i] += w * (left[i] + right[i]);
    }
    for (int i = 0; i < kChunk; ++i) out[c + i] = sum[i] + weights[0] * centre[c + i];
  }
  for (; c < n; ++c) {
    double sum = 0.0;
    for (int k = radius; k >= 1; --k) sum += weights[k] * (centre[c - k] + centre[c + k]);
    out[c] = sum + weights[0] * centre[c];
  }
}

FETTLE_EACH_CPU void downPlain(const Rows& rows, const double* weights, int radius, int n, double* value) {
  down<false>(rows, weights, radius, n, value, nullptr);
}
FETTLE_EACH_CPU void downHoles(const Rows& rows, const double* weights, int radius, int n, double* value,
                               double* there) {
  down<true>(rows, weights, radius, n, value, there);
}
FETTLE_EACH_CPU void alongRow(const double* in, const double* weights, int radius, int n, double* out) {
  along(in, weights, radius, n, out);
}
FETTLE_EACH_CPU void divideRow(const double* __restrict value, const double* __restrict weight, int n,
                               float* __restrict out) {
  for (int c = 0; c < n; ++c) out[c] = static_cast<float>(value[c] / weight[c]);
}

class GaussianFilter final : public BlockFilter {
 public:
  explicit GaussianFilter(const FilterSpec& spec)
      : weights_(halfWeights(spec)),
        radius_(static_cast<int>(weights_.size()) - 1),
        above_(weights_.size()),
        below_(weights_.size()) {}

  bool run(const Block& block, const JobControl& job) override {
    const int n = block.out_columns;
    const int width = n + 2 * radius_;
    const int first = block.first_column - radius_;
    const int begin = std::max(0, -first);
    const int end = std::min(width, block.columns - first);
    value_.assign(static_cast<std::size_t>(width), 0.0);
    there_.assign(static_cast<std::size_t>(width), 0.0);
    sum_.resize(static_cast<std::size_t>(n));
    sum_there_.resize(static_cast<std::size_t>(n));
    double column_weight = -1.0;

    const auto rowAt = [&](int r) {
      return r >= 0 && r < block.rows ? block.row(r) + first + begin : nullptr;
    };
    for (int r = 0; r < block.out_rows; ++r) {
      if (job.cancelled()) return false;
      const int centre = block.first_row + r;
      for (int k = 1; k <= radius_; ++k) {
        above_[static_cast<std::size_t>(k)] = rowAt(centre + k);
        below_[static_cast<std::size_t>(k)] = rowAt(centre - k);
      }
      const Rows rows{above_.data(), below_.data(), rowAt(centre)};
      if (block.holes) {
        downHoles(rows, weights_.data(), radius_, end - begin, value_.data() + begin, there_.data() + begin);
        alongRow(there_.data(), weights_.data(), radius_, n, sum_there_.data());
      } else {
        downPlain(rows, weights_.data(), radius_, end - begin, value_.data() + begin);
        // The same additions as with holes, done once for all columns and kept while rows stay alike.
        double weight = 0.0;
        for (int k = radius_; k >= 1; --k) {
          const auto i = static_cast<std::size_t>(k);
          weight += weights_[i] * ((above_[i] != nullptr ? 1.0 : 0.0) + (below_[i] != nullptr ? 1.0 : 0.0));
        }
        weight += weights_[0];
        if (weight != column_weight) {
          column_weight = weight;
          std::fill(there_.begin() + begin, there_.begin() + end, weight);
          alongRow(there_.data(), weights_.data(), radius_, n, sum_there_.data());
        }
      }
      alongRow(value_.data(), weights_.data(), radius_, n, sum_.data());
      divideRow(sum_.data(), sum_there_.data(), n, block.out + r * block.out_stride);
    }
    return true;
  }

 private:
  std::vector<double> weights_;
  int radius_;
  std::vector<const float*> above_, below_;
  std::vector<double> value_, there_, sum_, sum_there_;
};

}  // namespace

std::unique_ptr<BlockFilter> makeGaussianFilter(const FilterSpec& spec) {
  return std::make_unique<GaussianFilter>(spec);
}

}  // namespace fettle::engine
