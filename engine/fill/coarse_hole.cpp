#include "engine/fill/coarse_hole.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <span>
#include <utility>

#include "engine/field/between_means.h"
#include "engine/field/live_field.h"
#include "engine/field/means.h"

namespace fettle::engine {

namespace {

constexpr double kCellsInHole = 2'500.0, kCellsAround = 65'536.0;
constexpr std::int32_t kRimCells = 4;  // around the hole, on each side

SampleRect rectAround(const SampleRect& box, std::int32_t by, const Grid& grid) noexcept {
  const std::int32_t c0 = std::max(box.column - by, 0), r0 = std::max(box.row - by, 0);
  return {c0, r0, std::min(box.column + box.columns + by, grid.width) - c0,
          std::min(box.row + box.rows + by, grid.height) - r0};
}

// Means around the hole; those that hold samples of it are holes, since the mean of the rest lies elsewhere.
Version meansAround(const Version& field, const SampleRect& rect, std::span<const HoleRun> runs,
                    std::int32_t step) {
  LiveField means(meansOf(field, rect, step), Growth::kAllowed);
  bool room = true;
  for (const HoleRun& run : runs)
    for (std::int32_t c = (run.first - rect.column) / step; c <= (run.last - rect.column) / step; ++c)
      room = room && means.setHeight(c, (run.row - rect.row) / step, std::numeric_limits<float>::quiet_NaN());
  if (!room) throw std::bad_alloc();
  return means.snapshot();
}

// Between filled means of step x step samples, at each sample of the runs.
Result<std::vector<float>> heightsBetweenMeans(const Version& field, const FillOptions& options,
                                               const Hole& hole, std::span<const HoleRun> runs,
                                               std::int32_t step, JobControl& job) {
  const SampleRect rect = rectAround(hole.box, kRimCells * step, field.grid());
  // It was chosen already, and a mean counts as many samples as it is of.
  FillOptions of_means = options;
  of_means.most_extent_mm = of_means.most_area_mm2 = std::numeric_limits<double>::infinity();
  of_means.at_border = hole.at_border;
  const auto filled = fillHoles(meansAround(field, rect, runs, step), of_means, job);
  if (!filled) return tl::unexpected(filled.error());
  const FieldReader cells = filled->field.reader();
  std::vector<float> heights;
  heights.reserve(static_cast<std::size_t>(hole.samples));
  for (const HoleRun& run : runs) {
    const BetweenMeans y = betweenMeans(run.row - rect.row, step, cells.height());
    for (std::int32_t c = run.first; c <= run.last; ++c) {
      const BetweenMeans x = betweenMeans(c - rect.column, step, cells.width());
      const auto across = [&](std::int32_t row) {
        return heightBetween(cells.heightAt(x.cell, row), cells.heightAt(x.next, row), x.share);
      };
      heights.push_back(heightBetween(across(y.cell), across(y.next), y.share));
    }
  }
  return heights;
}

}  // namespace

Result<CoarseHole> coarseHole(const Version& field, const FillOptions& options, const Holes& holes,
                              const Hole& hole, JobControl& job) {
  const double around = static_cast<double>(hole.box.columns) * hole.box.rows;
  const auto step = static_cast<std::int32_t>(std::ceil(
      std::sqrt(std::max(static_cast<double>(hole.samples) / kCellsInHole, around / kCellsAround))));
  const std::span<const HoleRun> runs = holes.runsOf(hole);
  auto heights = heightsBetweenMeans(field, options, hole, runs, step, job);
  if (!heights) return tl::unexpected(heights.error());
  const auto coarser = heightsBetweenMeans(field, options, hole, runs, 2 * step, job);
  if (!coarser) return tl::unexpected(coarser.error());
  CoarseHole made;
  made.heights = *std::move(heights);
  for (std::size_t i = 0; i < made.heights.size(); ++i) {
    const double off = static_cast<double>(made.heights[i]) - static_cast<double>((*coarser)[i]);
    if (!std::isfinite(off)) continue;
    made.squares += off * off;
    ++made.compared;
  }
  return made;
}

}  // namespace fettle::engine
