#include "app/commands/compare_nominal.h"

#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/align_estimate.h"
#include "app/commands/estimate_option.h"
#include "app/commands/region_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/outputs.h"
#include "app/work/streams.h"
#include "engine/field/piece.h"
#include "engine/formats/formats.h"
#include "engine/nominal/nominal_deviation.h"

namespace fettle::app {

namespace {

struct NominalInPlace {
  engine::RigidMotion motion;
  std::optional<Report> alignment;
};

engine::Result<NominalInPlace> nominalInPlace(const engine::Imported& part,
                                              const engine::NominalMesh& nominal, const std::string& path_a,
                                              const std::string& path_b, const AlignArguments* align,
                                              engine::JobControl& job) {
  if (align != nullptr) {
    const auto found = alignmentOf(part, nominal, path_a, path_b, *align, job);
    if (!found) return tl::unexpected(found.error());
    return NominalInPlace{found->motion, alignReport(*align, *found)};
  }
  const auto placed = engine::placedAsStored(nominal, part.field.grid());
  if (!placed)
    return engine::inputError("the nominal lies nowhere over or under the part", shownInput(path_b),
                              "give --align all, or state its unit with --nominal-unit");
  if (placed->place == engine::NominalPlace::kFromCorner)
    warn(fmt::format(
        "{}: in the coordinates of {} it lies beside it; taken as millimetres from the part's lower "
        "left sample",
        shownInput(path_b), shownInput(path_a)));
  return NominalInPlace{placed->motion, std::nullopt};
}

// The mesh is searched as a whole for each piece, as for the part.
engine::Result<Foreseen> foreseeNominal(const NominalComparison& comparison, const engine::Version& part,
                                        const engine::NominalMesh& mesh,
                                        const engine::NominalOptions& options, engine::JobControl& job) {
  const auto stored = engine::placedAsStored(mesh, part.grid());
  std::vector<PlannedStep> steps;
  if (comparison.align != nullptr) steps.emplace_back(plannedAlignment(part, mesh, *comparison.align));
  steps.emplace_back(PlannedOnPieces{.work = [&, motion = stored ? stored->motion : engine::RigidMotion{}](
                                                 const engine::SampleRect& r,
                                                 engine::JobControl& own) -> engine::Result<engine::Version> {
    const engine::Version piece = engine::pieceOf(part, r.column, r.row, r.columns, r.rows);
    engine::RigidMotion to_piece = motion;
    to_piece.shift -= glm::dvec3(r.column * part.grid().spacingXMm(), r.row * part.grid().spacingYMm(), 0.0);
    auto found = engine::deviationFromNominal(piece, mesh, to_piece, options, own);
    if (!found) return tl::unexpected(found.error());
    return std::move(found->field);
  }});
  const bool in_memory = memoryPlace(comparison.deviation) != nullptr;
  const PlannedWork planned{.field = part,
                            .original = part,
                            .steps = std::move(steps),
                            .out = in_memory ? std::string() : comparison.deviation,
                            .extension = isStream(comparison.deviation)
                                             ? withDot(comparison.to)
                                             : engine::extensionOf(comparison.deviation),
                            .writing = {}};
  // Of a part with few samples what is done once for the mesh is most of the work.
  const bool few = static_cast<std::int64_t>(mesh.triangles().size()) * 32 > part.grid().samples();
  if (few && !comparison.estimate) return Foreseen{};
  return foresee(planned, shownInput(comparison.nominal), comparison.estimate, job);
}

}  // namespace

void addInspectOptions(Command command, InspectArguments& arguments) {
  addNominalOptions(command, arguments.nominal);
  command.add(
      {{.name = "--distance",
        .to = &arguments.distance,
        .text = "What the deviation from a mesh is",
        .words = {{"vertical", "height over its topmost surface"},
                  {"shortest", "to its nearest place, above 0 outside, below 0 inside"}}},
       {.name = "--tolerance",
        .to = &arguments.tolerance,
        .text = "Count what lies within this of the mesh on both sides, above and below; in A's height unit "
                "or with one",
        .shown = "D"}},
      "A nominal mesh as B");
}

std::string optionOfNominal(const InspectArguments& arguments) {
  return !arguments.nominal.unit.empty()    ? "--nominal-unit"
         : arguments.distance != "vertical" ? "--distance"
         : !arguments.tolerance.empty()     ? "--tolerance"
                                            : "";
}

engine::Result<Report> compareNominal(const NominalComparison& comparison, engine::JobControl& job) {
  const auto& [part, nominal, arguments, counted, align, reading, deviation, to, estimate] = comparison;
  engine::NominalOptions options;
  options.distance = arguments.distance == "shortest" ? engine::NominalDistance::kShortest
                                                      : engine::NominalDistance::kVertical;
  const auto a = loadSamples(part, reading, job);
  if (!a) return tl::unexpected(a.error());
  const engine::Grid& grid = a->field.grid();
  if (!arguments.tolerance.empty()) {
    const auto tolerance = parseHeight(arguments.tolerance, grid, "--tolerance");
    if (!tolerance) return tl::unexpected(tolerance.error());
    options.tolerance = *tolerance;
  }
  const auto loaded = loadNominal(
      nominal, arguments.nominal, reading.from, grid,
      options.distance == engine::NominalDistance::kShortest ? Sides::kNeeded : Sides::kNotNeeded, job);
  if (!loaded) return tl::unexpected(loaded.error());
  const engine::NominalMesh* const mesh = &loaded->mesh;
  auto foreseen = foreseeNominal(comparison, a->field, *mesh, options, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  auto placed = nominalInPlace(*a, *mesh, part, nominal, align, job);
  if (!placed) return tl::unexpected(placed.error());
  const auto region = chosenOf(a->field, a->original, part, counted, job);
  if (!region) return tl::unexpected(region.error());
  warnOfFilled(*region, a->original, part);
  auto found = engine::deviationFromNominal(*region, *mesh, placed->motion, options, job);
  if (!found) return tl::unexpected(found.error());
  // Holes are in no region, and what is left out is no hole of the part.
  if (counted.region != "all") found->unmeasured = 0;
  if (found->samples == 0)
    return engine::inputError("no sample of the part lies over or under a triangle", shownInput(nominal),
                              "give --align all, or state its unit with --nominal-unit");
  if (found->no_nominal > found->samples)
    warn(
        fmt::format("{}: {} samples lie over no triangle, {} over one: does it lie where {} does? --align "
                    "all brings it there",
                    shownInput(nominal), found->no_nominal, found->samples, shownInput(part)));
  if (found->turned)
    warn(fmt::format(
        "{}: its triangles are wound clockwise seen from above: inside and outside were exchanged",
        shownInput(nominal)));
  if (found->face_down > 0)
    warn(fmt::format("{}: {} samples lie over triangles that are wound the other way round",
                     shownInput(nominal), found->face_down));
  Report report{{"unit", grid.height_unit.name},
                {"distance", arguments.distance},
                {"samples", found->samples},
                {"no_nominal", found->no_nominal},
                {"unmeasured", found->unmeasured},
                {"rms", found->rms},
                {"mean", found->mean},
                {"min", found->min},
                {"max", found->max},
                {"max_abs", found->max_abs},
                {"p99", found->p99}};
  if (options.tolerance)
    report.update({{"tolerance", *options.tolerance},
                   {"within", found->within},
                   {"above", found->above},
                   {"below", found->below}});
  if (counted.region != "all") report["region"] = counted.region;
  report["nominal"] = nominalReport(*loaded);
  if (placed->alignment) report["align"] = *std::move(placed->alignment);
  if (deviation.empty()) return report;
  if (auto status = saveField(found->field, deviation, job, {}, to); !status)
    return tl::unexpected(status.error());
  report["deviation"] = deviation;
  return report;
}

}  // namespace fettle::app
