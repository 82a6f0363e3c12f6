#include <cmath>

#include <filesystem>
#include <limits>
#include <memory>
#include <string_view>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/demo/demo.h"
#include "app/commands/typed_values.h"
#include "app/work/session_guard.h"
#include "engine/io/files/atomic_file.h"

namespace fettle::app {

namespace {

std::string csv(const DemoRun& run) {
  std::string text = "name,rmse_mm,rmse_flat_mm,rmse_edge_mm,edge_width_mm\n";
  for (const DemoResult& r : run.results)
    text += fmt::format("{},{:.6g},{:.6g},{:.6g},{:.6g}\n", r.name, r.figures.rmse, r.figures.rmse_flat,
                        r.figures.rmse_edge, r.figures.edge_width);
  return text;
}

const engine::TruthFigures& figures(const DemoRun& run, const std::string& name) {
  for (const DemoResult& r : run.results)
    if (r.name == name) return r.figures;
  return run.results.front().figures;
}

// The state after an early end: complete files, as stated in the error, or no folder that did not exist
// before.
engine::Error ended(engine::Error error, const DemoOptions& options, bool made) {
  std::error_code ignored;
  const bool empty = std::filesystem::is_empty(options.folder, ignored);
  if (empty && made) std::filesystem::remove(options.folder, ignored);
  if (error.kind == engine::ErrorKind::kCancelled && !empty) {
    error.where = options.folder;
    error.remedy = "each file in it is complete, the others are missing: run it again";
  }
  return error;
}

engine::Result<Report> demo(const DemoOptions& options, engine::JobControl& job) {
  if (auto status = engine::validate(demoFilter(engine::FilterKind::kBox, options)); !status)
    return tl::unexpected(status.error());
  for (const double at : options.look_at)
    if (!(at >= 0.0 && at <= 1.0))
      return engine::inputError(fmt::format("{} is not a position in the field", at), "--look-at",
                                "give fractions from 0 to 1");
  std::error_code error;
  const bool made = std::filesystem::create_directories(options.folder, error);
  if (error)
    return engine::inputError(fmt::format("the folder cannot be created: {}", error.message()),
                              options.folder, "name a folder with write permission");
  ScanGuard guard;
  for (std::filesystem::directory_iterator it(options.folder, error), end; !error && it != end;
       it.increment(error))
    if (auto status = guard.protectSessions(it->path().string(), job); !status)
      return tl::unexpected(status.error());
  const auto run = runDemo(options, job);
  if (!run) return tl::unexpected(ended(run.error(), options, made));
  const std::string table_file = (std::filesystem::path(options.folder) / "table.csv").string();
  if (auto status = engine::writeFileAtomically(table_file, csv(*run)); !status)
    return tl::unexpected(status.error());
  const auto pictures = drawDemo(*run, options, job);
  if (!pictures) return tl::unexpected(ended(pictures.error(), options, made));

  Report report{{"folder", options.folder},      {"width", options.side},
                {"height", options.side},        {"window", options.window},
                {"passes", options.passes},      {"seed", options.seed},
                {"ticks", run->strokes.ticks},   {"ticks_per_second", run->strokes.ticks_per_second},
                {"marked", run->strokes.marked}, {"table", Report::array()},
                {"edge_gain", Report::object()}, {"pictures", *pictures}};
  for (const DemoResult& r : run->results)
    report["table"].push_back({{"name", r.name},
                               {"title", r.title},
                               {"rmse", r.figures.rmse},
                               {"rmse_flat", r.figures.rmse_flat},
                               {"rmse_edge", r.figures.rmse_edge},
                               {"edge_width", r.figures.edge_width}});
  for (const engine::FilterKind kind : engine::plainFilters()) {
    const std::string filter(engine::name(kind));
    report["edge_gain"][filter] = figures(*run, filter).rmse_edge / figures(*run, "heg-" + filter).rmse_edge;
  }
  return report;
}

void printDemo(const Report& report) {
  const auto number = [](const Report& value) {
    return value.is_null() || std::isnan(value.get<double>()) ? std::string("-")
                                                              : fmt::format("{:.4f}", value.get<double>());
  };
  fmt::print("{:<24}{:>12}{:>12}{:>12}{:>12}\n", "", "RMSE", "RMSE flat", "RMSE edge", "edge width");
  fmt::print("{:<24}{:>12}{:>12}{:>12}{:>12}\n", "", "mm", "mm", "mm", "mm");
  for (const Report& row : report["table"])
    fmt::print("{:<24}{:>12}{:>12}{:>12}{:>12}\n", row["title"].get<std::string>(), number(row["rmse"]),
               number(row["rmse_flat"]), number(row["rmse_edge"]), number(row["edge_width"]));
  for (const auto& [filter, gain] : report["edge_gain"].items())
    fmt::print("{}: near edges HEG is {:.1f} times nearer the truth than the filter alone\n", filter,
               gain.get<double>());
  const auto near_edges = [&report](std::string_view name) {
    for (const Report& row : report["table"])
      if (row["name"].get<std::string>() == name && row["rmse_edge"].is_number())
        return row["rmse_edge"].get<double>();
    return std::numeric_limits<double>::quiet_NaN();
  };
  // A hand is compared with the best filter without one, too. Within a hundredth there is no difference.
  if (const double left = near_edges("tgv-hand") / near_edges("tgv"); !std::isnan(left))
    fmt::print("tgv: near edges the lines of the hand leave {:.2f} times the error of the filter alone{}\n",
               left, left > 0.99 ? ": here a hand gains nothing" : "");
  fmt::print("\nPictures, fields, strokes, scene and marks: {}\n", report["folder"].get<std::string>());
  for (const Report& picture : report["pictures"]) fmt::print("  {}\n", picture.get<std::string>());
}

}  // namespace

void addDemo(Command root, Chosen& chosen) {
  auto options = std::make_shared<DemoOptions>();
  Command command = addCommand(
      root, chosen, "demo", "The whole process on a simulated scan: pictures, table, session",
      [options](engine::JobControl& job) { return demo(*options, job); }, printDemo);
  command.add({
      {.name = "DIR",
       .to = &options->folder,
       .text = "Folder for its output, created if missing",
       .kind = ValueKind::kFolder,
       .required = true},
      {.name = "--part", .to = &options->part, .text = "The part to scan", .words = partWords()},
      {.name = "--side",
       .to = &options->side,
       .text = "Length of each side",
       .range = Range{64.0, 16384.0},
       .unit = "samples"},
      {.name = "--noise", .to = &options->noise, .text = "Scale of the scanner's noise"},
      {.name = "--outliers", .to = &options->outliers, .text = "Share of mixed pixels next to steps"},
      {.name = "--dropouts", .to = &options->dropouts, .text = "Scale of lost samples"},
      {.name = "--window",
       .to = &options->window,
       .text = "Window of the global filters, odd",
       .unit = "samples"},
      {.name = "--passes", .to = &options->passes, .text = "Passes of the global filters"},
      {.name = "--look-at",
       .to = &options->look_at,
       .text = "Centre of the close-ups, as fractions of the field",
       .shown = "X,Y",
       .values = 2,
       .between = ','},
      {.name = "--seed", .to = &options->seed, .text = "Same seed, same bits", .problem = seedProblem},
  });
  command.examples({{"fettle demo out --side 256", "A small one, in the folder out"}});
}

}  // namespace fettle::app
