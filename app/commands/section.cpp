#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/vec2.hpp>

#include "app/commands/command.h"
#include "app/commands/output_checks.h"
#include "app/commands/plots/gnuplot.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/section_files.h"
#include "app/commands/section_options.h"
#include "app/commands/section_text.h"
#include "app/terminal.h"
#include "app/work/streams.h"
#include "engine/inspect/noise.h"
#include "engine/io/files/atomic_file.h"
#include "engine/measure/probe.h"
#include "engine/measure/roughness.h"
#include "engine/measure/section.h"
#include "engine/measure/section_figures.h"
#include "engine/uncertainty/roughness_noise.h"

namespace fettle::app {

namespace {

using engine::Estimate;
using engine::Section;
using engine::Stretch;

using Points = std::vector<glm::dvec2>;

// The lines along which sections are taken, in field coordinates [mm].
engine::Result<std::vector<Points>> pathsOf(const SectionArguments& options, const engine::Version& field,
                                            engine::JobControl& job) {
  std::vector<Points> paths;
  if (options.from.empty() != options.to.empty())
    return engine::inputError("a line needs two ends", options.from.empty() ? "--end" : "--start",
                              "give --start X,Y and --end X,Y");
  if (!options.from.empty())
    paths.push_back({{options.from[0], options.from[1]}, {options.to[0], options.to[1]}});
  for (const std::string& text : options.polylines) {
    auto points = polylineOf(text, "--line");
    if (!points) return tl::unexpected(points.error());
    paths.push_back(*std::move(points));
  }
  if (!options.lines.empty()) {
    const auto lines = readLines(options.lines, field, job);
    if (!lines) return tl::unexpected(lines.error());
    const glm::dvec2 spacing(field.grid().spacingXMm(), field.grid().spacingYMm());
    for (const engine::EdgeLine& line : *lines) {
      Points points;
      points.reserve(line.points.size() + 1);
      for (const engine::EdgePoint& point : line.points) points.push_back(point.position * spacing);
      if (line.closed && !points.empty()) points.push_back(points.front());
      if (points.size() > 1) paths.push_back(std::move(points));
    }
  }
  if (paths.empty() && options.probes.empty())
    return engine::inputError(
        "no line is given along which a section is taken", "--start",
        "give --start X,Y --end X,Y in mm from the lower left sample, --line, --lines or --probe");
  return paths;
}

Report number(double value) {
  return std::isnan(value) ? Report() : Report(value);
}

void addEstimate(Report& report, const std::string& key, const std::string& unit, const Estimate& estimate) {
  const std::string ending = unit.empty() ? std::string() : fmt::format("_{}", unit);
  report[key + ending] = number(estimate.value);
  report[key + "_error" + ending] = number(estimate.error);
}

Report reportOf(const engine::LineFigures& line) {
  Report report;
  addEstimate(report, "inclination", "deg", line.inclination_deg);
  addEstimate(report, "height", "mm", line.height_mm);
  report["rms_mm"] = line.rms_mm;
  report["places"] = line.places;
  return report;
}

Report stretchOf(const Stretch& stretch) {
  return Report::array({stretch.from_mm, stretch.to_mm});
}

void addMarks(const std::vector<double>& along, const char* name, std::vector<DrawnMark>& marks) {
  for (const double at : along) marks.push_back({at, name});
}

// What was asked for, of one section. `marks`: places that a picture shows.
class Figures {
  static constexpr int kRoughnessPairs = 32;  // of trials with noise

 public:
  Figures(const SectionArguments& options, double noise_mm) : options_(options), noise_mm_(noise_mm) {}

  engine::Result<Report> of(const Section& section, std::vector<DrawnMark>& marks) const {
    Report report = Report::object();
    const auto add = [&](const char* key, bool wanted, const auto& figures) -> engine::Status {
      if (!wanted) return {};
      auto made = figures();
      if (!made) return tl::unexpected(made.error());
      report[key] = *std::move(made);
      return {};
    };
    for (const engine::Status& status :
         {add("cursors", !options_.cursors.empty(), [&] { return cursors(section, marks); }),
          add("line", !options_.line.empty(), [&] { return line(section, marks); }),
          add("step", !options_.step.empty(), [&] { return step(section, marks); }),
          add("groove", !options_.groove.empty(), [&] { return groove(section, marks); }),
          add("angle", !options_.angle.empty(), [&] { return angle(section, marks); }),
          add("arc", !options_.arc.empty(), [&] { return arc(section, marks); }),
          add("roughness", options_.cutoff.has_value(), [&] { return roughness(section); })})
      if (!status) return tl::unexpected(status.error());
    return report;
  }

