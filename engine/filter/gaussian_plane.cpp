// Gaussians of any length in a few products per sample. The weights are those of ISO 16610-61:2015, exp(-pi (d / (alpha
// L))^2) with alpha = sqrt(ln 2 / pi), of which a wave of length L keeps half. That a Gaussian is several shorter ones is old
// (P. Burt, Fast filter transforms for image processing, 1981, goes by nodes as well); means of weighted samples as a ratio of
// two filtered planes are H. Knutsson's and C.-F. Westin's normalised convolution (1993).

#include "engine/filter/gaussian_plane.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/field/tile.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/gaussian_plane-inl.h"
#include "engine/simd/each_cpu-inl.h"

constexpr double kShort = 6.0;       // cut-off of a [steps]
constexpr double kLeastLong = 12.5;  // of L [steps]
constexpr std::int32_t kBand = 32;   // rows of nodes that a worker takes at once
constexpr int kPad = 16;             // elements that kernels may read beyond a row

// Within 1e-300 of its middle: never a denormal.
double weightAt(double distance, double cut_off) {
  const double x = distance / cut_off;
  return std::exp(-std::min(std::numbers::pi * std::numbers::pi / std::numbers::ln2 * x * x, 690.0));
}

std::int32_t reachOfWeights(double cut_off, double most) {
  return static_cast<std::int32_t>(std::min(std::floor(GaussianAxis::kReach * cut_off), most));
}

std::int32_t floorDiv(std::int32_t a, std::int32_t b) {
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

std::int32_t ceilDiv(std::int32_t a, std::int32_t b) {
  return -floorDiv(-a, b);
}

double longPart(double cut_off, double step) {
  return std::sqrt(cut_off * cut_off - 2.0 * kShort * kShort * step * step);
}

// f(begin, end) for parts of [0, count), on all workers or on this thread alone.
void inParts(std::int32_t count, std::int32_t part, bool parallel, const auto& f) {
  if (!parallel) return f(0, count);
  tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, (count + part - 1) / part, 1),
                    [&](const tbb::blocked_range<std::int32_t>& range) {
                      for (std::int32_t i = range.begin(); i != range.end(); ++i)
                        f(i * part, std::min((i + 1) * part, count));
                    });
}

}  // namespace

std::int32_t gaussianStep(double cut_off, std::int32_t samples) noexcept {
  // A step near the field's size would have nodes far outside of it. A piece that has all within the reach is longer than
  // 0.64 cut-offs, and so as free in its step as the field.
  const double steps = std::min(cut_off / kLeastLong, samples / 8.0);
  return steps < 2.0 ? 1 : static_cast<std::int32_t>(std::bit_floor(static_cast<std::uint32_t>(steps)));
}

std::int32_t gaussianReach(double cut_off, std::int32_t samples) noexcept {
  const double step = gaussianStep(cut_off, samples);
  const double whole = step == 1.0 ? cut_off : 2.0 * kShort * step + longPart(cut_off, step) + 2.0 * step;
  return static_cast<std::int32_t>(std::min(std::ceil(GaussianAxis::kReach * whole), 1.0 * samples));
}

GaussianAxis gaussianAxis(double cut_off, std::int32_t samples) {
  GaussianAxis axis;
  axis.step = gaussianStep(cut_off, samples);
  const double step = axis.step, b = axis.step == 1 ? cut_off : longPart(cut_off, step);
  // Beyond the field's other end is no sample, and no node that one reaches.
  axis.far = reachOfWeights(b / step, samples / step + 2.0 * GaussianAxis::kReach * kShort + 1.0);
  for (std::int32_t d = -axis.far; d <= axis.far; ++d) axis.b.push_back(weightAt(d * step, b));
  if (axis.step == 1) return axis;
  const double a = kShort * step;
  axis.near = reachOfWeights(a, std::numeric_limits<std::int32_t>::max() * 0.25);
  for (std::int32_t d = -axis.near; d <= axis.near; ++d) axis.a.push_back(weightAt(d, a));
  // A multiple of 8, in which the last ones are 0.
  axis.a.resize((axis.a.size() + 7) / 8 * 8, 0.0);
  // Sample n * step + p lies within the reach of the nodes n - near / step .. n + near / step + 1.
  const std::int32_t before = axis.near / axis.step;
  axis.up_before = before;
  axis.nodes_up = 2 * before + 2;
  const std::int32_t lane = (axis.step + 7) / 8 * 8;
  axis.up.assign(static_cast<std::size_t>(axis.nodes_up * lane), 0.0);
  for (std::int32_t t = 0; t < axis.nodes_up; ++t)
    for (std::int32_t p = 0; p < axis.step; ++p)
      if (const std::int32_t d = p - (t - before) * axis.step; std::abs(d) <= axis.near)
        axis.up[static_cast<std::size_t>(t * lane + p)] = weightAt(d, a);
  return axis;
}

