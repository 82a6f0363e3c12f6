#include "engine/filter/exact_sum.h"

#include <bit>
#include <cassert>
#include <cmath>
#include <initializer_list>
#include <tuple>

#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/exact_sum-inl.h"
#include "engine/simd/each_cpu-inl.h"

}  // namespace

SumLanes cutsFor(float magnitude, std::int64_t count) noexcept {
  assert(count >= 1 && count <= (std::int64_t{1} << 20));
  SumLanes result;
  // All magnitudes are below 2^top, sums and differences of two sums below 2^(top + bits).
  int top = 0;
  std::ignore = std::frexp(magnitude, &top);
  const int bits = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(count))) + 1;  // 2 .. 22
  for (double& cut : result.cut) {
    // The lane's last bit is 2^(top + bits - 53); 1.5 * 2^52 times that rounds to it, for either sign.
    cut = std::ldexp(1.5, top + bits - 1);
    // What is left is at most half that last bit. With 22 bits a lane takes 32 binary places, so nine reach
    // from 2^128 to below 2^-149.
    top += bits - 54;
  }
  return result;
}

bool lanesHold(const SumLanes& cuts, int lanes, const float* samples, int n) noexcept {
  return FETTLE_AT_LEVEL(bestCpuLevel(), misfits)(samples, n, cuts.cut[0], cuts.cut[1], lanes) == 0;
}

SumLanes chooseLanes(const float* heights, std::ptrdiff_t stride, int columns, int rows, float magnitude,
                     std::int64_t count) noexcept {
  if (magnitude == 0.0F) return {};
  SumLanes result = cutsFor(magnitude, count);
  for (const int lanes : {1, 2}) {
    result.lanes = lanes;
    int r = 0;
    while (r < rows && lanesHold(result, lanes, heights + r * stride, columns)) ++r;
    if (r == rows) return result;
  }
  result.lanes = SumLanes::kMaxLanes;
  return result;
}

double roundedSum(const double* lanes, int count, std::ptrdiff_t stride) noexcept {
  assert(count <= SumLanes::kMaxLanes);
  // Non-overlapping partial sums, smallest first (J. R. Shewchuk, Adaptive precision floating-point
  // arithmetic, 1997, section 2.4); their sum is exact throughout.
  double partial[SumLanes::kMaxLanes + 1];
  int n = 0;
  for (int l = 0; l < count; ++l) {
    double x = lanes[l * stride];
    int kept = 0;
    for (int i = 0; i < n; ++i) {
      const double y = partial[i];
      const double sum = x + y;
      const double virtual_y = sum - x;
      const double error = (x - (sum - virtual_y)) + (y - virtual_y);
      if (error != 0.0) partial[kept++] = error;
      x = sum;
    }
    partial[kept++] = x;
    n = kept;
  }
  if (n == 0) return 0.0;
  double high = partial[--n];
  double low = 0.0;
  while (n > 0) {
    const double x = high;
    const double y = partial[--n];
    high = x + y;
    low = y - (high - x);
    if (low != 0.0) break;
  }
  // `high` is the nearest double unless the rest below `low` breaks a tie that rounding decided the other
  // way.
  if (n > 0 && ((low < 0.0 && partial[n - 1] < 0.0) || (low > 0.0 && partial[n - 1] > 0.0))) {
    const double twice = low * 2.0;
    const double nudged = high + twice;
    if (twice == nudged - high) high = nudged;
  }
  return high;
}

}  // namespace fettle::engine
