#include "engine/filter/gaussian_strip.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "engine/field/tile.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/gaussian_strip-inl.h"
#include "engine/simd/each_cpu-inl.h"

constexpr std::int32_t kStrip = 64;    // columns; also in the kernels
constexpr std::int32_t kTogether = 4;  // rows of downStrip

}  // namespace

// The sums along the rows that a strip's results need, from strip.row - far on: value_rows, weight_rows, and whether a row's
// weights differ from those of a row of samples. Rows outside the field add 0 at the ends of a sum, which leaves it as it is.
void GaussianStrips::sumRows(const FieldReader& field, const SampleRect& strip, std::int32_t count,
                             Scratch& scratch) const {
  const auto widenRow = FETTLE_AT_LEVEL(level_, widen);
  const auto weighRow = FETTLE_AT_LEVEL(level_, weigh);
  const auto along = FETTLE_AT_LEVEL(level_, alongStrip);
  const std::int32_t left = strip.column - x_.far, n = (kStrip + 2 * x_.far + 7) / 8 * 8;
  const std::int32_t c0 = std::max(left, 0), inside = std::min(left + n, field.width()) - c0;
  const int taps = static_cast<int>(x_.b.size());
  const std::int32_t first = strip.row - y_.far;
  const std::int32_t r0 = std::max(first, 0), r1 = std::min(strip.row + strip.rows + y_.far, field.height());
  // Behind the rows one without samples and one of nothing but samples.
  scratch.values.resize(static_cast<std::size_t>(count + 1) * kStrip);
  scratch.weights.resize(static_cast<std::size_t>(count + 1) * kStrip);
  double* const none = scratch.values.data() + std::ptrdiff_t{count} * kStrip;
  double* const all = scratch.weights.data() + std::ptrdiff_t{count} * kStrip;
  std::fill_n(none, kStrip, 0.0);
  scratch.value_rows.assign(static_cast<std::size_t>(count), none);
  scratch.weight_rows.assign(static_cast<std::size_t>(count), none);
  scratch.differs.assign(static_cast<std::size_t>(count), 1);
  // Vectors may write 8 elements beyond the line.
  scratch.line.assign(static_cast<std::size_t>(2 * (n + 8)), 0.0);
  double* const value = scratch.line.data();
  double* const weight = value + n + 8;
  std::fill_n(weight + (c0 - left), inside, 1.0);
  along(weight, x_.b.data(), taps, all);
  scratch.heights.resize(static_cast<std::size_t>(n) * kTileSide + 16);
  for (std::int32_t from = r0; from < r1;) {
    const std::int32_t to = std::min((from / kTileSide + 1) * kTileSide, r1);
    field.readHeights(left, from, n, to - from, scratch.heights.data(), n);
    for (std::int32_t r = from; r < to; ++r) {
      const float* const heights = scratch.heights.data() + (r - from) * n;
      const auto at = static_cast<std::size_t>(r - first);
      double* const value_row = scratch.values.data() + (r - first) * kStrip;
      scratch.value_rows[at] = value_row;
      if (widenRow(heights, value, n) == inside) {
        along(value, x_.b.data(), taps, value_row);
        scratch.weight_rows[at] = all;
        scratch.differs[at] = 0;
        continue;
      }
      weighRow(heights + (c0 - left), nullptr, value + (c0 - left), weight + (c0 - left), inside);
      // What was taken from beyond the field is no sample.
      std::fill(value + (c0 - left) + inside, value + n + 8, 0.0);
      std::fill(weight + (c0 - left) + inside, weight + n + 8, 0.0);
      double* const weight_row = scratch.weights.data() + (r - first) * kStrip;
      along(value, x_.b.data(), taps, value_row);
      along(weight, x_.b.data(), taps, weight_row);
      scratch.weight_rows[at] = weight_row;
    }
    from = to;
  }
}

bool GaussianStrips::fill(const FieldReader& field, const SampleRect& rect, Scratch& scratch, float* out,
                          std::ptrdiff_t stride, const JobControl& job) const {
  const auto down = FETTLE_AT_LEVEL(level_, downStrip);
  const auto divide = FETTLE_AT_LEVEL(level_, divideStrip);
  // downStrip takes no fewer.
  std::vector<double> down_weights = y_.b;
  down_weights.resize(std::max(y_.b.size(), std::size_t{kTogether}), 0.0);
  const int taps = static_cast<int>(down_weights.size());
  const std::int32_t count = rect.rows + 2 * kTogether + taps;
  std::array<double, static_cast<std::size_t>(kStrip * kTogether)> sums, weight_sums, whole;
  for (std::int32_t c = 0; c < rect.columns; c += kStrip) {
    if (job.cancelled()) return false;
    const std::int32_t wide = std::min(kStrip, rect.columns - c);
    sumRows(field, {rect.column + c, rect.row, wide, rect.rows}, count, scratch);
    const std::vector<const double*> all(static_cast<std::size_t>(taps + kTogether),
                                         scratch.weights.data() + std::ptrdiff_t{count} * kStrip);
    down(all.data(), down_weights.data(), taps, whole.data());
    // Rows until the last one whose weights differ is passed.
    std::int32_t left_to_pass = 0;
    for (std::int32_t r = 0; r < 2 * y_.far; ++r)
      left_to_pass = scratch.differs[static_cast<std::size_t>(r)] != 0 ? 2 * y_.far + 1 : left_to_pass - 1;
    for (std::int32_t r = 0; r < rect.rows; r += kTogether) {
      const std::int32_t high = std::min(kTogether, rect.rows - r);
      down(scratch.value_rows.data() + r, down_weights.data(), taps, sums.data());
      bool differs = false;
      for (std::int32_t j = 0; j < kTogether; ++j) {
        const auto next = static_cast<std::size_t>(r + j + 2 * y_.far);
        left_to_pass = scratch.differs[next] != 0 ? 2 * y_.far + 1 : left_to_pass - 1;
        differs = differs || left_to_pass > 0;
      }
      if (differs) down(scratch.weight_rows.data() + r, down_weights.data(), taps, weight_sums.data());
      for (std::int32_t j = 0; j < high; ++j)
        divide(sums.data() + j * kStrip, (differs ? weight_sums : whole).data() + j * kStrip,
               out + (r + j) * stride + c, wide);
    }
  }
  return true;
}

}  // namespace fettle::engine
