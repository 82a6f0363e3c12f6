#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/form_option.h"
#include "app/commands/output_checks.h"
#include "app/commands/scale_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/terminal.h"
#include "app/work/layer_over.h"
#include "app/work/memory_places.h"
#include "app/work/read_units.h"
#include "app/work/streams.h"
#include "engine/field/builder.h"
#include "engine/field/piece.h"
#include "engine/formats/formats.h"
#include "engine/io/files/atomic_file.h"
#include "engine/marks/change_marks.h"
#include "engine/measure/areal.h"
#include "engine/measure/hills.h"
#include "engine/measure/surface.h"

namespace fettle::app {

namespace {

struct FeatureRun {
  std::string scan;
  FormArguments form;
  ScaleArguments scale;
  std::string kind = "hills";
  double prune = 5.0;  // [% of Sz]
  std::string csv, labels, edges, to;
  Replacing replacing = Replacing::kNoWork;
  bool estimate = false;
  ScanOptions reading;
  engine::ExportOptions writing;
};

// The segments of a surface, and where it lies in the field. Heights of dales are below it.
struct Segments {
  engine::Surface surface;
  engine::HillMap map;
  std::vector<engine::HillFigures> figures;
  double sz = 0.0, least = 0.0;
  bool dales = false;
};

engine::Result<Segments> segmentsOf(const FeatureRun& options, const ScaleLimited& limited,
                                    engine::JobControl& job) {
  engine::ArealOptions height;
  height.region = formChoiceOf(options.form).region;
  height.hybrid = height.functional = height.spatial = height.feature = false;
  const auto measured = engine::measureAreal(limited.field, limited.form, height, job);
  if (!measured) return tl::unexpected(measured.error());
  auto surface = engine::surfaceOf(limited.field, limited.form, measured->mean, height.region, job);
  if (!surface) return tl::unexpected(surface.error());
  if (surface->heights.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    return engine::inputError("more than 2 147 483 647 samples", shownInput(options.scan), "crop it first");
  Segments segments;
  segments.dales = options.kind == "dales";
  if (segments.dales)
    for (float& z : surface->heights) z = -z;
  segments.sz = measured->sz;
  segments.least = 0.01 * options.prune * measured->sz;
  auto map = engine::mapHills(*surface, segments.least, job);
  if (!map) return tl::unexpected(map.error());
  segments.figures = engine::figuresOfHills(*surface, *map);
  segments.surface = *std::move(surface);
  segments.map = *std::move(map);
  return segments;
}

// The number of its segment at each sample, from 1; a hole where there is none.
engine::Result<engine::Version> labelled(const Segments& segments, const engine::Grid& of,
                                         engine::JobControl& job) {
  // Labels are samples, and those are floats: above this, neighbours would share a number.
  constexpr std::size_t kMostLabels = std::size_t{1} << std::numeric_limits<float>::digits;
  if (segments.figures.size() > kMostLabels)
    return engine::inputError(
        fmt::format("{} segments, and a label has {} values", segments.figures.size(), kMostLabels),
        "--labels", "give a larger --prune");
  engine::Grid grid = of;
  grid.height_per_count = 0.0;
  auto builder = engine::FieldBuilder::create(std::move(grid), "the labels");
  if (!builder) return tl::unexpected(builder.error());
  const engine::Surface& surface = segments.surface;
  std::vector<float> row(static_cast<std::size_t>(surface.width));
  for (std::int32_t r = 0; r < surface.height; ++r) {
    if (job.cancelled()) return engine::cancelled();
    for (std::int32_t c = 0; c < surface.width; ++c) {
      const std::int32_t number =
          segments.map.of[static_cast<std::size_t>(r) * row.size() + static_cast<std::size_t>(c)];
      row[static_cast<std::size_t>(c)] = number == engine::HillMap::kNone
                                             ? std::numeric_limits<float>::quiet_NaN()
                                             : static_cast<float>(number + 1);
    }
    builder->writeHeights(surface.first_column, surface.first_row + r, surface.width, 1, row.data(),
                          surface.width);
  }
  return std::move(*builder).build();
}

// The field with the samples marked that have a neighbour of another segment along their row or column, with a higher number: one sample wide.
engine::Result<engine::Version> outlined(const Segments& segments, const engine::Version& field,
                                         engine::JobControl& job) {
  const engine::Surface& surface = segments.surface;
  const auto number = [&](std::int32_t column, std::int32_t row) {
    const std::int32_t c = column - surface.first_column, r = row - surface.first_row;
    if (c < 0 || r < 0 || c >= surface.width || r >= surface.height) return engine::HillMap::kNone;
    return segments.map.of[static_cast<std::size_t>(r) * static_cast<std::size_t>(surface.width) +
                           static_cast<std::size_t>(c)];
  };
  const auto on_edge = [&](std::int32_t column, std::int32_t row) {
    const std::int32_t own = number(column, row);
    if (own == engine::HillMap::kNone) return false;
    for (const auto& [c, r] :
         {std::pair(column + 1, row), {column, row + 1}, {column - 1, row}, {column, row - 1}})
      if (number(c, r) > own) return true;
    return false;
  };
  return engine::changeMarks(
      field, engine::allTiles(field.grid()),
      [&](std::int32_t tc, std::int32_t tr, const engine::Tile&, engine::MarkRows& rows) {
        for (int r = 0; r < engine::kTileSide; ++r) {
          std::uint64_t bits = 0;
          for (int c = 0; c < engine::kTileSide; ++c)
            if (on_edge(tc * engine::kTileSide + c, tr * engine::kTileSide + r))
              bits |= std::uint64_t{1} << c;
          rows[static_cast<std::size_t>(r)] = bits;
        }
      },
      job);
}

Report featureReport(const Segments& segments, const engine::Grid& grid) {
  Report features = Report::array();
  const double mm = grid.lateral_unit.mm, sign = segments.dales ? -1.0 : 1.0;
  for (std::size_t i = 0; i < segments.figures.size(); ++i) {
    const engine::HillFigures& of = segments.figures[i];
    features.push_back({{"number", i + 1},
                        {"x", (of.hill.column + segments.surface.first_column) * grid.spacing_x},
                        {"y", (of.hill.row + segments.surface.first_row) * grid.spacing_y},
                        {"z", sign * of.hill.peak},
                        {"height", of.hill.height},
                        {"samples", of.samples},
                        {"area", of.area_mm2 / (mm * mm)},
                        {"area_above", of.area_above_mm2 / (mm * mm)},
                        {"volume", of.volume_mm3 / (mm * mm * grid.height_unit.mm)},
                        {"open", of.open}});
  }
  return features;
}

// Of those that do not reach the border, as ISO 25178-2 has it of closed features; null without one.
Report closedMean(const Report& features, const char* key) {
  double sum = 0.0;
  int count = 0;
  for (const Report& feature : features)
    if (!feature["open"].get<bool>()) {
      sum += feature[key].get<double>();
      ++count;
    }
  return count > 0 ? Report(sum / count) : Report();
}

std::string featureCsv(const Report& report) {
  const std::string height = report["unit"], length = report["lateral_unit"];
  std::string text = fmt::format(
      "number,x [{1}],y [{1}],z [{0}],height [{0}],samples,area [{1}2],area above saddle [{1}2],volume above "
      "saddle "
      "[{1}2 {0}],open,layer\n",
      height, length);
  for (const Report& f : report["features"])
    text += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.9g},{},{:.9g},{:.9g},{:.9g},{},{}\n",
                        f["number"].get<int>(), f["x"].get<double>(), f["y"].get<double>(),
                        f["z"].get<double>(), f["height"].get<double>(), f["samples"].get<std::int64_t>(),
                        f["area"].get<double>(), f["area_above"].get<double>(), f["volume"].get<double>(),
                        f["open"].get<bool>() ? "yes" : "no", layerOf(report));
  return text;
}

engine::Status writeFeatures(const FeatureRun& options, const Segments& segments,
                             const engine::Version& field, const Report& report, engine::JobControl& job) {
  if (!options.labels.empty()) {
    const auto labels = labelled(segments, field.grid(), job);
    if (!labels) return tl::unexpected(labels.error());
    if (auto status = saveField(*labels, options.labels, job, options.writing, options.to); !status)
      return status;
  }
  if (!options.edges.empty()) {
    const auto edges = outlined(segments, field, job);
    if (!edges) return tl::unexpected(edges.error());
    if (auto status = saveMarks(*edges, options.edges, job); !status) return status;
  }
  if (options.csv.empty()) return {};
  return writeTo(options.csv, ".csv", job, [&](const std::string& file) {
    return engine::writeFileAtomically(file, featureCsv(report));
  });
}

// The surface, its order by height and the segment of each sample [bytes for each]; measured on 1200, 4096 and 8192 a side.
constexpr double kSegmentingMemory = 30.0;

engine::Result<Foreseen> foreseeFeatures(const FeatureRun& options, const engine::Version& counted,
                                         const engine::Imported& imported, engine::JobControl& job) {
  const auto segmentsOfPiece = [&](const engine::SampleRect& r,
                                   engine::JobControl& own) -> engine::Result<engine::Version> {
    const KeptMessages said;  // of the scan the command itself says it
    const engine::Version piece = engine::pieceOf(counted, r.column, r.row, r.columns, r.rows);
    // Of a piece of holes there is nothing to segment.
    const auto taken = [&](const engine::Error& error) -> engine::Result<engine::Version> {
      if (error.kind == engine::ErrorKind::kInput) return piece;
      return tl::unexpected(error);
    };
    const auto limited = scaleLimited(piece, options.scan, imported, options.form, options.scale, own);
    if (!limited) return taken(limited.error());
    const auto segments = segmentsOf(options, *limited, own);
    if (!segments) return taken(segments.error());
    return options.labels.empty() ? piece : labelled(*segments, piece.grid(), own);
  };
  PlannedOnPieces segmenting{.work = segmentsOfPiece, .memory_each = kSegmentingMemory};
  // The picture of --edges and the table are small beside labels.
  const PlannedWork planned{
      .field = counted,
      .original = counted,
      .steps = {std::move(segmenting)},
      .out = memoryPlace(options.labels) == nullptr ? options.labels : std::string(),
      .extension = isStream(options.labels) ? withDot(options.to) : engine::extensionOf(options.labels),
      .writing = options.writing};
  return foresee(planned, shownInput(options.scan), options.estimate, job);
}

engine::Result<Report> features(const FeatureRun& options, engine::JobControl& job) {
  if (auto status = checkForm(options.form); !status) return tl::unexpected(status.error());
  if (auto status = checkOutputs({{options.csv, OutputKind::kText, ".csv"},
                                  {options.labels, OutputKind::kField, options.to},
                                  {options.edges, OutputKind::kMarks, kMarksStream}},
                                 {options.scan, options.form.marks}, options.replacing, job);
      !status)
    return tl::unexpected(status.error());
  const auto imported = loadScan(options.scan, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const auto counted = countedOf(imported->field, imported->original, options.scan, options.form, job);
  if (!counted) return tl::unexpected(counted.error());
  auto foreseen = foreseeFeatures(options, *counted, *imported, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  const auto limited = scaleLimited(*counted, options.scan, *imported, options.form, options.scale, job);
  if (!limited) return tl::unexpected(limited.error());
  const auto segments = segmentsOf(options, *limited, job);
  if (!segments) return tl::unexpected(segments.error());
  const engine::Grid& grid = imported->field.grid();
  Report report;
  addForm(report, options.form, limited->fit, grid);
  addLayer(report, imported->field);
  addScale(report, options.scale);
  report["kind"] = options.kind;
  report["unit"] = grid.height_unit.name;
  report["unit_mm"] = grid.height_unit.mm;
  report["lateral_unit"] = grid.lateral_unit.name;
  report["lateral_unit_mm"] = grid.lateral_unit.mm;
  report["sz"] = segments->sz;
  report["least_height"] = segments->least;
  report["count"] = segments->figures.size();
  report["features"] = featureReport(*segments, grid);
  for (const auto& [key, of] :
       {std::pair("mean_height", "height"), {"mean_area", "area"}, {"mean_volume", "volume"}})
    report[key] = closedMean(report["features"], of);
  if (auto status = writeFeatures(options, *segments, imported->field, report, job); !status)
    return tl::unexpected(status.error());
  return report;
}

void printFeatures(const Report& report) {
  if (report.contains("text")) return printReport(report);
  constexpr std::size_t kShown = 12;
  const ReadAs height = readLengthAs(report["sz"].get<double>(), report["unit_mm"], report["unit"]);
  const std::string length = report["lateral_unit"];
  const std::string volume =
      height.name == length ? length + "3" : fmt::format("{}2 {}", length, height.name);
  const Report& all = report["features"];
  fmt::print("{} {} at least {:.4g} {} high\n", all.size(), report["kind"].get<std::string>(),
             report["least_height"].get<double>() / height.size, height.name);
  printLayer(report);
  if (const std::string scale = scaleText(report, "\n"); !scale.empty()) fmt::print("{}\n", scale);
  if (!report["mean_area"].is_null())
    fmt::print("closed ones in the mean: height {:.4g} {}, area {:.4g} {}2, volume {:.4g} {}\n",
               report["mean_height"].get<double>() / height.size, height.name,
               report["mean_area"].get<double>(), length, report["mean_volume"].get<double>() / height.size,
               volume);
  if (all.empty()) return;
  fmt::print("{:>6} {:>12} {:>12} {:>12} {:>12} {:>12} {:>12}\n", "number", "x " + length, "y " + length,
             "z " + height.name, "height " + height.name, "area " + length + "2", "volume " + volume);
  for (std::size_t i = 0; i < std::min(kShown, all.size()); ++i) {
    const Report& f = all[i];
    fmt::print("{:>6} {:>12.6g} {:>12.6g} {:>12.5g} {:>12.5g} {:>12.5g} {:>12.5g}{}\n",
               f["number"].get<int>(), f["x"].get<double>(), f["y"].get<double>(),
               f["z"].get<double>() / height.size, f["height"].get<double>() / height.size,
               f["area"].get<double>(), f["volume"].get<double>() / height.size,
               f["open"].get<bool>() ? "  open" : "");
  }
  if (all.size() > kShown) fmt::print("and {} more: --csv has all\n", all.size() - kShown);
}

}  // namespace

void addFeatures(Command root, Chosen& chosen) {
  auto options = std::make_shared<FeatureRun>();
  Command command = addCommand(
      root, chosen, "features", "Hills or dales by watersheds: a table of them, labels and outlines",
      [options](engine::JobControl& job) { return features(*options, job); }, printFeatures);
  command.add(
      {{.name = "SCAN",
        .to = &options->scan,
        .text = "The scan; - for standard input",
        .kind = ValueKind::kInput,
        .required = true},
       {.name = "--kind",
        .to = &options->kind,
        .text = "What segments are",
        .words = {{"hills", "around peaks"}, {"dales", "around pits: heights and volumes are depths"}}},
       {.name = "--prune",
        .to = &options->prune,
        .text = "Lower ones become part of their neighbour: share of Sz",
        .range = Range{0.0, 100.0},
        .unit = "%"},
       {.name = "--csv",
        .to = &options->csv,
        .text = "Write a row for each, in the scan's units",
        .kind = ValueKind::kOutput},
       {.name = "--labels",
        .to = &options->labels,
        .text = "Write a scan whose heights are the segments' numbers; holes where there is none",
        .kind = ValueKind::kOutput},
       {.name = "--edges",
        .to = &options->edges,
        .text = "Write the samples at which segments meet, as a picture of marks",
        .kind = ValueKind::kNewMarks}});
  addForceOption(command, options->replacing);
  addEstimateOption(command, options->estimate);
  addStreamFormat(command, options->to);
  addCompressOption(command, options->writing);
  addFormOptions(command, options->form);
  addScaleOptions(command, options->scale);
  addScanOptions(command, options->reading);
  command.notes(
      "Watersheds with Wolf's pruning, as fettle measure segments for Spd and Spc. A sample belongs to the "
      "peak to which it rises over its "
      "highest neighbours. The height of a hill is that over the highest saddle to a higher one, and its "
      "volume what lies above "
      "that saddle. Open: above its saddle it reaches the border or a hole; means are of closed ones. "
      "Positions are lengths from the lower left "
      "sample.");
  command.examples({{"fettle features scan.tif --csv hills.csv", "Hills of 5 % of Sz and more, as a table"},
                    {"fettle features scan.tif --kind dales --prune 10 --s-filter 2.5 --labels dales.tif "
                     "--edges dales.png",
                     "Deeper dales of the smoothed surface, which sample is of which, and their outlines"}});
}

}  // namespace fettle::app
