#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "app/commands/command.h"
#include "app/commands/output_checks.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/plots/gnuplot.h"
#include "app/work/streams.h"
#include "engine/base/error.h"
#include "engine/edges/edge_profile.h"
#include "engine/field/grid.h"
#include "engine/inspect/noise.h"
#include "engine/inspect/noise_model.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/lines/lines.h"

namespace fettle::app {

namespace {

// A line and what was measured along it.
struct MeasuredLine {
  engine::EdgeLine line;
  std::vector<engine::EdgeSection> sections;  // one per point
  engine::EdgeMeans means;
  double length_mm = 0.0;  // of a closed line all around

  MeasuredLine(engine::EdgeLine from, std::vector<engine::EdgeSection> at, const engine::EdgeMeans& mean,
               const engine::Grid& grid)
      : line(std::move(from)), sections(std::move(at)), means(mean) {
    if (sections.empty()) return;
    length_mm = sections.back().along_mm;
    const glm::dvec2 spacing(grid.spacingXMm(), grid.spacingYMm());
    if (line.closed)
      length_mm += glm::length((sections.front().position - sections.back().position) * spacing);
  }
};

// A blank row ends a stretch of measured points: gnuplot connects nothing over it.
std::string rowsOf(const MeasuredLine& line) {
  std::string rows;
  for (const engine::EdgeSection& s : line.sections) {
    if (s.measured)
      fmt::format_to(std::back_inserter(rows), "{:.6g} {:.6g} {:.6g} {:.6g} {:.6g}\n", s.along_mm, s.step,
                     s.step_deviation, s.turn, s.turn_deviation);
    else
      rows += "\n";
  }
  return rows;
}

std::string panel(const std::vector<const MeasuredLine*>& lines, int value, const std::string& title) {
  std::string bands, curves;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const char* colour = kPlotColours[i % std::size(kPlotColours)];
    bands += fmt::format(
        "{0}$line{1} using 1:(${2}-${3}):(${2}+${3}) with filledcurves fc rgb '{4}' fs transparent "
        "solid 0.25 noborder notitle",
        i == 0 ? "plot " : ", ", i, value, value + 1, colour);
    curves += fmt::format(", $line{} using 1:{} with lines lc rgb '{}' lw 1.5 title {}", i, value, colour,
                          quoted(fmt::format("line {}", lines[i]->line.id)));
  }
  return fmt::format("set ylabel {}\n", quoted(title)) + bands + curves + "\n";
}

// An SVG of step height and turn over the length of the longest lines, each with a band of its standard deviation.
// Heights in `unit`. Errors (kFailed): as drawnByGnuplot.
engine::Result<std::string> edgePlot(const std::vector<MeasuredLine>& lines, const engine::LengthUnit& unit) {
  std::vector<const MeasuredLine*> longest;
  for (const MeasuredLine& line : lines)
    if (line.means.measured > 1) longest.push_back(&line);
  if (longest.empty())
    return engine::inputError("no line could be measured, so there is nothing to draw", "--plot",
                              "leave it out, the table says what was found");
  std::ranges::stable_sort(longest, std::greater(), &MeasuredLine::length_mm);
  longest.resize(std::min(longest.size(), std::size(kPlotColours)));
  std::string script = kPlotHead;
  for (std::size_t i = 0; i < longest.size(); ++i)
    script += fmt::format("$line{} << EOD\n{}EOD\n", i, rowsOf(*longest[i]));
  script += "set multiplot layout 2,1\nset xlabel 'length along the line [mm]'\n";
  script += panel(longest, 2, fmt::format("step [{}]", unit.name)) + panel(longest, 4, "turn [degrees]");
  return drawnByGnuplot(script + "unset multiplot\n");
}

struct LinesArguments {
  std::string scan;
  std::string lines;
  std::vector<std::string> only;
  std::string out;
  std::string csv;
  std::string plot;
  ScanOptions reading;
};

// The lines of a file, else those of the scan itself, which a session has.
engine::Result<std::vector<engine::EdgeLine>> linesOf(const LinesArguments& options,
                                                      const engine::Version& field, engine::JobControl& job) {
  std::vector<engine::EdgeLine> lines;
  if (!options.lines.empty()) {
    auto read = readLines(options.lines, field, job);
    if (!read) return read;
    lines = *std::move(read);
  } else if (field.lines() != nullptr) {
    lines = *field.lines();
  } else {
    return engine::inputError("it has no edge lines", shownInput(options.scan),
                              "give LINES, or a session in which edges were drawn");
  }
  return lines;
}

// The others were measured, too: they end the surfaces of their neighbours.
engine::Status keepOnly(const std::vector<std::string>& wanted, std::vector<MeasuredLine>& lines) {
  std::set<std::int64_t> ids;
  for (const std::string& text : wanted) {
    std::int64_t id = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
    if (error != std::errc() || end != text.data() + text.size() ||
        std::ranges::none_of(lines, [id](const MeasuredLine& line) { return line.line.id == id; }))
      return engine::inputError(fmt::format("there is no line {}", text), "--only",
                                "fettle lines without it lists them");
    ids.insert(id);
  }
  if (!ids.empty())
    std::erase_if(lines, [&](const MeasuredLine& line) { return !ids.contains(line.line.id); });
  return {};
}

Report reportOf(const MeasuredLine& line) {
  const engine::EdgeMeans& means = line.means;
  const auto points = line.line.points.size();
  const auto located = std::ranges::count_if(line.line.points, &engine::EdgePoint::located);
  double squares = 0.0;
  for (const engine::EdgePoint& point : line.line.points) squares += point.deviation * point.deviation;
  Report report{
      {"line", line.line.id},
      {"closed", line.line.closed},
      {"points", points},
      {"located", static_cast<double>(located) / static_cast<double>(std::max<std::size_t>(points, 1))},
      {"length_mm", line.length_mm},
      {"deviation", located > 0 ? Report(std::sqrt(squares / static_cast<double>(located))) : Report()},
      {"measured", means.measured}};
  const auto add = [&](const char* key, double value) {
    report[key] = means.measured > 0 ? Report(value) : Report();
  };
  add("step", means.step);
  add("step_deviation", means.step_deviation);
  add("step_low", means.step_low);
  add("step_high", means.step_high);
  add("turn_deg", means.turn);
  add("turn_deviation_deg", means.turn_deviation);
  add("turn_low_deg", means.turn_low);
  add("turn_high_deg", means.turn_high);
  return report;
}

// One row per point, in field coordinates as strokes files have them. Cells of points that are not measured are empty.
std::string csvOf(const std::vector<MeasuredLine>& lines, const engine::Grid& grid) {
  const double mm = grid.height_unit.mm;
  std::string text = "line,along_mm,x_mm,y_mm,step_mm,step_deviation_mm,turn_deg,turn_deviation_deg\n";
  auto out = std::back_inserter(text);
  for (const MeasuredLine& line : lines)
    for (const engine::EdgeSection& s : line.sections) {
      fmt::format_to(out, "{},{:.9g},{:.9g},{:.9g},", line.line.id, s.along_mm,
                     s.position.x * grid.spacingXMm(), s.position.y * grid.spacingYMm());
      if (s.measured)
        fmt::format_to(out, "{:.9g},{:.3g},{:.9g},{:.3g}\n", s.step * mm, s.step_deviation * mm, s.turn,
                       s.turn_deviation);
      else
        text += ",,,\n";
    }
  return text;
}

engine::Status writeFiles(const LinesArguments& options, const std::vector<MeasuredLine>& measured,
                          const engine::Grid& grid, engine::JobControl& job) {
  // What may fail comes before what is written.
  std::string svg;
  if (!options.plot.empty()) {
    auto drawn = edgePlot(measured, grid.height_unit);
    if (!drawn) return tl::unexpected(drawn.error());
    svg = *std::move(drawn);
  }
  if (!options.out.empty()) {
    std::vector<engine::EdgeLine> lines;
    lines.reserve(measured.size());
    for (const MeasuredLine& line : measured) lines.push_back(line.line);
    if (auto status = saveLines(lines, grid, options.out, job); !status) return status;
  }
  if (!options.csv.empty())
    if (auto status = writeTo(options.csv, kLinesStream, job,
                              [&](const std::string& file) {
                                return engine::writeFileAtomically(file, csvOf(measured, grid));
                              });
        !status)
      return status;
  return options.plot.empty() ? engine::Status() : engine::writeFileAtomically(options.plot, svg);
}

engine::Result<Report> measureLines(const LinesArguments& options, engine::JobControl& job) {
  if (auto status = checkOutputs({{options.out, OutputKind::kLines, kLinesStream},
                                  {options.csv, OutputKind::kText, kLinesStream},
                                  {options.plot, OutputKind::kPlot}},
                                 {options.scan, options.lines}, Replacing::kNoWork, job);
      !status)
    return tl::unexpected(status.error());
  if (!options.plot.empty())
    if (auto status = plotsCanBeMade(); !status) return tl::unexpected(status.error());
  const auto imported = loadScan(options.scan, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const engine::Version& field = imported->field;
  const auto lines = linesOf(options, field, job);
  if (!lines) return tl::unexpected(lines.error());
  const auto noise = engine::estimateNoise(field, job);
  if (!noise) return tl::unexpected(noise.error());
  const auto shared = engine::measureNoise(field, job);
  if (!shared) return tl::unexpected(shared.error());
  // A field without any has no window to measure it in. Offsets of lines are those of windows as well as of whole lines (`parts` has
  // both): a section of an edge is no longer than a window, so that what a line is off over a piece of it counts as much.
  auto edges = engine::measureEdges(field,
                                    {.sigma = std::isnan(noise->sigma) ? 0.0 : noise->sigma,
                                     .rows = std::sqrt(shared->parts.row_offset),
                                     .columns = std::sqrt(shared->parts.column_offset)},
                                    *lines, job);
  if (!edges) return tl::unexpected(edges.error());
  std::vector<MeasuredLine> measured;
  for (std::size_t i = 0; i < lines->size(); ++i) {
    engine::MeasuredEdge& edge = (*edges)[i];
    measured.emplace_back((*lines)[i], std::move(edge.sections), edge.means, field.grid());
  }
  if (auto status = keepOnly(options.only, measured); !status) return tl::unexpected(status.error());
  if (auto status = writeFiles(options, measured, field.grid(), job); !status)
    return tl::unexpected(status.error());
  Report report{{"unit", field.grid().height_unit.name},
                {"noise", std::isnan(noise->sigma) ? Report() : Report(noise->sigma)},
                {"lines", Report::array()}};
  for (const MeasuredLine& line : measured) report["lines"].push_back(reportOf(line));
  return report;
}

void printLines(const Report& report) {
  if (!report["noise"].is_null())
    fmt::print("noise {:.4g} {}; ", report["noise"].get<double>(), report["unit"].get<std::string>());
  fmt::print(
      "step: left surface less right one; turn: above 0 concave; +- standard deviation, (lowest to "
      "highest)\n");
  fmt::print("{:>6}{:>11}{:>8}{:>10}  {:<42}{:<20}\n", "line", "length mm", "found", "+- sample",
             fmt::format("step [{}]", report["unit"].get<std::string>()), "turn [degrees]");
  for (const Report& line : report["lines"]) {
    const auto number = [&line](const char* key) { return line[key].get<double>(); };
    const bool measured = line["measured"].get<int>() > 0;
    fmt::print(
        "{:>6}{:>11.4g}{:>6.0f} %{:>10}  {:<42}{:<20}\n", line["line"].get<std::int64_t>(),
        number("length_mm"), 100.0 * number("located"),
        line["deviation"].is_null() ? "-" : fmt::format("{:.2f}", number("deviation")),
        measured ? fmt::format("{:.5g} +- {:.2g} ({:.3g} to {:.3g})", number("step"),
                               number("step_deviation"), number("step_low"), number("step_high"))
                 : "-",
        measured ? fmt::format("{:.4g} +- {:.2g}", number("turn_deg"), number("turn_deviation_deg")) : "-");
  }
}

}  // namespace

void addLines(Command root, Chosen& chosen) {
  auto options = std::make_shared<LinesArguments>();
  Command command = addCommand(
      root, chosen, "lines", "Step height and angle along edge lines, with uncertainty",
      [options](engine::JobControl& job) { return measureLines(*options, job); }, printLines);
  command.add({
      {.name = "SCAN",
       .to = &options->scan,
       .text = "The scan, or a session; - for standard input",
       .kind = ValueKind::kInput,
       .required = true},
      {.name = "LINES",
       .to = &options->lines,
       .text = "File of edge lines",
       .kind = ValueKind::kLines,
       .otherwise = "those of the session SCAN"},
      {.name = "--only",
       .to = &options->only,
       .text = "Only the lines of these numbers",
       .shown = "N[,N...]",
       .between = ','},
      {.name = "--csv",
       .to = &options->csv,
       .text = "Write a row per point: step and angle there, in mm and degrees",
       .kind = ValueKind::kOutput},
      {.name = "--plot",
       .to = &options->plot,
       .text = "Draw step and angle over the length of the longest lines, as SVG",
       .kind = ValueKind::kNewFile},
      {.name = "--out",
       .to = &options->out,
       .text = "Write the lines: .csv (every value), .geojson, .gpkg, .dxf",
       .kind = ValueKind::kNewLines},
  });
  addScanOptions(command, options->reading);
  command.notes(
      "At each point of a line planes are fitted to the samples on both sides, up to 10 from the line and 5 "
      "points along. Step: their difference in height at the line. Turn: their difference in inclination "
      "across it. Standard deviations follow from the scan's noise, with what whole rows and columns are off "
      "together; next "
      "to rounded corners, whose sides are no planes, and of a filtered scan they are too small.");
  command.examples({{"fettle lines scan.tif lines.csv --csv steps.csv --plot steps.svg",
                     "A table, its values point by point, and a plot"}});
}

}  // namespace fettle::app
