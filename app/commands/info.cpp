#include <cmath>
#include <cstdio>

#include <algorithm>
#include <memory>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/form_option.h"
#include "app/commands/output_checks.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/still_picture.h"
#include "app/terminal.h"
#include "app/work/form_figures.h"
#include "engine/field/seen_field.h"
#include "engine/fill/filled_samples.h"
#include "engine/inspect/histogram.h"
#include "engine/inspect/noise.h"
#include "engine/inspect/noise_model.h"
#include "engine/inspect/steepest.h"
#include "render/live/picture_rows.h"

namespace fettle::app {

namespace {

struct InfoArguments {
  std::vector<std::string> scans;
  ScanOptions reading;
  std::vector<std::string> at;
  std::string picture;
  int bins = 20;
};

// The shortest decimal that is read back as the same float: 9.792, where its exact value is 9.79199981689453.
double shortest(double height) {
  const auto stored = static_cast<float>(height);
  return std::isnan(height) ? height : std::stod(fmt::format("{}", stored));
}

Report figure(double value) {
  return std::isnan(value) ? Report() : Report(value);
}

// One bar per bin, the longest kLongest wide; a bin that is not empty shows at least a dot.
void printHistogram(const Report& histogram, const std::string& unit) {
  constexpr double kLongest = 50.0;
  const auto counts = histogram["counts"].get<std::vector<std::int64_t>>();
  if (std::isnan(histogram["low"].get<double>())) return;  // there is no height
  const std::int64_t most = *std::max_element(counts.begin(), counts.end());
  const auto all = static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}));
  const double low = histogram["low"], high = histogram["high"];
  fmt::print("histogram  from, {}\n", unit);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double share = static_cast<double>(counts[i]) / static_cast<double>(most);
    const auto length = static_cast<std::size_t>(std::lround(share * kLongest));
    const std::string bar = length == 0 && counts[i] > 0 ? "." : std::string(length, '#');
    const double from = low + (high - low) * static_cast<double>(i) / static_cast<double>(counts.size());
    fmt::print("{:>14.6g}  {:<51}{:>7.3f} %\n", from, bar, 100.0 * static_cast<double>(counts[i]) / all);
  }
}

// The text of a coordinate system takes pages; only its name is shown.
void printOne(Report report) {
  const Report histogram = report["histogram"];
  report.erase("histogram");
  if (report["crs"].is_string()) {
    const std::string wkt = report["crs"];
    const std::size_t open = wkt.find('"');
    if (open != std::string::npos) report["crs"] = wkt.substr(open + 1, wkt.find('"', open + 1) - open - 1);
  }
  if (report.contains("form_figures")) {
    report["form"] = fmt::format("{}, {}", report["form"].get<std::string>(),
                                 formFiguresText(report["form_figures"], report["unit"]));
    report.erase("form_figures");
  }
  printReport(report);
  printHistogram(histogram, report["unit"]);
}

void printInfo(const Report& report) {
  if (!report.contains("files")) return printOne(report);
  for (const Report& file : report["files"])
    if (file.contains("error"))
      fmt::print("{}  failed\n\n", file["in"].get<std::string>());
    else {
      printOne(file);
      fmt::print("\n");
    }
  fmt::print("{} read, {} failed\n", report["done"].get<std::size_t>(), report["failed"].get<std::size_t>());
}

// Position of a cell, counted as in the file: rows from the top.
engine::Result<Report> steepest(const engine::Version& field, engine::JobControl& job) {
  const auto cell = engine::findSteepest(field, job);
  if (!cell) return tl::unexpected(cell.error());
  if (std::isnan(cell->slope)) return Report();
  const engine::Grid& grid = field.grid();
  return Report{{"slope", cell->slope},
                {"degrees", std::atan(cell->slope) * 180.0 / std::numbers::pi},
                {"row", grid.height - 2 - cell->row},
                {"column", cell->column},
                {"x", grid.origin_x + (cell->column + 0.5) * grid.spacing_x},
                {"y", grid.origin_y + (cell->row + 0.5) * grid.spacing_y}};
}

