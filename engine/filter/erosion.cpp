// Erosion by flat elements: J. Serra, Image analysis and mathematical morphology, 1982; for surfaces, M. Shunmugam and V.
// Radhakrishnan, Two- and three-dimensional analyses of surfaces according to the E-system, 1974, and S. Lou, X. Jiang, P.
// Scott, Algorithms for morphological profile filters and their comparison, 2012, which also has faster ways than going over the
// element.

#include "engine/filter/erosion.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "engine/filter/disk_erosion.h"
#include "engine/filter/erosion_rows.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/erosion-inl.h"
#include "engine/simd/each_cpu-inl.h"

// A radius of three spacings reaches three samples, though 3 * 0.1 / 0.1 is less.
constexpr double kRoundUp = 1.0 + 1e-9;
constexpr std::int32_t kRowsAtOnce = 32;
constexpr std::int32_t kStrip = 64;  // columns of leastDown

std::int32_t reachIn(double length, double spacing, std::int32_t samples) {
  return static_cast<std::int32_t>(std::min(std::floor(length / spacing * kRoundUp), samples - 1.0));
}

bool erodeRectangle(const FlatElement& element, const Patch<float>& from, Patch<float>& to, bool parallel,
                    CpuLevel level, ErosionScratch& scratch, const JobControl& job) {
  const auto lower = FETTLE_AT_LEVEL(level, lowerByShift);
  const auto lesserRow = FETTLE_AT_LEVEL(level, lesserOf);
  const auto down = FETTLE_AT_LEVEL(level, leastDown);
  const std::int32_t n = to.rect.columns, window = 2 * element.columns + 1;
  const std::int32_t first = std::max(to.rect.row - element.rows, from.rect.row);
  const std::int32_t end =
      std::min(to.rect.row + to.rect.rows + element.rows, from.rect.row + from.rect.rows);
  const std::ptrdiff_t stride = (n + kStrip - 1) / kStrip * kStrip + 16;
  scratch.part.resize(static_cast<std::size_t>(stride * (end - first)));
  inParts(end - first, kRowsAtOnce, parallel, [&](std::int32_t begin, std::int32_t stop) {
    std::vector<float> own;
    std::vector<float>& line = parallel ? own : scratch.line;
    line.resize(static_cast<std::size_t>(n + window + 128));
    for (std::int32_t r = begin; r < stop && !job.cancelled(); ++r) {
      takeRow(from, first + r, to.rect.column, n, element.columns, line.data());
      int length = 1;
      // Least of `length` samples from each one on.
      for (; 2 * length <= window; length *= 2) lower(line.data(), length, n + window - 2 * length);
      lesserRow(line.data(), line.data() + window - length, scratch.part.data() + r * stride, n);
    }
  });
  const std::int32_t strips = (n + kStrip - 1) / kStrip, high = 2 * element.rows + 1;
  inParts(strips, 1, parallel, [&](std::int32_t begin, std::int32_t stop) {
    std::vector<float> ends(static_cast<std::size_t>(std::min(high, to.rect.rows) * kStrip));
    std::vector<float> out(static_cast<std::size_t>(to.rect.rows) * kStrip);
    for (std::int32_t s = begin; s < stop && !job.cancelled(); ++s) {
      const std::int32_t c = s * kStrip, wide = std::min(kStrip, n - c);
      down(scratch.part.data() + c, stride, end - first, to.rect.row - element.rows - first, high,
           ends.data(), out.data(), kStrip, to.rect.rows);
      for (std::int32_t r = 0; r < to.rect.rows; ++r)
        std::copy_n(out.data() + r * kStrip, wide, to.row(to.rect.row + r) + c);
    }
  });
  return !job.cancelled();
}

}  // namespace

FlatElement::FlatElement(Element element, double radius_mm, const Grid& grid)
    : columns(reachIn(radius_mm, grid.spacingXMm(), grid.width)),
      rows(reachIn(radius_mm, grid.spacingYMm(), grid.height)) {
  if (element == Element::kSquare) return;
  for (std::int32_t d = 0; d <= rows; ++d) {
    const double y = d * grid.spacingYMm();
    const double rest = std::sqrt(std::max(0.0, radius_mm * radius_mm * kRoundUp - y * y));
    half.push_back(reachIn(rest, grid.spacingXMm(), grid.width));
  }
}

bool erode(const FlatElement& element, const Patch<float>& from, Patch<float>& to, bool parallel,
           CpuLevel level, ErosionScratch& scratch, const JobControl& job) {
  return element.half.empty() ? erodeRectangle(element, from, to, parallel, level, scratch, job)
                              : erodeDisk(element, from, to, parallel, level, job);
}

}  // namespace fettle::engine