 private:
  // Whether an offset that was searched for is more than the largest that noise makes somewhere, and than what the
  // rounding of heights to float does.
  [[nodiscard]] static bool standsOut(const Section& section, const Estimate& offset) {
    double most = 0.0;
    for (const double z : section.height)
      if (!std::isnan(z)) most = std::max(most, std::abs(z));
    return std::abs(offset.value) > std::max(5.0 * offset.error, 1e-6 * most);
  }

  [[nodiscard]] Stretch within(const Section& section) const {
    return options_.within.empty() ? Stretch{0.0, section.lengthMm()}
                                   : Stretch{options_.within[0], options_.within[1]};
  }

  engine::Result<Report> cursors(const Section& section, std::vector<DrawnMark>& marks) const {
    const auto figures = engine::cursorFigures(section, options_.cursors[0], options_.cursors[1], noise_mm_);
    if (!figures) return tl::unexpected(figures.error());
    addMarks(options_.cursors, "cursor", marks);
    Report report{{"dx_mm", figures->dx_mm}};
    addEstimate(report, "dz", "mm", figures->dz_mm);
    report.update({{"slope_deg", number(figures->slope_deg)},
                   {"distance_mm", figures->distance_mm},
                   {"first_mm", figures->first_mm},
                   {"second_mm", figures->second_mm}});
    return report;
  }
  engine::Result<Report> line(const Section& section, std::vector<DrawnMark>& marks) const {
    const auto figures = engine::lineFigures(section, {options_.line[0], options_.line[1]}, noise_mm_);
    if (!figures) return tl::unexpected(figures.error());
    addMarks(options_.line, "line", marks);
    return reportOf(*figures);
  }
  engine::Result<Report> step(const Section& section, std::vector<DrawnMark>& marks) const {
    double edge = engine::edgeIn(section, within(section));
    if (options_.step != "auto") edge = numbersOf(options_.step, 1).front();
    if (std::isnan(edge))
      return engine::inputError("the section has too few heights for a step", "--step", "give a longer line");
    const auto figures = engine::stepFigures(section, edge, within(section), noise_mm_);
    if (!figures) return tl::unexpected(figures.error());
    if (options_.step == "auto" && !standsOut(section, figures->step_mm))
      return engine::inputError("no step stands out from the noise of the section", "--step",
                                "average over a --width, or give the edge's length");
    addMarks({edge}, "step", marks);
    Report report{{"edge_mm", edge}};
    addEstimate(report, "step", "mm", figures->step_mm);
    addEstimate(report, "inclination", "deg", figures->inclination_deg);
    report.update({{"before", stretchOf(figures->before)},
                   {"after", stretchOf(figures->edge_after)},
                   {"rms_mm", figures->rms_mm},
                   {"places", figures->places}});
    return report;
  }
  engine::Result<Report> groove(const Section& section, std::vector<DrawnMark>& marks) const {
    Stretch edges = engine::grooveIn(section, within(section));
    if (options_.groove != "auto") {
      const std::vector<double> typed = numbersOf(options_.groove, 2);
      edges = {typed[0], typed[1]};
    }
    if (std::isnan(edges.from_mm))
      return engine::inputError("no groove or ridge stands out in the section", "--groove",
                                "give a longer line, or the lengths of both edges");
    const auto figures = engine::grooveFigures(section, edges.from_mm, edges.to_mm, noise_mm_);
    if (!figures) return tl::unexpected(figures.error());
    if (options_.groove == "auto" && !standsOut(section, figures->step_mm))
      return engine::inputError("no groove or ridge stands out from the noise of the section", "--groove",
                                "average over a --width, or give the lengths of both edges");
    addMarks({edges.from_mm, edges.to_mm}, "groove", marks);
    Report report{{"edges", stretchOf(edges)}, {"width_mm", edges.to_mm - edges.from_mm}};
    addEstimate(report, "depth", "mm", figures->step_mm);
    addEstimate(report, "inclination", "deg", figures->inclination_deg);
    report.update({{"before", stretchOf(figures->before)},
                   {"inside", stretchOf(figures->edge_after)},
                   {"behind", stretchOf(figures->behind)},
                   {"rms_mm", figures->rms_mm},
                   {"places", figures->places}});
    return report;
  }
  engine::Result<Report> angle(const Section& section, std::vector<DrawnMark>& marks) const {
    const auto figures = engine::angleFigures(section, {options_.angle[0], options_.angle[1]},
                                              {options_.angle[2], options_.angle[3]}, noise_mm_);
    if (!figures) return tl::unexpected(figures.error());
    addMarks(options_.angle, "angle", marks);
    Report report;
    addEstimate(report, "turn", "deg", figures->turn_deg);
    report["included_deg"] = figures->included_deg.value;
    report["meet_along_mm"] = number(figures->meet_along_mm);
    report["meet_height_mm"] = number(figures->meet_height_mm);
    report["first"] = reportOf(figures->first);
    report["second"] = reportOf(figures->second);
    return report;
  }
  engine::Result<Report> arc(const Section& section, std::vector<DrawnMark>& marks) const {
    const auto figures = engine::arcFigures(section, {options_.arc[0], options_.arc[1]}, noise_mm_);
    if (!figures) return tl::unexpected(figures.error());
    addMarks(options_.arc, "arc", marks);
    Report report;
    addEstimate(report, "radius", "mm", figures->radius_mm);
    addEstimate(report, "centre_along", "mm", figures->centre_along_mm);
    addEstimate(report, "centre_height", "mm", figures->centre_height_mm);
    report.update({{"hollow", figures->hollow}, {"rms_mm", figures->rms_mm}, {"places", figures->places}});
    return report;
  }
  engine::Result<Report> roughness(const Section& section) const {
    const auto figures = engine::roughnessOf(section, within(section), *options_.cutoff);
    if (!figures) return tl::unexpected(figures.error());
    const auto noise = engine::roughnessNoise(section, within(section), *options_.cutoff, *figures, noise_mm_,
                                              {.pairs = kRoughnessPairs});
    if (!noise) return tl::unexpected(noise.error());
    Report report{{"cutoff_mm", *options_.cutoff},
                  {"evaluated", stretchOf(figures->evaluated)},
                  {"lengths", figures->lengths}};
    const auto add = [&report](const std::string& key, const char* unit, double value,
                               const engine::NoiseEffect& effect) {
      report[key + unit] = number(value);
      report[key + "_without" + unit] = number(effect.without);
      report[key + "_error" + unit] = number(effect.error);
    };
    add("ra", "_mm", figures->ra, noise->ra);
    add("rq", "_mm", figures->rq, noise->rq);
    add("rz", "_mm", figures->rz, noise->rz);
    add("rsk", "", figures->rsk, noise->rsk);
    add("rku", "", figures->rku, noise->rku);
    add("rsm", "_mm", figures->rsm, noise->rsm);
    return report;
  }

