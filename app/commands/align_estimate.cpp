#include "app/commands/align_estimate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "engine/base/stopwatch.h"
#include "engine/field/piece.h"
#include "engine/measure/align.h"
#include "engine/measure/height_map.h"
#include "engine/nominal/nominal_align.h"
#include "engine/nominal/nominal_surface.h"

namespace fettle::app {

namespace {

// What alignFields() takes for each height to which it reduces a scan, and for the coarse search [bytes]; measured on scans of 400 to
// 8192 samples a side.
constexpr double kAligningMemory = 92.0, kSearchMemory = 20e6;

// Fewer are aligned in about ten seconds, of which the sample would be too large a part.
constexpr double kFewestForeseen = 1 << 25;

// About every n-th sample, so that the whole shape is searched.
engine::Version thinned(const engine::Version& field, std::int32_t step) {
  const engine::Grid& grid = field.grid();
  return engine::spreadOver(field, (grid.width + step - 1) / step, (grid.height + step - 1) / step);
}

// So that four heights of the finest resolution become one in each direction: one resolution less. 1 where there is but one.
std::int32_t stepFor(const engine::Grid& grid, const engine::FinestAlignment& finest) {
  if (finest.resolutions < 2) return 1;
  const double spacing = std::sqrt(grid.spacingXMm() * grid.spacingYMm());
  return std::max(1, static_cast<std::int32_t>(std::lround(4.0 * finest.spacing_mm / spacing)));
}

// A square from the middle of a field.
engine::Version middleOf(const engine::Version& field, std::int32_t most) {
  const engine::Grid& grid = field.grid();
  const std::int32_t columns = std::min(grid.width, most), rows = std::min(grid.height, most);
  return engine::pieceOf(field, (grid.width - columns) / 2, (grid.height - rows) / 2, columns, rows);
}

// What each sample of a field takes whenever the field is reduced to blocks [s].
engine::Result<double> reducingEach(const engine::Version& field, engine::JobControl& job) {
  constexpr std::int32_t kSide = 512, kBlock = 8;
  const engine::Version piece = middleOf(field, kSide);
  const engine::Stopwatch watch;
  const auto map = engine::heightMapOf(piece, engine::Region::kAll, std::min(kBlock, piece.grid().width),
                                       std::min(kBlock, piece.grid().height), 0.0, job);
  if (!map) return tl::unexpected(map.error());
  return watch.seconds() / static_cast<double>(piece.grid().samples());
}

// What an alignment in every n-th sample took.
struct ThinAlignment {
  std::vector<engine::AlignStage> stages;
  double seconds = 0.0;

