#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/form_option.h"
#include "app/commands/output_checks.h"
#include "app/commands/scale_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/terminal.h"
#include "app/work/field_features.h"
#include "app/work/layer_over.h"
#include "app/work/memory_places.h"
#include "app/work/read_units.h"
#include "app/work/streams.h"
#include "engine/field/piece.h"
#include "engine/formats/formats.h"
#include "engine/io/files/atomic_file.h"

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

engine::Result<FieldFeatures> segmentsOf(const FeatureRun& options, const ScaleLimited& limited,
                                         engine::JobControl& job) {
  return featuresOf(
      limited.field, limited.form,
      {.dales = options.kind == "dales", .prune = options.prune, .region = formChoiceOf(options.form).region},
      shownInput(options.scan), job);
}

engine::Status writeFeatures(const FeatureRun& options, const FieldFeatures& segments,
                             const engine::Version& field, const Report& report, engine::JobControl& job) {
  if (!options.labels.empty()) {
    const auto labels = featureLabels(segments, field.grid(), job);
    if (!labels) return tl::unexpected(labels.error());
    if (auto status = saveField(*labels, options.labels, job, options.writing, options.to); !status)
      return status;
  }
  if (!options.edges.empty()) {
    const auto edges = featureOutlines(segments, field, job);
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
    return options.labels.empty() ? piece : featureLabels(*segments, piece.grid(), own);
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
  report.update(featureReport(*segments, grid));
  if (auto status = writeFeatures(options, *segments, imported->field, report, job); !status)
    return tl::unexpected(status.error());
  return report;
}

void printFeatures(const Report& report) {
  if (report.contains("text")) return printReport(report);
  constexpr std::size_t kShown = 12;
  const auto [height, across] = featureUnits(report);
  const std::string& length = across.name;
  const double area = across.size * across.size;
  const std::string volume =
      height.name == length ? length + "3" : fmt::format("{}2 {}", length, height.name);
  const Report& all = report["features"];
  fmt::print("{} {} at least {:.4g} {} high\n", all.size(), report["kind"].get<std::string>(),
             report["least_height"].get<double>() / height.size, height.name);
  printLayer(report);
  if (const std::string scale = scaleText(report, "\n"); !scale.empty()) fmt::print("{}\n", scale);
  if (!report["mean_volume"].is_null())
    fmt::print("closed ones in the mean: height {:.4g} {}, volume {:.4g} {}\n",
               report["mean_height"].get<double>() / height.size, height.name,
               report["mean_volume"].get<double>() / height.size / area, volume);
  if (!report["mean_area"].is_null())
    fmt::print("those that nothing cuts in the mean: area {:.4g} {}2\n",
               report["mean_area"].get<double>() / area, length);
  if (all.empty()) return;
  fmt::print("{:>6} {:>12} {:>12} {:>12} {:>12} {:>12} {:>12}\n", "number", "x " + length, "y " + length,
             "z " + height.name, "height " + height.name, "area " + length + "2", "volume " + volume);
  for (std::size_t i = 0; i < std::min(kShown, all.size()); ++i) {
    const Report& f = all[i];
    fmt::print("{:>6} {:>12.6g} {:>12.6g} {:>12.5g} {:>12.5g} {:>12.5g} {:>12.5g}{}\n",
               f["number"].get<int>(), f["x"].get<double>() / across.size, f["y"].get<double>() / across.size,
               f["z"].get<double>() / height.size, f["height"].get<double>() / height.size,
               f["area"].get<double>() / area, f["volume"].get<double>() / height.size / area,
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
      "Watersheds with Wolf's pruning, as fettle measure segments for feature parameters. A sample belongs "
      "to the peak to which it rises over its highest neighbours. The height of a hill is that over the "
      "highest saddle to a higher one; its volume is what lies above the highest saddle to any other. Open: "
      "there it reaches the border or a hole; cut: at any height. Means of heights and volumes are of closed "
      "ones, those of areas of ones that are not cut: Shv and Sha of fettle measure, Sdv and Sda of dales. "
      "Positions are lengths from the lower left sample.");
  command.examples({{"fettle features scan.tif --csv hills.csv", "Hills of 5 % of Sz and more, as a table"},
                    {"fettle features scan.tif --kind dales --prune 10 --s-filter 2.5 --labels dales.tif "
                     "--edges dales.png",
                     "Deeper dales of the smoothed surface, which sample is of which, and their outlines"}});
}

}  // namespace fettle::app
