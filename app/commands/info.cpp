#include <cmath>
#include <cstdio>

#include <memory>

#include <fmt/format.h>

#include "app/command.h"
#include "app/scan_options.h"

namespace fettle::app {

namespace {

struct Options {
  std::string scan;
  ScanOptions reading;
  std::vector<std::string> at;
};

// The shortest decimal that reads back to the same float: 9.792, where its exact value is 9.79199981689453.
double shortest(double height) {
  const auto stored = static_cast<float>(height);
  return std::isnan(height) ? height : std::stod(fmt::format("{}", stored));
}

// A coordinate system's text runs to pages; people want its name.
void print(Report report) {
  if (report["crs"].is_string()) {
    const std::string wkt = report["crs"];
    const std::size_t open = wkt.find('"');
    if (open != std::string::npos) report["crs"] = wkt.substr(open + 1, wkt.find('"', open + 1) - open - 1);
  }
  printReport(report);
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

engine::Result<Report> info(const Options& options, engine::JobControl& job) {
  const auto imported = loadScan(options.scan, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const engine::Grid& grid = imported->field.grid();
  const engine::FieldSummary summary = engine::summarize(imported->field);
  auto samples = samplesAt(imported->field.reader(), options.at);
  if (!samples) return tl::unexpected(samples.error());

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
  if (!options.at.empty()) report["at"] = *samples;
  return report;
}

}  // namespace

void addInfo(CLI::App& root, Chosen& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command = addCommand(
      root, chosen, "info", "What a scan holds: size, spacing, units, heights, holes",
      [options](engine::JobControl& job) { return info(*options, job); }, print);
  command->add_option("SCAN", options->scan, "The scan")->required();
  command
      ->add_option("--at", options->at,
                   "Also the height at ROW,COLUMN of the file, both from 0; may be repeated")
      ->allow_extra_args(false);
  addScanOptions(command, options->reading);
}

}  // namespace fettle::app
