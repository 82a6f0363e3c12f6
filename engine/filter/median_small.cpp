// Medians of windows with few samples, by comparing and exchanging only, 16 outputs abreast. Windows that
// leave the field or hold a hole have any number of samples and go one by one.

#include <algorithm>
#include <array>
#include <cstring>

#include "engine/filter/median.h"

namespace fettle::engine {

namespace {

constexpr int kAbreast = 16;
// One register with AVX-512, two with AVX, four with SSE: the compiler cuts it to what there is.
using Heights = float __attribute__((vector_size(kAbreast * sizeof(float))));

inline void load(Heights& to, const float* from) noexcept {
  std::memcpy(&to, from, sizeof to);
}

inline void exchange(Heights& a, Heights& b) noexcept {
  const Heights low = a < b ? a : b;
  const Heights high = a < b ? b : a;
  a = low;
  b = high;
}

// Moves the smallest of a[0 .. n) to a[0] and the largest to a[n - 1].
template <int n>
inline void extremesOutward(Heights* a) noexcept {
#pragma GCC unroll 32
  for (int i = 0; i < n / 2; ++i) exchange(a[i], a[n - 1 - i]);
#pragma GCC unroll 32
  for (int i = 1; i < (n + 1) / 2; ++i) exchange(a[0], a[i]);
#pragma GCC unroll 32
  for (int i = n / 2; i < n - 1; ++i) exchange(a[i], a[n - 1]);
}

// The median of an odd number of samples, 2 p + 1, while seeing p + 2 at a time: the largest and the smallest
// of p + 2 cannot be the median, so both are forgotten and one more sample is looked at ("forgetful
// selection"; N. Devillard, Fast median search: an ANSI C implementation, 1998, cites it for 3 x 3 and 5 x
// 5).
// Leaves it in a[1].
template <int n, class Next>
inline void forgetExtremes(Heights* a, Next&& next) noexcept {
  extremesOutward<n>(a);
  if constexpr (n > 3) {
    next(a[0]);
    forgetExtremes<n - 1>(a, next);
  }
}

template <int kSide>
inline void medianRow(const float* corner, std::ptrdiff_t stride, float* out) noexcept {
  constexpr int kCount = kSide * kSide;
  constexpr int kSeen = kCount / 2 + 2;
  Heights a[kSeen];
#pragma GCC unroll 32
  for (int i = 0; i < kSeen; ++i) load(a[i], corner + i / kSide * stride + i % kSide);
  int i = kSeen;
  forgetExtremes<kSeen>(a, [&](Heights& next) noexcept {
    load(next, corner + i / kSide * stride + i % kSide);
    ++i;
  });
  std::memcpy(out, &a[1], sizeof a[1]);
}

// 3 x 3: sort each column; the median of nine is the median of the largest low, the middle middle and the
// smallest high (J. L. Smith, Implementing median filters in XC4000E FPGAs, 1996).
template <>
inline void medianRow<3>(const float* corner, std::ptrdiff_t stride, float* out) noexcept {
  Heights low[3], middle[3], high[3];
  for (int i = 0; i < 3; ++i) {
    load(low[i], corner + i);
    load(middle[i], corner + stride + i);
    load(high[i], corner + 2 * stride + i);
    exchange(low[i], middle[i]);
    exchange(middle[i], high[i]);
    exchange(low[i], middle[i]);
  }
  exchange(low[0], low[1]);
  exchange(low[1], low[2]);
  exchange(high[0], high[1]);
  exchange(high[0], high[2]);
  exchange(middle[0], middle[1]);
  exchange(middle[1], middle[2]);
  exchange(middle[0], middle[1]);
  Heights a = low[2];
  Heights b = middle[1];
  Heights c = high[0];
  exchange(a, b);
  exchange(b, c);
  exchange(a, b);
  std::memcpy(out, &b, sizeof b);
}

template <int kSide>
inline void medianRun(const float* corner, std::ptrdiff_t stride, float* out, int chunks) noexcept {
  for (int i = 0; i < chunks; ++i) medianRow<kSide>(corner + i * kAbreast, stride, out + i * kAbreast);
}

FETTLE_EACH_CPU void medianRun3(const float* corner, std::ptrdiff_t stride, float* out, int chunks) {
  medianRun<3>(corner, stride, out, chunks);
}
FETTLE_EACH_CPU void medianRun5(const float* corner, std::ptrdiff_t stride, float* out, int chunks) {
  medianRun<5>(corner, stride, out, chunks);
}
FETTLE_EACH_CPU void medianRun7(const float* corner, std::ptrdiff_t stride, float* out, int chunks) {
  medianRun<7>(corner, stride, out, chunks);
}

FETTLE_EACH_CPU bool anyHole(const float* corner, std::ptrdiff_t stride, int columns, int rows) {
  int holes = 0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const float v = corner[r * stride + c];
      holes |= v != v ? 1 : 0;
    }
  return holes != 0;
}

class SmallMedian final : public BlockFilter {
 public:
  explicit SmallMedian(int window)
      : radius_(window / 2),
        run_(window == 3   ? medianRun3
             : window == 5 ? medianRun5
                           : medianRun7) {}

  bool run(const Block& block, const JobControl& job) override {
    const int side = 2 * radius_ + 1;
    // Columns of the output whose windows lie in the field.
    const int begin = std::clamp(radius_ - block.first_column, 0, block.out_columns);
    const int end = std::clamp(block.columns - radius_ - block.first_column, begin, block.out_columns);
    for (int r = 0; r < block.out_rows; ++r) {
      if (job.cancelled()) return false;
      float* out = block.out + r * block.out_stride;
      const int row = block.first_row + r - radius_;
      int c = 0;
      if (row >= 0 && row + side <= block.rows) {
        for (; c < begin; ++c) out[c] = one(block, c, r);
        const float* corner = block.row(row) + block.first_column - radius_;
        if (!block.holes) {
          const int chunks = (end - begin) / kAbreast;
          run_(corner + c, block.stride, out + c, chunks);
          c += chunks * kAbreast;
        } else {
          for (; c + kAbreast <= end; c += kAbreast) {
            if (anyHole(corner + c, block.stride, kAbreast + side - 1, side))
              for (int i = c; i < c + kAbreast; ++i) out[i] = one(block, i, r);
            else
              run_(corner + c, block.stride, out + c, 1);
          }
        }
      }
      for (; c < block.out_columns; ++c) out[c] = one(block, c, r);
    }
    return true;
  }

 private:
  [[nodiscard]] float one(const Block& block, int c, int r) const noexcept {
    std::array<float, kSmallMedianWindow * kSmallMedianWindow> window{};
    const int column = block.first_column + c;
    const int row = block.first_row + r;
    if (const float v = block.row(row)[column]; v != v) return v;
    std::ptrdiff_t n = 0;
    for (int y = std::max(row - radius_, 0); y <= std::min(row + radius_, block.rows - 1); ++y)
      for (int x = std::max(column - radius_, 0); x <= std::min(column + radius_, block.columns - 1); ++x) {
        const float v = block.row(y)[x];
        if (v == v) window[static_cast<std::size_t>(n++)] = v;
      }
    const auto middle = window.begin() + n / 2;
    std::nth_element(window.begin(), middle, window.begin() + n);
    return n % 2 != 0 ? *middle : midpoint(*std::max_element(window.begin(), middle), *middle);
  }

  int radius_;
  void (*run_)(const float*, std::ptrdiff_t, float*, int);
};

}  // namespace

std::unique_ptr<BlockFilter> makeSmallMedian(int window) {
  return std::make_unique<SmallMedian>(window);
}

}  // namespace fettle::engine
