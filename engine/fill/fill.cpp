#include "engine/fill/fill.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <new>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "engine/field/line_cuts.h"
#include "engine/field/live_field.h"
#include "engine/fill/holes.h"

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

struct Chosen {
  std::vector<const Hole*> holes;
  std::int64_t samples = 0;
};

Chosen choose(const Holes& holes, const FillOptions& options, const Grid& grid, Filled& counts) {
  Chosen chosen;
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

// Writes the surface of one hole. False without memory.
bool write(LiveField& live, std::span<const HoleRun> runs, const HoleSurface& surface, Filled& counts) {
  const float* z = surface.heights.data();
  std::int64_t written = 0;
  for (const HoleRun& run : runs) {
    written += std::count_if(z, z + run.samples(), [](float v) { return !std::isnan(v); });
    if (!live.writeHeights(run.first, run.row, run.samples(), 1, z, run.samples())) return false;
    z += run.samples();
  }
  counts.filled += written;
  ++(written > 0 ? counts.filled_holes : counts.no_rim);
  if (written > 0 && surface.undetermined) ++counts.undetermined;
  return true;
}

}  // namespace

Result<Filled> fillHoles(const Version& field, const FillOptions& options, JobControl& job) try {
  if (field.reader().bounds().empty())
    return inputError("every sample is a hole, so there is nothing to fill from", "the field",
                      "give a scan with heights");
  const auto holes = findHoles(field, job);
  if (!holes) return tl::unexpected(holes.error());
  Filled filled;
  const Grid& grid = field.grid();
  const Chosen chosen = choose(*holes, options, grid, filled);
  const std::optional<LineCuts> walls = chosen.holes.empty() ? std::nullopt : wallsOf(field);
  const FieldReader reader = field.reader();
  job.begin("filling holes", static_cast<std::uint64_t>(chosen.samples));
  LiveField live(field, Growth::kAllowed);
  const auto surfaceOf = [&](const Hole& hole) {
    HoleSurface surface = surfaceOfHole(reader, holes->runsOf(hole), walls ? &*walls : nullptr,
                                        options.method, grid.spacingXMm(), grid.spacingYMm());
    job.advance(static_cast<std::uint64_t>(hole.samples));
    return surface;
  };
  std::vector<HoleSurface> surfaces;
  for (std::size_t begin = 0; begin < chosen.holes.size();) {
    std::size_t end = begin;
    for (std::int64_t samples = 0; end < chosen.holes.size() && samples < kBatchSamples; ++end)
      samples += chosen.holes[end]->samples;
    surfaces.assign(end - begin, {});
    tbb::parallel_for(begin, end, [&](std::size_t i) {
      if (!job.cancelled() && chosen.holes[i]->samples <= kManySamples)
        surfaces[i - begin] = surfaceOf(*chosen.holes[i]);
    });
    for (std::size_t i = begin; i < end; ++i) {
      if (job.cancelled()) return cancelled();
      if (chosen.holes[i]->samples > kManySamples) surfaces[i - begin] = surfaceOf(*chosen.holes[i]);
      if (!write(live, holes->runsOf(*chosen.holes[i]), surfaces[i - begin], filled))
        return failure("there is not enough memory for the filled field", "fill",
                       "keep the samples on a disk with --store FOLDER");
    }
    begin = end;
  }
  if (job.cancelled()) return cancelled();
  filled.field = live.snapshot();
  return filled;
} catch (const std::bad_alloc&) {
  return failure("there is not enough memory for the equations of a hole", "fill",
                 "fill smaller holes alone");
}

BeyondBefore beyondBefore(const Version& before, const Version& filled) noexcept {
  const HeightBounds old = before.reader().bounds(), now = filled.reader().bounds();
  if (old.empty() || now.empty()) return {};
  const double worth_saying = 0.05 * (double{old.max} - double{old.min});
  const auto far = [&](double beyond) { return beyond > worth_saying ? beyond : 0.0; };
  return {far(double{old.min} - double{now.min}), far(double{now.max} - double{old.max})};
}

}  // namespace fettle::engine
