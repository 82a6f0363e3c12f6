#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/known_steps.h"
#include "app/commands/output_checks.h"
#include "app/commands/region_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/edge_strokes.h"
#include "app/work/line_edits.h"
#include "app/work/line_pieces.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/base/stopwatch.h"
#include "engine/edges/corners.h"
#include "engine/edges/locate.h"
#include "engine/field/live_field.h"
#include "engine/field/piece.h"
#include "engine/field/version.h"
#include "engine/fill/filled_samples.h"
#include "engine/formats/formats.h"
#include "engine/inspect/noise.h"
#include "engine/io/lines/lines.h"
#include "engine/io/raster/marks.h"
#include "engine/marks/change_marks.h"
#include "engine/marks/edge_suggestion.h"
#include "engine/marks/edge_traces.h"
#include "haptic/base/strokes.h"

namespace fettle::app {

namespace {

// Marks the samples within `radius` of `centre`, at least the nearest one. False when memory ran out.
bool markDisc(engine::LiveField& live, glm::dvec2 centre, double radius) {
  const engine::Grid& grid = live.grid();
  const auto mark = [&](std::int32_t column, std::int32_t row) {
    return !grid.contains(column, row) || std::isnan(live.reader().heightAt(column, row)) ||
           live.setMark(column, row, true);
  };
  // Lines may lead far out of the field.
  if (!(centre.x > -radius - 1.0 && centre.x < grid.width + radius && centre.y > -radius - 1.0 &&
        centre.y < grid.height + radius))
    return true;
  if (!mark(static_cast<std::int32_t>(std::lround(centre.x)),
            static_cast<std::int32_t>(std::lround(centre.y))))
    return false;
  const auto top = static_cast<std::int32_t>(std::floor(centre.y + radius));
  for (auto row = static_cast<std::int32_t>(std::ceil(centre.y - radius)); row <= top; ++row) {
    const double half = std::sqrt(std::max(0.0, radius * radius - (row - centre.y) * (row - centre.y)));
    const auto right = static_cast<std::int32_t>(std::floor(centre.x + half));
    for (auto column = static_cast<std::int32_t>(std::ceil(centre.x - half)); column <= right; ++column)
      if (!mark(column, row)) return false;
  }
  return true;
}

// The strokes of the tool `mark` in a strokes file (edgeStrokesOf). Errors (kInput): as readStrokes, no such stroke.
engine::Result<std::vector<engine::EdgeStroke>> markedStrokes(const std::string& path,
                                                              const engine::Grid& grid) {
  const auto rows = haptic::readStrokes(path);
  if (!rows) return tl::unexpected(rows.error());
  std::vector<engine::EdgeStroke> strokes = edgeStrokesOf(*rows, grid);
  if (strokes.empty())
    return engine::inputError("the strokes have no stroke of the tool mark", path,
                              "draw along edges with it");
  // Lines of them would be lines of no sample.
  const std::size_t outside = std::erase_if(strokes, [&](const engine::EdgeStroke& stroke) {
    return std::ranges::none_of(stroke.points, [&](const glm::dvec2& p) {
      return p.x > -1.0 && p.y > -1.0 && p.x < grid.width && p.y < grid.height;
    });
  });
  if (strokes.empty())
    return engine::inputError("all strokes of the tool mark lie outside the scan", path,
                              "give strokes of this scan, in millimetres from its lower left sample");
  if (outside > 0)
    warn(fmt::format("{}: {} of {} strokes of the tool mark lie outside the scan and are left out",
                     shownInput(path), outside, outside + strokes.size()));
  return strokes;
}

// Edge lines along strokes, located by the samples of `field`, whose noise is measured. Errors: no noise, which
// states how sure a line is (kInput); as locateEdgeLines. The ends of the lines are extended to where they meet
// (engine::extendEnds).
engine::Result<std::vector<engine::EdgeLine>> locateLines(const engine::Version& field,
                                                          const std::vector<engine::EdgeStroke>& strokes,
                                                          const engine::LocateOptions& options,
                                                          engine::JobControl& job) {
  const auto noise = engine::estimateNoise(field, job);
  if (!noise) return tl::unexpected(noise.error());
  auto lines = engine::locateEdgeLines(field.reader(), noise->sigma, strokes, options, job);
  if (lines) engine::extendEnds(*lines, 0, field.grid().width, field.grid().height);
  return lines;
}

// Adds marks to all samples within `thickness` [samples], 0 .. 64, of a point of the lines: 0 marks the nearest
// sample of each. Holes are not marked. Errors: a thickness out of range (kInput), cancelled, memory.
engine::Result<engine::Version> markLines(const engine::Version& field,
                                          const std::vector<engine::EdgeLine>& lines, double thickness,
                                          engine::JobControl& job) {
  if (!(thickness >= 0.0 && thickness <= 64.0))
    return engine::inputError(fmt::format("a thickness of {} samples cannot be used", thickness), "thickness",
                              "give 0 to 64");
  engine::LiveField live(field, engine::Growth::kAllowed);
  job.begin("drawing edges", static_cast<std::uint64_t>(engine::countPoints(lines)));
  for (const engine::EdgeLine& line : lines)
    for (const engine::EdgePoint& point : line.points) {
      if (job.cancelled()) return engine::cancelled();
      if (!markDisc(live, point.position, thickness))
        return engine::failure("there is not enough memory for the marks", "mark");
      job.advance();
    }
  return live.snapshot();
}

struct MarkArguments {
  std::string in;
  std::string out;
  std::string to = kMarksStream;
  std::string add;
  bool edges = false;
  bool as_lines = false;
  std::string strokes;
  std::string lines_out;
  engine::LocateOptions locating;
  double scale = engine::EdgeMap::kUsualSigma;
  engine::EdgeChoice choice;
  RegionArguments within{.region = ""};
  bool filled = false;
  bool invert = false;
  bool estimate = false;
  ScanOptions reading;
};

void reportLines(const std::vector<engine::EdgeLine>& lines, Report& report) {
  double squares = 0.0;
  std::int64_t located = 0;
  for (const engine::EdgeLine& line : lines)
    for (const engine::EdgePoint& p : line.points)
      if (p.located) {
        ++located;
        squares += p.deviation * p.deviation;
      }
  const auto points = static_cast<double>(engine::countPoints(lines));
  const auto found = static_cast<double>(located);
  // Edges that became marks are counted already: located lines end where an edge cannot be, and are more.
  if (!report.contains("lines")) report["lines"] = lines.size();
  report["lines_written"] = lines.size();
  report["line_points"] = engine::countPoints(lines);
  report["located"] = found / points;
  report["deviation"] = located > 0 ? Report(std::sqrt(squares / found)) : Report();
}

// Locates the edges along the strokes, writes their lines if asked and marks them.
engine::Result<engine::Version> markStrokes(const engine::Version& field, const MarkArguments& options,
                                            Report& report, engine::JobControl& job) {
  const auto strokes = markedStrokes(options.strokes, field.grid());
  if (!strokes) return tl::unexpected(strokes.error());
  const auto lines = locateLines(field, *strokes, options.locating, job);
  if (!lines) return tl::unexpected(lines.error());
  auto marked = markLines(field, *lines, options.choice.thickness, job);
  if (!marked) return marked;
  if (!options.lines_out.empty())
    if (auto status = saveLines(*lines, field.grid(), options.lines_out, job); !status)
      return tl::unexpected(status.error());
  report["thickness"] = options.choice.thickness;
  reportLines(*lines, report);
  return marked;
}

// Locates the suggested edges and writes their lines.
engine::Status writeEdgeLines(const engine::Version& field, const engine::EdgeMap& map,
                              const MarkArguments& options, Report& report, engine::JobControl& job) {
  const auto traces = engine::traceEdges(field.grid(), map, options.choice, job);
  if (!traces) return tl::unexpected(traces.error());
  std::vector<engine::EdgeStroke> strokes;
  for (const engine::EdgeTrace& trace : *traces)
    strokes.push_back({static_cast<std::int64_t>(strokes.size()), trace.points, trace.closed});
  if (strokes.empty())
    return engine::inputError("no edges were found, so there are no lines", options.lines_out,
                              "give a larger --sensitivity");
  const auto located = locateLines(field, strokes, options.locating, job);
  if (!located) return tl::unexpected(located.error());
  const std::vector<engine::EdgeLine> lines = linesOfOneEdgeEach(*located, {});
  reportLines(lines, report);
  return saveLines(lines, field.grid(), options.lines_out, job);
}

// The suggested edges as lines, and marks where one cannot be located, as a recipe's locate_edges.
engine::Result<engine::Version> markAsLines(const engine::Version& field, const engine::EdgeMap& map,
                                            const MarkArguments& options, Report& report,
                                            engine::JobControl& job) {
  auto lined = drawSuggestion(field, map, options.choice, job);
  if (!lined) return lined;
  if (!lined->lines())
    return engine::inputError("no edges could be located, so there are no lines", options.lines_out,
                              "give a larger --sensitivity");
  reportLines(*lined->lines(), report);
  if (auto status = saveLines(*lined->lines(), lined->grid(), options.lines_out, job); !status)
    return tl::unexpected(status.error());
  return lined;
}

// Marks the suggested edges and writes their lines if asked.
engine::Result<engine::Version> markEdges(const engine::Version& scan, const engine::Version& field,
                                          const MarkArguments& options, Report& report,
                                          engine::JobControl& job) {
  const auto map = engine::findEdges(field, options.scale, job);
  if (!map) return tl::unexpected(map.error());
  report["scale"] = options.scale;
  report["sensitivity"] = options.choice.sensitivity;
  report["thickness"] = options.choice.thickness;
  report["step_noise"] = map->step_noise;
  report["crease_noise"] = map->crease_noise;
  if (options.as_lines) return markAsLines(field, *map, options, report, job);
  auto found = engine::suggestMarks(field, *map, options.choice, job);
  if (!found) return tl::unexpected(found.error());
  report["lines"] = found->lines;
  report["line_samples"] = found->samples;
  if (!options.lines_out.empty())
    if (auto status = writeEdgeLines(scan, *map, options, report, job); !status)
      return tl::unexpected(status.error());
  return std::move(found->field);
}

// What the suggested edges of a piece make of it: marks and lines as markEdges.
engine::Result<engine::Version> edgesOfPiece(const engine::Version& piece, const MarkArguments& options,
                                             engine::JobControl& job) {
  const auto map = engine::findEdges(piece, options.scale, job);
  if (!map) return tl::unexpected(map.error());
  if (options.as_lines) return drawSuggestion(piece, *map, options.choice, job);
  auto found = engine::suggestMarks(piece, *map, options.choice, job);
  if (!found) return tl::unexpected(found.error());
  if (options.lines_out.empty()) return std::move(found->field);
  auto lined = drawSuggestion(piece, *map, options.choice, job);
  if (!lined) return lined;
  return found->field.withLines(lined->lines());
}

// The samples of a shape, beside those that are marked.
engine::Result<engine::Version> markRegion(const engine::Version& scan, const engine::Version& field,
                                           const MarkArguments& options, engine::JobControl& job) {
  const auto inside = countedOf(scan, std::nullopt, options.in, options.within, job);
  if (!inside) return tl::unexpected(inside.error());
  const engine::FieldReader of = inside->reader();
  return engine::changeMarks(
      field, engine::allTiles(field.grid()),
      [&](std::int32_t tc, std::int32_t tr, const engine::Tile& tile, engine::MarkRows& rows) {
        engine::applyChange(tile, of.tile(tc, tr).marks, engine::MarkChange::kMark, rows);
      },
      job);
}

// A field with its marks stays in memory with its steps. Suggested edges are one; other marks belong to their scan.
engine::Status noteMarks(const MarkArguments& options, const engine::Imported& imported, MemoryPlace& place,
                         engine::JobControl& job) {
  auto known = KnownSteps::of(imported, {options.in, options.out, {}}, job);
  if (!known) return tl::unexpected(known.error());
  if (options.edges) known->did(RecipeEdges{EdgesBecome::kMarks, options.scale, options.choice});
  for (const auto& [given, what] : {std::pair(options.as_lines, "that edges became lines"),
                                    {!options.strokes.empty(), "strokes"},
                                    {!options.add.empty(), "marks that were added"},
                                    {!options.within.region.empty(), "marks of a region"},
                                    {options.filled, "marks of filled samples"},
                                    {options.invert, "that marks were inverted"}})
    if (given) known->leftOut(what);
  engine::ExportOptions notes;
  known->note(notes);
  place.scan->recipe = notes.recipe;
  place.scan->steps = notes.steps;
  return {};
}

engine::Result<Report> mark(const MarkArguments& options, engine::JobControl& job) {
  if (!options.lines_out.empty() && options.strokes.empty() && !options.edges)
    return engine::inputError("lines are located from strokes or edges", "--lines-out",
                              "give --strokes or --edges");
  if (options.as_lines && (!options.edges || options.lines_out.empty()))
    return engine::inputError("edges become lines where both are named", "--as-lines",
                              "give --edges and --lines-out as well");
  if (!options.edges && !options.invert && !options.filled && options.strokes.empty() &&
      options.add.empty() && options.within.region.empty())
    return engine::inputError(
        "it is not stated what to mark", "mark",
        "give --edges, --strokes, --region, --filled, --invert, or --add to write marks in another format");
  if (auto status = checkOutputs({{options.out, OutputKind::kMarks, options.to},
                                  {options.lines_out, OutputKind::kLines, kLinesStream}},
                                 {options.in, options.add, options.strokes}, Replacing::kNoWork, job);
      !status)
    return tl::unexpected(status.error());
  auto imported = loadScan(options.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  if (options.filled && !imported->original)
    return engine::inputError("the file does not say which samples were filled", shownInput(options.in),
                              "give the session of fettle fill, which --filled-out makes marks of, too");
  auto marked = withMarks(imported->field, options.add, job);
  if (!marked) return tl::unexpected(marked.error());
  engine::Version field = *std::move(marked);
  std::vector<PlannedStep> steps;
  if (options.edges)
    steps.emplace_back(PlannedOnPieces{[&](const engine::SampleRect& r, engine::JobControl& own) {
      const engine::Version piece = engine::pieceOf(field, r.column, r.row, r.columns, r.rows);
      return edgesOfPiece(piece, options, own);
    }});
  if (!steps.empty()) std::get<PlannedOnPieces>(steps.back()).uneven = true;
  const PlannedWork planned{
      .field = field,
      .original = field,
      .steps = std::move(steps),
      .out = options.out,
      .extension = isStream(options.out) ? withDot(options.to) : engine::extensionOf(options.out),
      .writing = {},
      .write = [&](const engine::Version& piece, const std::string& path,
                   engine::JobControl&) -> engine::Status {
        if (auto status = engine::exportMarks(piece, path); !status) return status;
        if (options.lines_out.empty() || piece.lines() == nullptr ||
            memoryPlace(options.lines_out) != nullptr)
          return {};
        const std::string lines = isStream(options.lines_out) ? kLinesStream : options.lines_out;
        return engine::exportLines(path + ".lines" + engine::extensionOf(lines), *piece.lines(),
                                   piece.grid());
      }};
  engine::Result<Foreseen> foreseen;
  if (memoryPlace(options.out) == nullptr)
    foreseen = foresee(planned, shownOutput(options.out), options.estimate, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  const engine::Stopwatch watch;
  Report report;
  if (options.edges) {
    auto edges = markEdges(imported->field, field, options, report, job);
    if (!edges) return tl::unexpected(edges.error());
    field = *std::move(edges);
  }
  if (!options.strokes.empty()) {
    auto along = markStrokes(field, options, report, job);
    if (!along) return tl::unexpected(along.error());
    field = *std::move(along);
  }
  if (!options.within.region.empty()) {
    auto inside = markRegion(imported->field, field, options, job);
    if (!inside) return tl::unexpected(inside.error());
    field = *std::move(inside);
  }
  if (options.filled) {
    auto filled = engine::withFilledMarked(field, *imported->original, engine::OtherMarks::kStay, job);
    if (!filled) return tl::unexpected(filled.error());
    field = *std::move(filled);
  }
  if (options.invert) {
    auto inverted = engine::invertMarks(field, job);
    if (!inverted) return tl::unexpected(inverted.error());
    field = *std::move(inverted);
  }
  const double seconds = watch.seconds();
  if (auto status = saveMarks(field, options.out, job, options.to); !status)
    return tl::unexpected(status.error());
  if (MemoryPlace* place = memoryPlace(options.out))
    if (auto status = noteMarks(options, *imported, *place, job); !status)
      return tl::unexpected(status.error());
  report["marked"] = engine::summarize(field).marked;
  report["seconds"] = seconds;
  return report;
}

}  // namespace

void addMark(Command root, Chosen& chosen) {
  auto options = std::make_shared<MarkArguments>();
  Command command = addCommand(root, chosen, "mark", "Mark samples that filters must not change",
                               [options](engine::JobControl& job) { return mark(*options, job); });
  command.add({
      {.name = "SCAN",
       .to = &options->in,
       .text = "The scan to read; - for standard input",
       .kind = ValueKind::kInput,
       .required = true},
      {.name = "MARKS",
       .to = &options->out,
       .text = "Picture of marks to write: .png, .tif, a GeoTIFF; - for standard output",
       .kind = ValueKind::kOutput,
       .required = true},
      {.name = "--edges",
       .to = &options->edges,
       .text = "Mark the sharp edges of the part, as the window suggests them"},
      {.name = "--as-lines",
       .to = &options->as_lines,
       .text = "With --edges and --lines-out: an edge that can be located is a line alone, and only the rest "
               "is marked"},
      {.name = "--strokes",
       .to = &options->strokes,
       .text = "Strokes file: mark the edges that were drawn with the tool mark, where the scan shows them",
       .kind = ValueKind::kFile,
       .excludes = {"--edges"}},
      {.name = "--hand",
       .to = &options->locating.hand_deviation,
       .text = "How far --strokes are off the edges, a standard deviation",
       .range = Range{engine::LocateOptions::kLeastHand, engine::LocateOptions::kMostHand},
       .unit = "samples"},
      {.name = "--lines-out",
       .to = &options->lines_out,
       .text = "Write the edge lines of --strokes or --edges: .csv (every value), .geojson, .gpkg, .dxf",
       .kind = ValueKind::kNewLines},
      {.name = "--scale",
       .to = &options->scale,
       .text = "Edges: scale of the search; larger finds fainter ones",
       .range = Range{0.7, 8.0},
       .unit = "samples"},
      {.name = "--sensitivity",
       .to = &options->choice.sensitivity,
       .text = "Edges: 0 takes only the strongest, 1 all above the noise",
       .range = Range{0.0, 1.0}},
      {.name = "--thickness",
       .to = &options->choice.thickness,
       .text = "Edges and strokes: marked to this distance",
       .range = Range{0.0, 64.0},
       .unit = "samples"},
      {.name = "--add",
       .to = &options->add,
       .text = "Picture of marks to begin with; alone it is written as MARKS, as a GeoTIFF with the place of "
               "SCAN",
       .kind = ValueKind::kMarks},
      regionRow(options->within, "Mark the samples of this region, too", "", shapeWords()),
      {.name = "--filled", .to = &options->filled, .text = "Mark the samples that were filled, of a session"},
      {.name = "--invert", .to = &options->invert, .text = "Afterwards, invert the marks"},
  });
  command.add({{.name = "--to",
                .to = &options->to,
                .text = "With - for MARKS, standard output: its format, png or tif, a GeoTIFF",
                .kind = ValueKind::kText,
                .proposed = {"png", "tif"}}});
  addEstimateOption(command, options->estimate);
  addScanOptions(command, options->reading);
  command.examples(
      {{"fettle mark scan.tif marks.png --edges --lines-out lines.csv",
        "The sharp edges that the program finds, as marks and as lines"},
       {"fettle mark scan.tif drawn.png --strokes strokes.csv --lines-out drawn.csv",
        "The edges that were drawn by hand"},
       {"fettle mark scan.tif bore.png --region \"polygon 2,1 4,1 3,3\"", "What lies between three places"}});
}

}  // namespace fettle::app