GaussianPlane::Nodes GaussianPlane::wanted(const GaussianAxis& axis, std::int32_t begin, std::int32_t end) {
  const std::int32_t first = floorDiv(begin, axis.step) - axis.up_before;
  const std::int32_t last = floorDiv(end - 1, axis.step) + axis.nodes_up - 1 - axis.up_before;
  return {first, last - first + 1};
}

// The nodes whose sums of samples are not 0 and within the reach of b.
GaussianPlane::Nodes GaussianPlane::read(const GaussianAxis& axis, const Nodes& wanted,
                                         std::int32_t samples) {
  const std::int32_t first = std::max(wanted.first - axis.far, ceilDiv(-axis.near, axis.step));
  const std::int32_t end =
      std::min(wanted.first + wanted.count + axis.far, floorDiv(samples - 1 + axis.near, axis.step) + 1);
  return {first, std::max(end - first, 0)};
}

// Sums over the samples near the nodes of rows [begin, end) of `rows`.
void GaussianPlane::gatherRows(const FieldReader& field, const SampleValues& samples, const Nodes& columns,
                               const Nodes& rows, std::int32_t begin, std::int32_t end, double* value,
                               double* weight, std::ptrdiff_t stride, Scratch& scratch) const {
  const auto weighRow = FETTLE_AT_LEVEL(level_, weigh);
  const auto add = FETTLE_AT_LEVEL(level_, accumulate);
  const auto thinRow = FETTLE_AT_LEVEL(level_, thin);
  // The samples, in rows that begin with those before the field.
  const std::int32_t left = columns.first * x_.step - x_.near;
  const std::int32_t c0 = std::max(left, 0);
  const std::int32_t c1 =
      std::min((columns.first + columns.count - 1) * x_.step + x_.near + 1, field.width());
  const int n = c1 - c0;
  const std::ptrdiff_t wide = std::ptrdiff_t{columns.count} * x_.step + 2 * x_.near + 4 * kPad;
  const std::int32_t r0 = std::max((rows.first + begin) * y_.step - y_.near, 0);
  const std::int32_t r1 = std::min((rows.first + end - 1) * y_.step + y_.near + 1, field.height());
  const std::int32_t high = end - begin;
  const auto size = static_cast<std::size_t>(wide * high);
  scratch.value.assign(size, 0.0);
  scratch.weight.assign(size, 0.0);
  scratch.rows.resize(static_cast<std::size_t>(2 * (n + kPad)));
  const std::ptrdiff_t room = (n + 31) / 16 * 16;
  scratch.heights.resize(static_cast<std::size_t>(room * kTileSide));
  double* const row_value = scratch.rows.data();
  double* const row_weight = row_value + n + kPad;
  for (std::int32_t from = r0; from < r1;) {
    const std::int32_t to = std::min((from / kTileSide + 1) * kTileSide, r1);
    field.readHeights(c0, from, n, to - from, scratch.heights.data(), room);
    for (std::int32_t r = from; r < to; ++r) {
      float* const heights = scratch.heights.data() + (r - from) * room;
      if (samples.heights != nullptr) {
        const float* const others = samples.heights + r * samples.stride + c0;
        for (int i = 0; i < n; ++i) heights[i] = heights[i] == heights[i] ? others[i] : heights[i];
      }
      weighRow(heights, samples.weights != nullptr ? samples.weights + r * samples.stride + c0 : nullptr,
               row_value, row_weight, n);
      const std::int32_t low = std::max(ceilDiv(r - y_.near, y_.step) - rows.first, begin);
      const std::int32_t top = std::min(floorDiv(r + y_.near, y_.step) - rows.first + 1, end);
      for (std::int32_t k = low; k < top; ++k) {
        const double w =
            y_.near == 0 ? 1.0 : y_.a[static_cast<std::size_t>(r - (rows.first + k) * y_.step + y_.near)];
        const std::ptrdiff_t at = (k - begin) * wide + (c0 - left);
        add(row_value, w, scratch.value.data() + at, n);
        add(row_weight, w, scratch.weight.data() + at, n);
      }
    }
    from = to;
  }
  for (std::int32_t k = 0; k < high; ++k) {
    // What was added beyond the row's end is no sample.
    std::fill_n(scratch.value.data() + k * wide + (c1 - left), kPad, 0.0);
    std::fill_n(scratch.weight.data() + k * wide + (c1 - left), kPad, 0.0);
    double* const to_value = value + (begin + k) * stride;
    double* const to_weight = weight + (begin + k) * stride;
    if (x_.near == 0) {
      std::copy_n(scratch.value.data() + k * wide, columns.count, to_value);
      std::copy_n(scratch.weight.data() + k * wide, columns.count, to_weight);
    } else {
      const int taps = static_cast<int>(x_.a.size());
      thinRow(scratch.value.data() + k * wide, x_.step, x_.a.data(), taps, to_value, columns.count);
      thinRow(scratch.weight.data() + k * wide, x_.step, x_.a.data(), taps, to_weight, columns.count);
    }
  }
}