// A thumbnail: only the surface and its colours.
engine::Status draw(const engine::Version& field, const std::string& path, engine::JobControl& job) {
  render::View view;
  view.width = 320;
  view.height = 240;
  render::FrameInput input = render::stillInput(view);
  input.decoration = render::Decoration::kNone;
  const auto picture = render::LivePicture::create();
  if (!picture) return tl::unexpected(picture.error());
  render::Shown shown;
  shown.versions = {field};
  const auto drawn = drawPicture(**picture, shown, input, path, job);
  if (!drawn) return tl::unexpected(drawn.error());
  return {};
}

engine::Result<Report> samplesAt(const engine::FieldReader& field, const std::vector<std::string>& places) {
  Report samples = Report::array();
  for (const std::string& place : places) {
    int row = 0;
    int column = 0;
    char rest = 0;
    if (std::sscanf(place.c_str(), "%d,%d%c", &row, &column, &rest) != 2 ||
        !field.grid().contains(column, row))
      return engine::inputError(
          fmt::format("{} is not a sample of {} rows and {} columns", place, field.height(), field.width()),
          "--at", "give ROW,COLUMN counted from 0");
    // Files count rows from the top, where y is highest.
    const float height = field.heightAt(column, field.height() - 1 - row);
    samples.push_back({{"row", row},
                       {"column", column},
                       {"height", std::isnan(height) ? Report() : Report(shortest(height))}});
  }
  return samples;
}

engine::Result<Report> infoOf(const InfoArguments& options, const std::string& scan,
                              engine::JobControl& job) {
  const auto imported = loadScan(scan, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const engine::Grid& grid = imported->field.grid();
  const engine::FieldSummary summary = engine::summarize(imported->field);
  auto samples = samplesAt(imported->field.reader(), options.at);
  if (!samples) return tl::unexpected(samples.error());
  const auto finest = engine::estimateNoise(imported->field, job);
  if (!finest) return tl::unexpected(finest.error());
  const auto noise = engine::measureNoise(imported->field, job);
  if (!noise) return tl::unexpected(noise.error());
  const auto steep = steepest(imported->field, job);
  if (!steep) return tl::unexpected(steep.error());
  const auto histogram = engine::countHeights(imported->field, options.bins, job);
  if (!histogram) return tl::unexpected(histogram.error());
  if (!options.picture.empty())
    if (auto status = draw(imported->field, options.picture, job); !status)
      return tl::unexpected(status.error());

  Report report{
      {"width", grid.width},
      {"height", grid.height},
      {"spacing_x", grid.spacing_x},
      {"spacing_y", grid.spacing_y},
      {"spacing_unit", grid.lateral_unit.name},
      {"unit", grid.height_unit.name},
      {"origin_x", grid.origin_x},
      {"origin_y", grid.origin_y},
      {"min", shortest(summary.min)},
      {"max", shortest(summary.max)},
      {"mean", summary.mean},
      {"no_data", summary.no_data},
      {"no_data_share", static_cast<double>(summary.no_data) / static_cast<double>(grid.samples())},
      {"noise", figure(noise->sigma)},
      {"noise_uncorrelated", noise->uncorrelatedShare()},
      {"noise_rows", std::sqrt(noise->parts.row_offset)},
      {"noise_columns", std::sqrt(noise->parts.column_offset)},
      {"noise_least", figure(*std::ranges::min_element(noise->map))},
      {"noise_most", figure(*std::ranges::max_element(noise->map))},
      {"noise_windows", noise->windows},
      {"noise_finest", figure(finest->sigma)},
      {"steepest", *steep},
      {"histogram",
       {{"low", shortest(histogram->low)},
        {"high", shortest(histogram->high)},
        {"counts", histogram->counts}}},
      {"hash", hashOf(imported->field)},
      {"format", imported->format},
      {"spacing_x_mm", grid.spacingXMm()},
      {"spacing_y_mm", grid.spacingYMm()},
      {"unit_mm", grid.height_unit.mm},
      {"crs", grid.crs_wkt.empty() ? Report() : Report(grid.crs_wkt)},
      {"warnings", imported->warnings},
  };
  if (imported->gridding)
    report["gridding"] = {{"points", imported->gridding->points},
                          {"cells", imported->gridding->cells},
                          {"empty_cells", imported->gridding->empty_cells},
                          {"multiple_cells", imported->gridding->multiple_cells},
                          {"lattice", imported->gridding->lattice}};
  if (imported->original) report["filled"] = engine::countFilled(imported->field, *imported->original);
  if (const auto* formed = imported->field.seenOf(); formed != nullptr)
    report["form"] = formWordOf(*formed->form());
  if (const engine::FieldForm form = engine::formOfHeights(imported->field); form != nullptr) {
    report["form_figures"] = Report::object();
    addFormFigures(report["form_figures"], *form, grid);
  }
  if (imported->field.lines() != nullptr) report["lines"] = imported->field.lines()->size();
  if (!options.at.empty()) report["at"] = *samples;
  if (!options.picture.empty()) report["picture"] = options.picture;
  return report;
}

engine::Result<Report> info(const InfoArguments& options, engine::JobControl& job) {
  if (auto status =
          checkOutputs({{options.picture, OutputKind::kPicture}}, options.scans, Replacing::kNoWork, job);
      !status)
    return tl::unexpected(status.error());
  if (options.scans.size() == 1) {
    const ProgressLine progress(job);
    return infoOf(options, options.scans.front(), job);
  }
  if (!options.picture.empty())
    return engine::inputError("one picture cannot show several scans", "--picture", "give one scan with it");
  std::vector<BatchTask> tasks;
  for (const std::string& scan : options.scans) tasks.push_back({scan, {}, {}});
  return runBatch(tasks, job,
                  [&](const BatchTask& task, engine::JobControl& j) { return infoOf(options, task.in, j); });
}

}  // namespace

