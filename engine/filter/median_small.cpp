// Medians of windows with few samples, by comparing and exchanging only, 16 outputs abreast. Windows that
// leave the field or hold a hole have any number of samples and go one by one.

#include <algorithm>
#include <array>
#include <cstring>

#include "engine/filter/median.h"

namespace fettle::engine {

namespace {

constexpr int kAbreast = 16;

using Run = void (*)(const float* corner, std::ptrdiff_t stride, float* out, int chunks);

// Explicit vectors are cut to the machine's before functions are cloned for machines, so that FETTLE_EACH_CPU
// would come too late for them.
namespace plain {
#include "engine/filter/median_small-inl.h"
}
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
#define FETTLE_SMALL_MEDIAN_TARGETS
#pragma GCC push_options
#pragma GCC target("arch=haswell")
namespace avx2 {
#include "engine/filter/median_small-inl.h"
}
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("arch=skylake-avx512")
namespace avx512 {
#include "engine/filter/median_small-inl.h"
}
#pragma GCC pop_options
#endif

template <int kSide>
Run chooseRun() noexcept {
#ifdef FETTLE_SMALL_MEDIAN_TARGETS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    return avx512::medianRun<kSide>;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2")) return avx2::medianRun<kSide>;
#endif
  return plain::medianRun<kSide>;
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
        run_(window == 3   ? chooseRun<3>()
             : window == 5 ? chooseRun<5>()
                           : chooseRun<7>()) {}

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
  Run run_;
};

}  // namespace

std::unique_ptr<BlockFilter> makeSmallMedian(int window) {
  return std::make_unique<SmallMedian>(window);
}

}  // namespace fettle::engine