  // Searches: each begins with the coarsest resolution.
  [[nodiscard]] double searches() const {
    return static_cast<double>(std::ranges::count(stages, 0, &engine::AlignStage::resolution));
  }
};

// `align`: in thinned fields. So few samples may show too little of the shape: it was searched all the same.
engine::Result<ThinAlignment> thinAlignment(
    AlignArguments arguments, engine::JobControl& job,
    const std::function<engine::Status(const engine::AlignOptions&)>& align) {
  arguments.region = "all";
  engine::AlignOptions options = alignOptionsOf(arguments);
  ThinAlignment thin;
  options.stages = &thin.stages;
  const engine::Stopwatch watch;
  const engine::Status found = align(options);
  thin.seconds = watch.seconds();
  if (job.cancelled()) return engine::cancelled();
  if (!found && found.error().kind != engine::ErrorKind::kInput) return tl::unexpected(found.error());
  return thin;
}

// With the finest resolution, which each thin search lacks: as its own finest one, in proportion to the heights.
double withFinest(const ThinAlignment& thin, const engine::FinestAlignment& finest) {
  double seconds = thin.seconds;
  for (std::size_t k = 0; k < thin.stages.size(); ++k) {
    const engine::AlignStage& stage = thin.stages[k];
    const bool last = k + 1 == thin.stages.size() || thin.stages[k + 1].resolution == 0;
    if (!last || stage.resolution + 1 >= finest.resolutions) continue;
    const auto ratio = [](std::size_t whole, std::size_t part) {
      return static_cast<double>(whole) / static_cast<double>(std::max<std::size_t>(1, part));
    };
    seconds += stage.map_seconds * ratio(finest.places, stage.places) +
               stage.refine_seconds * ratio(std::min(finest.starts, stage.starts), stage.starts) *
                   ratio(finest.points, stage.points);
  }
  return seconds;
}

// Two fields.
engine::Result<double> secondsOf(const engine::Version& a, const engine::Version& b,
                                 const AlignArguments& arguments, engine::JobControl& job) {
  const engine::FinestAlignment finest = engine::finestAlignment(a.grid(), b.grid());
  const engine::Version thin_a = thinned(a, stepFor(a.grid(), finest)),
                        thin_b = thinned(b, stepFor(b.grid(), finest));
  const auto thin = thinAlignment(arguments, job, [&](const engine::AlignOptions& options) -> engine::Status {
    if (auto found = engine::alignFields(thin_a, thin_b, options, job); !found)
      return tl::unexpected(found.error());
    return {};
  });
  if (!thin) return tl::unexpected(thin.error());
  double seconds = withFinest(*thin, finest);
  // Every resolution reduces both fields, and so does the look at how high they lie.
  for (const engine::Version* field : {&a, &b}) {
    const auto each = reducingEach(*field, job);
    if (!each) return tl::unexpected(each.error());
    seconds += *each * static_cast<double>(field->grid().samples()) * (finest.resolutions + 1);
  }
  return seconds;
}

// A field and a mesh, which is worked out as a field as large for each search.
engine::Result<double> secondsOf(const engine::Version& a, const engine::NominalMesh& b,
                                 const AlignArguments& arguments, engine::JobControl& job) {
  const engine::FinestAlignment finest = engine::finestAlignment(a.grid(), a.grid());
  const engine::Version thin_a = thinned(a, stepFor(a.grid(), finest));
  const auto thin = thinAlignment(arguments, job, [&](const engine::AlignOptions& options) -> engine::Status {
    if (auto found = engine::alignNominal(thin_a, b, options, job); !found)
      return tl::unexpected(found.error());
    return {};
  });
  if (!thin) return tl::unexpected(thin.error());
  const auto each = reducingEach(a, job);
  if (!each) return tl::unexpected(each.error());
  constexpr std::int32_t kSide = 256;
  const engine::Grid seen = middleOf(a, kSide).grid();
  const engine::NominalSurface surface(b, engine::RigidMotion{}, engine::slackOn(seen, b));
  const engine::Stopwatch watch;
  if (auto heights = engine::nominalHeights(surface, seen, job); !heights)
    return tl::unexpected(heights.error());
  const double heights_each = watch.seconds() / static_cast<double>(seen.samples());
  return withFinest(*thin, finest) + static_cast<double>(a.grid().samples()) * thin->searches() *
                                         (heights_each + 2.0 * *each * (finest.resolutions + 1));
}

PlannedOnPieces plannedFinding(const engine::Version& a, const engine::Grid& b,
                               std::function<engine::Result<double>(engine::JobControl&)> seconds) {
  PlannedOnPieces pieces;
  pieces.work = [&a](const engine::SampleRect& r, engine::JobControl&) -> engine::Result<engine::Version> {
    return engine::pieceOf(a, r.column, r.row, r.columns, r.rows);
  };
  pieces.most_samples = static_cast<double>(engine::finestAlignment(a.grid(), b).places);
  pieces.memory_each = kAligningMemory + kSearchMemory / pieces.most_samples;
  pieces.whole = {.seconds = std::move(seconds), .fewest_samples = kFewestForeseen};
  return pieces;
}

}  // namespace

PlannedOnPieces plannedAlignment(const engine::Version& a, const engine::Version& b,
                                 const AlignArguments& arguments) {
  return plannedFinding(
      a, b.grid(), [&a, &b, arguments](engine::JobControl& job) { return secondsOf(a, b, arguments, job); });
}

PlannedOnPieces plannedAlignment(const engine::Version& a, const engine::NominalMesh& b,
                                 const AlignArguments& arguments) {
  return plannedFinding(
      a, a.grid(), [&a, &b, arguments](engine::JobControl& job) { return secondsOf(a, b, arguments, job); });
}

}  // namespace fettle::app