bool GaussianPlane::make(const FieldReader& field, const SampleValues& samples, const SampleRect& rect,
                         bool parallel, const JobControl& job) {
  columns_ = wanted(x_, rect.column, rect.column + rect.columns);
  rows_ = wanted(y_, rect.row, rect.row + rect.rows);
  const Nodes columns = read(x_, columns_, field.width()), rows = read(y_, rows_, field.height());
  const std::ptrdiff_t stride = columns.count + kPad;
  std::vector<double> value(static_cast<std::size_t>(stride * rows.count)), weight(value.size());
  tbb::enumerable_thread_specific<Scratch> scratches;
  inParts(rows.count, kBand, parallel, [&](std::int32_t begin, std::int32_t end) {
    for (std::int32_t k = begin; k < end && !job.cancelled(); k += kBand)
      gatherRows(field, samples, columns, rows, k, std::min(k + kBand, end), value.data(), weight.data(),
                 stride, scratches.local());
  });
  if (job.cancelled()) return false;

  // Along x, then along y into the sums.
  const auto slideRow = FETTLE_AT_LEVEL(level_, slide);
  stride_ = columns_.count + 2 * kPad;
  const std::int32_t shift = columns_.first - columns.first;  // of the first wanted node
  std::vector<double> part(static_cast<std::size_t>(stride_ * rows.count));
  const auto along = [&](const std::vector<double>& from, std::vector<double>& to) {
    inParts(rows.count, kBand, parallel, [&](std::int32_t begin, std::int32_t end) {
      std::vector<double> line(static_cast<std::size_t>(columns_.count + 2 * x_.far + 8 * kPad));
      for (std::int32_t k = begin; k < end && !job.cancelled(); ++k) {
        // line[i]: the node i - far of those wanted.
        const double* const row = from.data() + k * stride;
        for (std::int32_t i = 0; i < columns_.count + 2 * x_.far; ++i) {
          const std::int32_t node = shift + i - x_.far;
          line[static_cast<std::size_t>(i)] = node >= 0 && node < columns.count ? row[node] : 0.0;
        }
        slideRow(line.data(), 1, x_.b.data(), static_cast<int>(x_.b.size()), part.data() + k * stride_,
                 columns_.count);
      }
    });
    const std::int32_t down = rows_.first - rows.first;
    to.assign(static_cast<std::size_t>(stride_ * (rows_.count + 1)), 0.0);
    inParts(rows_.count, kBand, parallel, [&](std::int32_t begin, std::int32_t end) {
      for (std::int32_t k = begin; k < end && !job.cancelled(); ++k) {
        // Only rows that there are: the others are 0 at the ends of the sum.
        const std::int32_t first = std::max(down + k - y_.far, 0);
        const std::int32_t last = std::min(down + k + y_.far, rows.count - 1);
        if (first > last) continue;
        slideRow(part.data() + first * stride_, stride_, y_.b.data() + (first - (down + k - y_.far)),
                 last - first + 1, to.data() + k * stride_, columns_.count);
      }
    });
  };
  along(value, value_);
  along(weight, weight_);
  return !job.cancelled();
}

