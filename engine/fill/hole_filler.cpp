#include "engine/fill/hole_filler.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <tbb/parallel_for.h>

namespace fettle::engine {

namespace {

// Lines as walls all along: points that were not located are of the kind of the nearest located one of their line.
std::optional<LineCuts> wallsOf(const Version& field) {
  if (field.lines() == nullptr) return std::nullopt;
  std::vector<EdgeLine> lines = *field.lines();
  for (EdgeLine& line : lines) {
    std::vector<std::size_t> located;
    for (std::size_t i = 0; i < line.points.size(); ++i)
      if (line.points[i].located) located.push_back(i);
    const std::vector<EdgePoint> known = line.points;
    std::size_t next = 0;
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      line.points[i].located = true;
      if (located.empty()) {
        line.points[i].kind = LineKind::kStep;
        continue;
      }
      while (next + 1 < located.size() && located[next + 1] <= i) ++next;
      const std::size_t after = std::min(next + 1, located.size() - 1);
      const auto apart = [&](std::size_t k) { return located[k] > i ? located[k] - i : i - located[k]; };
      line.points[i].kind = known[located[apart(after) < apart(next) ? after : next]].kind;
    }
  }
  return LineCuts(lines, field.grid().width, field.grid().height);
}

// Holes at a time: so many samples of results wait to be written.
constexpr std::int64_t kBatchSamples = 4'000'000;
// Holes with more are worked on one after the other: a decomposition takes up to 2 kB per sample.
constexpr std::int64_t kManySamples = 50'000;

}  // namespace

ChosenHoles chooseHoles(const Holes& holes, const FillOptions& options, const Grid& grid, Filled& counts) {
  ChosenHoles chosen;
  const double x = grid.spacingXMm(), y = grid.spacingYMm();
  for (const Hole& hole : holes.holes) {
    ++counts.holes;
    if (std::max(hole.box.columns * x, hole.box.rows * y) > options.most_extent_mm ||
        static_cast<double>(hole.samples) * x * y > options.most_area_mm2) {
      ++counts.larger;
    } else if (hole.at_border && !options.at_border) {
      ++counts.at_border;
    } else if (hole.samples > options.mostSamples()) {
      ++counts.too_many;
    } else {
      chosen.holes.push_back(&hole);
      chosen.samples += hole.samples;
    }
  }
  return chosen;
}

HoleFiller::HoleFiller(const Version& field, const FillOptions& options)
    : field_(field), options_(options), walls_(wallsOf(field)), live_(field, Growth::kAllowed) {}

bool HoleFiller::put(std::span<const HoleRun> runs, std::span<const float> heights) {
  const float* z = heights.data();
  for (const HoleRun& run : runs) {
    if (!live_.writeHeights(run.first, run.row, run.samples(), 1, z, run.samples())) return false;
    z += run.samples();
  }
  return true;
}

// Writes the surface of one hole. False without memory.
bool HoleFiller::write(std::span<const HoleRun> runs, const HoleSurface& surface, Filled& counts) {
  if (!put(runs, surface.heights)) return false;
  const auto written = std::ranges::count_if(surface.heights, [](float z) { return !std::isnan(z); });
  counts.filled += written;
  ++(written > 0 ? counts.filled_holes : counts.no_rim);
  if (written > 0 && surface.undetermined) ++counts.undetermined;
  return true;
}

Status HoleFiller::fill(const Holes& holes, std::span<const Hole* const> chosen, Filled& counts,
                        JobControl& job) {
  const FieldReader reader = field_.reader();
  const Grid& grid = field_.grid();
  const auto surfaceOf = [&](const Hole& hole) {
    HoleSurface surface = surfaceOfHole(reader, holes.runsOf(hole), walls_ ? &*walls_ : nullptr,
                                        options_.method, grid.spacingXMm(), grid.spacingYMm());
    job.advance(static_cast<std::uint64_t>(hole.samples));
    return surface;
  };
  std::vector<HoleSurface> surfaces;
  for (std::size_t begin = 0; begin < chosen.size();) {
    std::size_t end = begin;
    for (std::int64_t samples = 0; end < chosen.size() && samples < kBatchSamples; ++end)
      samples += chosen[end]->samples;
    surfaces.assign(end - begin, {});
    tbb::parallel_for(begin, end, [&](std::size_t i) {
      if (!job.cancelled() && chosen[i]->samples <= kManySamples) surfaces[i - begin] = surfaceOf(*chosen[i]);
    });
    for (std::size_t i = begin; i < end; ++i) {
      if (job.cancelled()) return cancelled();
      if (chosen[i]->samples > kManySamples) surfaces[i - begin] = surfaceOf(*chosen[i]);
      if (!write(holes.runsOf(*chosen[i]), surfaces[i - begin], counts))
        return failure("there is not enough memory for the filled field", "fill",
                       "keep the samples on a disk with --store FOLDER");
    }
    begin = end;
  }
  return job.cancelled() ? Status(cancelled()) : Status();
}

}  // namespace fettle::engine
