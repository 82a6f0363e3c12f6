#include "engine/filter/ball_near.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "engine/filter/erosion_rows.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/ball_near-inl.h"
#include "engine/simd/each_cpu-inl.h"

constexpr std::int64_t kMostNear = 37 * 37;  // samples of the rectangle around the ball
constexpr std::int32_t kStripNear =
    128;  // results of a row at once, a multiple of what a kernel rounds up to

// Where samples of equal depth lie in rows below each other, of which each is the lesser of two equally far from the results'.
struct NearSteps {
  std::vector<std::int32_t> pairs, ends;
  std::vector<double> depths;

  NearSteps(const BallElement& element, std::ptrdiff_t stride) {
    struct Step {
      double depth;
      std::int32_t left, right;
    };
    std::vector<Step> steps;
    for (std::int32_t r = 0; r <= element.rows(); ++r)
      for (std::int32_t c = 0; c <= element.columns(); ++c) {
        const auto middle = static_cast<std::int32_t>(r * stride) + element.columns();
        if (const double depth = element.depthAt(c, r); depth < std::numeric_limits<double>::infinity())
          steps.push_back({depth, middle - c, middle + c});
      }
    std::ranges::stable_sort(steps, {}, &Step::depth);
    for (const Step& step : steps) {
      if (depths.empty() || step.depth != depths.back()) {
        depths.push_back(step.depth);
        ends.push_back(0);
      }
      pairs.insert(pairs.end(), {step.left, step.right});
      ends.back() = static_cast<std::int32_t>(pairs.size());
    }
  }
};

// Of a row of the field the samples from column c0 on, n of them; where there are none, infinite.
template <class T>
void takePart(const Patch<T>& from, std::int32_t row, std::int32_t c0, std::int32_t n, T* out) {
  constexpr T none = std::numeric_limits<T>::infinity();
  const SampleRect& rect = from.rect;
  const std::int32_t begin = std::clamp(rect.column - c0, 0, n),
                     end = std::clamp(rect.column + rect.columns - c0, begin, n);
  if (row < rect.row || row >= rect.row + rect.rows) {
    std::fill_n(out, n, none);
    return;
  }
  std::fill_n(out, begin, none);
  std::copy_n(from.row(row) + (c0 + begin - rect.column), end - begin, out + begin);
  std::fill_n(out + end, n - end, none);
}

template <class T>
bool erodeOverAll(const BallElement& element, const Patch<T>& from, Patch<double>& to, bool parallel,
                  CpuLevel level, const JobControl& job) {
  const auto least = FETTLE_AT_LEVEL(level, leastOfNear<T>);
  const auto lesser = FETTLE_AT_LEVEL(level, lesserRow<T>);
  const std::int32_t reach = element.columns(), up = element.rows(), ring = 2 * up + 1;
  // With what kernels read beyond; an odd number of cache lines, so that rows share no places in the cache.
  const std::ptrdiff_t stride = ((kStripNear + 2 * reach + 32) / 16 | 1) * 16;
  const NearSteps steps(element, stride);
  const std::int32_t strips = (to.rect.columns + kStripNear - 1) / kStripNear;
  constexpr std::int32_t kRowsTogether = 64;
  const std::int32_t parts = (to.rect.rows + kRowsTogether - 1) / kRowsTogether;
  inParts(strips * parts, 1, parallel, [&](std::int32_t begin, std::int32_t end) {
    std::vector<T> lines(static_cast<std::size_t>(ring * stride)),
        pairs(static_cast<std::size_t>((up + 1) * stride));
    std::vector<double> low(kStripNear + 32);
    for (std::int32_t k = begin; k < end && !job.cancelled(); ++k) {
      const std::int32_t c = k % strips * kStripNear, n = std::min(kStripNear, to.rect.columns - c);
      const std::int32_t r0 = to.rect.row + k / strips * kRowsTogether,
                         r1 = std::min(r0 + kRowsTogether, to.rect.row + to.rect.rows);
      // A row's samples in a ring of as many as the ball reaches.
      const auto lineOf = [&](std::int32_t row) { return lines.data() + (row - r0 + up) % ring * stride; };
      const auto length = static_cast<std::int32_t>(stride);
      for (std::int32_t r = r0 - up; r < r0 + up; ++r)
        takePart(from, r, to.rect.column + c - reach, length, lineOf(r));
      for (std::int32_t r = r0; r < r1; ++r) {
        takePart(from, r + up, to.rect.column + c - reach, length, lineOf(r + up));
        for (std::int32_t d = 0; d <= up; ++d)
          lesser(lineOf(r - d), lineOf(r + d), pairs.data() + d * stride, length);
        least(pairs.data(), steps.pairs.data(), steps.ends.data(), steps.depths.data(),
              static_cast<int>(steps.depths.size()), low.data(), n);
        const T* const z = lineOf(r) + reach;
        double* const out = to.row(r) + c;
        for (std::int32_t i = 0; i < n; ++i)
          out[i] = z[i] < std::numeric_limits<T>::infinity() ? low[static_cast<std::size_t>(i)]
                                                             : -std::numeric_limits<double>::infinity();
      }
    }
  });
  return !job.cancelled();
}

}  // namespace

bool isNear(const BallElement& element) noexcept {
  return (2 * std::int64_t{element.columns()} + 1) * (2 * std::int64_t{element.rows()} + 1) <= kMostNear;
}

bool erodeNear(const BallElement& element, const Patch<float>& from, Patch<double>& to, bool parallel,
               CpuLevel level, const JobControl& job) {
  return erodeOverAll(element, from, to, parallel, level, job);
}

bool erodeNear(const BallElement& element, const Patch<double>& from, Patch<double>& to, bool parallel,
               CpuLevel level, const JobControl& job) {
  return erodeOverAll(element, from, to, parallel, level, job);
}

}  // namespace fettle::engine