GaussianPlane::Sums GaussianPlane::sumsFor(const SampleRect& part) const noexcept {
  const Nodes rows = wanted(y_, part.row, part.row + part.rows);
  const Nodes columns = wanted(x_, part.column, part.column + part.columns);
  const std::ptrdiff_t at = (rows.first - rows_.first) * stride_ + (columns.first - columns_.first);
  return {value_.data() + at, weight_.data() + at, stride_, rows.count};
}

void GaussianPlane::fill(const SampleRect& rect, Scratch& scratch, float* out, std::ptrdiff_t stride) const {
  const auto slideRow = FETTLE_AT_LEVEL(level_, slide);
  const auto spreadRow = FETTLE_AT_LEVEL(level_, spreadOut);
  const auto divideRow = FETTLE_AT_LEVEL(level_, divide);
  const Nodes rows = wanted(y_, rect.row, rect.row + rect.rows);
  const Nodes columns = wanted(x_, rect.column, rect.column + rect.columns);
  const std::int32_t first =
      floorDiv(rect.column, x_.step) * x_.step;  // sample of the first of `columns` that is no margin
  const std::int32_t steps =
      floorDiv(rect.column + rect.columns - 1, x_.step) - floorDiv(rect.column, x_.step) + 1;
  const std::ptrdiff_t wide = std::ptrdiff_t{steps} * x_.step + 4 * kPad;
  const auto size = static_cast<std::size_t>(wide * rows.count + 4 * kPad);
  scratch.value.resize(size);
  scratch.weight.resize(size);
  scratch.rows.resize(static_cast<std::size_t>(2 * wide));
  const auto up = [&](const std::vector<double>& sums, std::vector<double>& to) {
    for (std::int32_t k = 0; k < rows.count; ++k) {
      const double* const from =
          sums.data() + (rows.first - rows_.first + k) * stride_ + (columns.first - columns_.first);
      if (x_.step == 1)
        std::copy_n(from, rect.columns, to.data() + k * wide);
      else
        spreadRow(from, x_.step, x_.up.data(), x_.nodes_up, to.data() + k * wide, steps);
    }
  };
  up(value_, scratch.value);
  up(weight_, scratch.weight);
  std::vector<double> taps(static_cast<std::size_t>(y_.nodes_up), 1.0);
  const std::int32_t lane = (y_.step + 7) / 8 * 8;
  for (std::int32_t r = 0; r < rect.rows; ++r) {
    const std::int32_t node = floorDiv(rect.row + r, y_.step), phase = rect.row + r - node * y_.step;
    if (y_.step > 1)
      for (std::int32_t t = 0; t < y_.nodes_up; ++t)
        taps[static_cast<std::size_t>(t)] = y_.up[static_cast<std::size_t>(t * lane + phase)];
    const std::int32_t low = node - y_.up_before - rows.first;
    const std::ptrdiff_t at = low * wide + (rect.column - first);
    double* const value = scratch.rows.data();
    double* const weight = value + wide;
    slideRow(scratch.value.data() + at, wide, taps.data(), static_cast<int>(taps.size()), value,
             rect.columns);
    slideRow(scratch.weight.data() + at, wide, taps.data(), static_cast<int>(taps.size()), weight,
             rect.columns);
    divideRow(value, weight, out + r * stride, rect.columns);
  }
}

}  // namespace fettle::engine