void addInfo(Command root, Chosen& chosen) {
  auto options = std::make_shared<InfoArguments>();
  Command command = addCommand(
      root, chosen, "info",
      "Properties of a scan: size, spacing, units, heights, holes, noise, steepest cell",
      [options](engine::JobControl& job) { return info(*options, job); }, printInfo, Progress::kOwn,
      batchStatus);
  command.notes(
      "noise: standard deviation of the whole scan's in the height unit, in windows of 16 x 16 samples that "
      "show no edge.\n"
      "noise_uncorrelated: share of its square that neighbours do not have in common; noise_rows, "
      "noise_columns: offsets of whole rows and columns; noise_least, noise_most: where in the field it is "
      "least and most, in 8 x 8 parts. What is correlated along rows and columns counts as surface.\n"
      "noise_finest: that between samples, 1.4826 median(|d|) / 6 of d, the second difference along rows and "
      "columns; what range "
      "sigmas follow.\n"
      "steepest: the cell that rises most, height over distance; ROW,COLUMN of its upper left sample, and "
      "its middle in the file's coordinates.");
  command.add({
      {.name = "SCAN",
       .to = &options->scans,
       .text = "The scan, or several, each with a report of its own; - for standard input",
       .kind = ValueKind::kInput,
       .required = true},
      {.name = "--at",
       .to = &options->at,
       .text = "Also the height there, rows and columns of the file from 0",
       .shown = "ROW,COLUMN",
       .one_word = true},
      {.name = "--picture",
       .to = &options->picture,
       .text = "Also a thumbnail, PNG of 320 x 240 pixels",
       .kind = ValueKind::kNewFile},
      {.name = "--bins",
       .to = &options->bins,
       .text = "Bins of the histogram, from the lowest to the highest sample",
       .range = Range{1.0, engine::kMostBins}},
  });
  addScanOptions(command, options->reading);
  command.examples({{"fettle info scan.tif --picture scan.png", "Its properties, and a thumbnail"},
                    {"fettle info scan.tif --at 0,0 --at 10,20", "The heights of two samples as well"}});
}

}  // namespace fettle::app