  const SectionArguments& options_;
  double noise_mm_;
};

struct ReadScan {
  engine::Version field;
  double noise_mm = 0.0;
};

engine::Result<ReadScan> readOne(const std::string& path, const SectionArguments& options,
                                 engine::JobControl& job) {
  const auto imported = loadScan(path, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  auto marked = withMarks(imported->field, options.marks, job);
  if (!marked) return tl::unexpected(marked.error());
  const auto noise = engine::estimateNoise(*marked, job);
  if (!noise) return tl::unexpected(noise.error());
  const double noise_mm = noise->sigma * marked->grid().height_unit.mm;
  return ReadScan{*std::move(marked), noise_mm};
}

engine::SectionOptions sectionOptionsOf(const SectionArguments& options) {
  engine::SectionOptions of;
  of.width_mm = options.width;
  of.region = options.region == "marked"     ? engine::Region::kMarked
              : options.region == "unmarked" ? engine::Region::kUnmarked
                                             : engine::Region::kAll;
  of.interpolation =
      options.interpolation == "nearest" ? engine::Interpolation::kNearest : engine::Interpolation::kBilinear;
  return of;
}

// How two sections differ at the places at which both have a height.
Report deviationOf(const Section& a, const Section& b) {
  double sum = 0.0, squares = 0.0, most = 0.0;
  int n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = b.height[i] - a.height[i];
    if (std::isnan(d)) continue;
    ++n;
    sum += d;
    squares += d * d;
    most = std::max(most, std::abs(d));
  }
  return {{"places", n},
          {"mean_mm", n > 0 ? Report(sum / n) : Report()},
          {"rms_mm", n > 0 ? Report(std::sqrt(squares / n)) : Report()},
          {"max_abs_mm", n > 0 ? Report(most) : Report()}};
}

Report describedSection(std::size_t index, const Section& section) {
  std::size_t found = 0, partial = 0;
  for (std::size_t i = 0; i < section.size(); ++i)
    if (!std::isnan(section.height[i]) && section.share[i] < 1.0) ++partial;
  double low = 0.0, high = 0.0;
  for (const double z : section.height)
    if (!std::isnan(z)) {
      low = found == 0 ? z : std::min(low, z);
      high = found == 0 ? z : std::max(high, z);
      ++found;
    }
  const auto pointOf = [](const glm::dvec2& p) { return Report::array({p.x, p.y}); };
  return {{"section", index},
          {"from", pointOf(section.position.front())},
          {"to", pointOf(section.position.back())},
          {"length_mm", section.lengthMm()},
          {"spacing_mm", section.step_mm},
          {"places", section.size()},
          {"without_height", section.size() - found},
          {"partial", partial},
          {"lanes", section.lanes},
          {"low_mm", low},
          {"high_mm", high}};
}

engine::Result<Report> probed(const SectionArguments& options, const ReadScan& scan) {
  Report report = Report::array();
  const engine::Grid& grid = scan.field.grid();
  const double radius = options.probe_radius.value_or(5.0 * std::max(grid.spacingXMm(), grid.spacingYMm()));
  for (const std::string& text : options.probes) {
    const std::vector<double> at = numbersOf(text, 2);
    const auto figures =
        engine::probeAt(scan.field, {at[0], at[1]}, radius, sectionOptionsOf(options).region, scan.noise_mm);
    if (!figures) return tl::unexpected(figures.error());
    Report one{{"x", at[0]}, {"y", at[1]}, {"radius_mm", radius}};
    addEstimate(one, "height", "mm", figures->height_mm);
    addEstimate(one, "slope", "deg", figures->slope_deg);
    one["rises_to_deg"] = number(figures->rises_to_deg);
    one["most_curvature"] = figures->most_curvature;
    one["least_curvature"] = figures->least_curvature;
    addEstimate(one, "mean_curvature", "", figures->mean_curvature);
    one["rms_mm"] = figures->rms_mm;
    one["samples"] = figures->samples;
    report.push_back(std::move(one));
  }
  return report;
}

engine::Status writeSectionFiles(const SectionArguments& options, const std::vector<DrawnSection>& drawn,
                                 engine::JobControl& job) {
  // The picture first: a program of its own makes it, which can fail where writing a text does not.
  if (!options.plot.empty())
    if (auto status = drawSections(drawn, options.plot); !status) return status;
  if (!options.csv.empty())
    if (auto status = writeTo(
            options.csv, ".csv", job,
            [&](const std::string& file) { return engine::writeFileAtomically(file, sectionCsv(drawn)); });
        !status)
      return status;
  return options.dxf.empty() ? engine::Status() : engine::writeFileAtomically(options.dxf, sectionDxf(drawn));
}

engine::Result<Report> takeSections(const SectionArguments& options, engine::JobControl& job) {
  if (auto status = checkSectionWords(options); !status) return tl::unexpected(status.error());
  if (auto status =
          checkOutputs({{options.csv, OutputKind::kText, ".csv"},
                        {options.plot, OutputKind::kPlot},
                        {options.dxf, OutputKind::kDrawing}},
                       {options.scan, options.compare, options.lines, options.marks}, options.replacing, job);
      !status)
    return tl::unexpected(status.error());
  const auto scan = readOne(options.scan, options, job);
  if (!scan) return tl::unexpected(scan.error());
  const auto paths = pathsOf(options, scan->field, job);
  if (!paths) return tl::unexpected(paths.error());
  std::vector<ReadScan> others;
  if (!options.compare.empty()) {
    auto other = readOne(options.compare, options, job);
    if (!other) return tl::unexpected(other.error());
    // What a filter has made smooth still has the noise of before in what is averaged over more than its window.
    other->noise_mm = std::fmax(other->noise_mm, scan->noise_mm);
    others.push_back(*std::move(other));
  }
  Report report{{"noise_mm", number(scan->noise_mm)}, {"sections", Report::array()}};
  std::vector<DrawnSection> drawn;
  drawn.reserve(paths->size());
  const engine::SectionOptions of = sectionOptionsOf(options);
  for (std::size_t i = 0; i < paths->size(); ++i) {
    auto section = engine::sectionAlong(scan->field, (*paths)[i], of, job);
    if (!section) return tl::unexpected(section.error());
    drawn.push_back({fmt::format("section {}", i), *std::move(section), {}, {}, {}});
    DrawnSection& last = drawn.back();
    Report one = describedSection(i, last.section);
    auto figures = Figures(options, scan->noise_mm).of(last.section, last.marks);
    if (figures) {
      one.update(*figures);
    } else {
      // Of several sections one may be too short for what others show.
      if (paths->size() == 1) return tl::unexpected(figures.error());
      warn(fmt::format("section {}: {}", i, figures.error().line()));
    }
    for (const ReadScan& other : others) {
      auto beside = engine::sectionAlong(other.field, (*paths)[i], of, job);
      if (!beside) {
        engine::Error error = beside.error();
        error.where = shownInput(options.compare);
        return tl::unexpected(std::move(error));
      }
      last.other = *std::move(beside);
      if (last.other.size() != last.section.size())
        return engine::inputError("both scans must have the same spacing", "--compare",
                                  "fettle convert gives one the other's grid");
      one["deviation"] = deviationOf(last.section, last.other);
      std::vector<DrawnMark> unused;
      auto of_other = Figures(options, other.noise_mm).of(last.other, unused);
      if (of_other)
        one["other"] = *std::move(of_other);
      else
        warn(fmt::format("{}, section {}: {}", shownInput(options.compare), i, of_other.error().line()));
    }
    report["sections"].push_back(std::move(one));
  }
  if (!options.probes.empty()) {
    auto probes = probed(options, *scan);
    if (!probes) return tl::unexpected(probes.error());
    report["probes"] = *std::move(probes);
  }
  if (auto status = writeSectionFiles(options, drawn, job); !status) return tl::unexpected(status.error());
  return report;
}

}  // namespace

void addSection(Command root, Chosen& chosen) {
  auto options = std::make_shared<SectionArguments>();
  Command command = addCommand(
      root, chosen, "section", "Profiles along lines: step, groove, angle, radius, roughness, with errors",
      [options](engine::JobControl& job) { return takeSections(*options, job); }, printSections);
  command.add({{.name = "SCAN",
                .to = &options->scan,
                .text = "The scan, or a session; - for standard input",
                .kind = ValueKind::kInput,
                .required = true},
               {.name = "--csv",
                .to = &options->csv,
                .text = "Write a row per place: length, position, height, in mm",
                .kind = ValueKind::kOutput},
               {.name = "--plot",
                .to = &options->plot,
                .text = "Draw heights over lengths, .svg or .png",
                .kind = ValueKind::kNewFile},
               {.name = "--dxf",
                .to = &options->dxf,
                .text = "Write the profiles as polylines, length and height in mm",
                .kind = ValueKind::kNewFile}});
  addLineOptions(command, *options);
  addFigureOptions(command, *options);
  addForceOption(command, options->replacing);
  addScanOptions(command, options->reading);
  command.notes(
      "Positions count from the lower left sample, x to the right and y up the picture. The section is taken "
      "as the "
      "scan stands: fettle level takes a tilt out first.\n"
      "Standard errors are those that the noise of single samples gives. Of noise that neighbours share, as "
      "in filtered "
      "scans, they are too small; those of --compare's scan are by the greater noise of both. Step: the "
      "third of the width next to the edge does not count, as beside a groove in "
      "ISO 5436-1; the height is measured across the two parallel lines.");
  command.examples(
      {{"fettle section scan.tif --start 1,2 --end 9,2 --width 0.2 --step 5 --plot step.svg",
        "Step height 5 mm along a line, and a picture"},
       {"fettle section scan.tif --compare clean.tif --start 1,2 --end 9,2 --cursors 3,5 --csv profile.csv",
        "Before and after, and the heights as a table"},
       {"fettle section scan.tif --line 1,1:4,5:9,5 --cutoff 2.5", "Roughness along a polyline"}});
}

}  // namespace fettle::app
