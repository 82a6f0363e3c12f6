#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
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
#include "app/commands/region_option.h"
#include "app/commands/rounding_warning.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/section_options.h"
#include "app/commands/section_text.h"
#include "app/plots/gnuplot.h"
#include "app/terminal.h"
#include "app/work/interpolation_words.h"
#include "app/work/kept_sections.h"
#include "app/work/layer_over.h"
#include "app/work/section_files.h"
#include "app/work/section_noise.h"
#include "app/work/section_report.h"
#include "app/work/streams.h"
#include "app/work/typed_lengths.h"
#include "engine/fill/filled_samples.h"
#include "engine/io/files/atomic_file.h"
#include "engine/measure/around.h"
#include "engine/measure/probe.h"
#include "engine/measure/roughness.h"
#include "engine/measure/section.h"

namespace fettle::app {

namespace {

using engine::Section;

using Points = std::vector<glm::dvec2>;

// A section that is to be taken, and what is measured in it.
struct PlannedSection {
  Points points;
  double width_mm = 0.0;
  SectionWants wants;
};

// The lines along which sections are taken, in field coordinates [mm].
engine::Result<std::vector<Points>> pathsOf(const SectionArguments& options, const engine::Version& field,
                                            bool kept, engine::JobControl& job) {
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
  if (paths.empty() && !kept && options.probes.empty())
    return engine::inputError(
        "no line is given along which a section is taken", "--start",
        "give --start X,Y --end X,Y in mm from the lower left sample, --line, --lines, --kept or --probe");
  return paths;
}

struct ReadScan {
  engine::Version field;
  engine::SectionNoise noise;
  std::string sections;                     // kept in the session
  std::optional<engine::Version> measured;  // without the samples that were filled, where there are any
};

engine::Result<ReadScan> readOne(const std::string& path, const SectionArguments& options,
                                 engine::JobControl& job) {
  const auto imported = loadScan(path, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  auto marked = countedOf(imported->field, imported->original, path, options, job);
  if (!marked) return tl::unexpected(marked.error());
  const auto noise = sectionNoiseOf(*marked, job);
  if (!noise) return tl::unexpected(noise.error());
  ReadScan scan{*std::move(marked), *noise, imported->sections, std::nullopt};
  if (imported->original && engine::countFilled(scan.field, *imported->original) > 0) {
    auto measured = engine::withoutFilled(scan.field, *imported->original, job);
    if (!measured) return tl::unexpected(measured.error());
    scan.measured = *std::move(measured);
  }
  return scan;
}

engine::SectionOptions sectionOptionsOf(const SectionArguments& options) {
  engine::SectionOptions of;
  of.width_mm = options.width;
  of.region = regionOf(options.region);
  of.interpolation = interpolationNamed(options.interpolation);
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

// Which places of a section have heights of samples that were filled: without these they have fewer lanes, or none.
engine::Result<std::vector<bool>> filledPlaces(const engine::Version& measured, const Points& points,
                                               const engine::SectionOptions& of, const Section& section,
                                               engine::JobControl& job) {
  const auto without = engine::sectionAlong(measured, points, of, job);
  if (!without && without.error().kind != engine::ErrorKind::kInput) return tl::unexpected(without.error());
  std::vector<bool> filled(section.size());
  for (std::size_t i = 0; i < section.size(); ++i)
    filled[i] = !std::isnan(section.height[i]) &&
                (!without || std::isnan(without->height[i]) || without->share[i] < section.share[i]);
  return filled;
}

engine::Result<Report> probed(const SectionArguments& options, const ReadScan& scan) {
  Report report = Report::array();
  const engine::Grid& grid = scan.field.grid();
  const double radius = options.probe_radius.value_or(engine::usualProbeRadiusMm(grid));
  for (const std::string& text : options.probes) {
    const std::vector<double> at = lengthsOf(text, 2);
    const auto figures =
        engine::probeAt(scan.field, {at[0], at[1]}, radius, sectionOptionsOf(options).region, scan.noise);
    if (!figures) return tl::unexpected(figures.error());
    Report one{{"x", at[0]}, {"y", at[1]}, {"radius_mm", radius}};
    addEstimate(one, "height", "mm", figures->height_mm);
    addEstimate(one, "slope", "deg", figures->slope_deg);
    one["rises_to_deg"] = numberOrNull(figures->rises_to_deg);
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
                                 const SectionTaking& taking, engine::JobControl& job) {
  // The picture first: a program of its own makes it, which can fail where writing a text does not.
  if (!options.plot.empty())
    if (auto status = drawSections(drawn, taking, options.plot); !status) return status;
  if (!options.csv.empty())
    if (auto status = writeTo(options.csv, ".csv", job,
                              [&](const std::string& file) {
                                return engine::writeFileAtomically(file, sectionCsv(drawn, taking));
                              });
        !status)
      return status;
  return options.dxf.empty() ? engine::Status() : engine::writeFileAtomically(options.dxf, sectionDxf(drawn));
}

// Those of the command line, and with --kept those of the session.
engine::Result<std::vector<PlannedSection>> plannedSections(const SectionArguments& options,
                                                            const engine::AskedRatios& asked,
                                                            const ReadScan& scan, engine::JobControl& job) {
  std::vector<PlannedSection> planned;
  if (options.kept) {
    engine::Result<std::vector<KeptSection>> kept;
    if (!scan.sections.empty()) kept = sectionsOf(scan.sections);
    if (!kept) return tl::unexpected(kept.error());
    if (kept->empty())
      return engine::inputError("no sections are kept in it", shownInput(options.scan),
                                "draw some in the window, Q and Shift+Q, and save a session");
    for (const KeptSection& section : *kept)
      planned.push_back({{section.from, section.to}, section.width_mm, wantsOf(section)});
  }
  auto paths = pathsOf(options, scan.field, !planned.empty(), job);
  if (!paths) return tl::unexpected(paths.error());
  SectionWants wants = static_cast<const SectionWants&>(options);
  wants.asked = asked;
  for (Points& points : *paths) planned.push_back({std::move(points), options.width, wants});
  return planned;
}

// The least rms that figures of sections have [mm]: of profiles about their mean line, of stretches about a line; infinite without one.
double leastRmsOf(const Report& sections) {
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&least](const Report& figures, const std::string& key) {
    if (figures.contains(key) && figures[key].is_number())
      least = std::min(least, figures[key].get<double>());
  };
  for (const Report& section : sections) {
    if (section.contains("line")) take(section["line"], "rms_mm");
    for (const engine::ProfileInfo& profile : engine::profileInfos())
      if (const std::string word(profile.word); section.contains(word))
        take(section[word], fmt::format("{}q_mm", word.front()));
  }
  return least;
}

engine::Result<Report> takeSections(const SectionArguments& options, engine::JobControl& job) {
  if (auto status = checkSectionWords(options); !status) return tl::unexpected(status.error());
  const auto asked = askedRatiosOf(options);
  if (!asked) return tl::unexpected(asked.error());
  if (auto status =
          checkOutputs({{options.csv, OutputKind::kText, ".csv"},
                        {options.plot, OutputKind::kPlot},
                        {options.dxf, OutputKind::kDrawing}},
                       {options.scan, options.compare, options.lines, options.marks}, options.replacing, job);
      !status)
    return tl::unexpected(status.error());
  const auto scan = readOne(options.scan, options, job);
  if (!scan) return tl::unexpected(scan.error());
  const auto planned = plannedSections(options, *asked, *scan, job);
  if (!planned) return tl::unexpected(planned.error());
  std::vector<ReadScan> others;
  if (!options.compare.empty()) {
    auto other = readOne(options.compare, options, job);
    if (!other) return tl::unexpected(other.error());
    other->noise = louderOf(other->noise, scan->noise);
    others.push_back(*std::move(other));
  }
  SectionTaking taking{sectionOptionsOf(options).interpolation, layerOver(scan->field), {}};
  Report report{{"noise_mm", numberOrNull(scan->noise.sample_mm)},
                {"noise_rows_mm", scan->noise.rows_mm},
                {"noise_columns_mm", scan->noise.columns_mm},
                {"interpolation", interpolationWord(taking.interpolation)},
                {"sections", Report::array()}};
  addLayer(report, scan->field);
  for (const ReadScan& other : others) {
    addLayer(report, other.field, kOtherLayerKey);
    taking.other_layer = layerOver(other.field);
  }
  std::vector<DrawnSection> drawn;
  drawn.reserve(planned->size());
  for (std::size_t i = 0; i < planned->size(); ++i) {
    const PlannedSection& plan = (*planned)[i];
    engine::SectionOptions of = sectionOptionsOf(options);
    of.width_mm = plan.width_mm;
    auto section = engine::sectionAlong(scan->field, plan.points, of, job);
    if (!section) return tl::unexpected(section.error());
    drawn.push_back({fmt::format("section {}", i), *std::move(section), {}, {}, {}});
    DrawnSection& last = drawn.back();
    Report one = describedSection(i, last.section);
    if (scan->measured) {
      auto filled = filledPlaces(*scan->measured, plan.points, of, last.section, job);
      if (!filled) return tl::unexpected(filled.error());
      one["filled"] = std::ranges::count(*filled, true);
      last.filled = *std::move(filled);
    }
    std::vector<FailedFigure> failed;
    Report figures = sectionFigures(plan.wants, last.section, scan->noise, last.marks, failed);
    // Of several sections, and of several figures, one may be undetermined where others are not.
    if (figures.empty() && !failed.empty() && planned->size() == 1 && !options.kept)
      return tl::unexpected(failed.front().error);
    for (const FailedFigure& each : failed)
      warn(fmt::format("section {}, {}: {}", i, each.key, each.error.line()));
    one.update(figures);
    for (const ReadScan& other : others) {
      auto beside = engine::sectionAlong(other.field, plan.points, of, job);
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
      std::vector<SectionMark> unused;
      failed.clear();
      one["other"] = sectionFigures(plan.wants, last.other, other.noise, unused, failed);
      for (const FailedFigure& each : failed)
        warn(fmt::format("{}, section {}, {}: {}", shownInput(options.compare), i, each.key,
                         each.error.line()));
    }
    report["sections"].push_back(std::move(one));
  }
  warnOfRounding({&scan->field}, leastRmsOf(report["sections"]) / scan->field.grid().height_unit.mm,
                 "the rms of a profile or of what a line leaves", shownInput(options.scan));
  if (!options.probes.empty()) {
    auto probes = probed(options, *scan);
    if (!probes) return tl::unexpected(probes.error());
    report["probes"] = *std::move(probes);
  }
  if (auto status = writeSectionFiles(options, drawn, taking, job); !status)
    return tl::unexpected(status.error());
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
      "Standard errors are those that the noise of single samples and of whole rows and columns gives, as "
      "the "
      "section goes along or across them. Of noise that neighbours share otherwise, as "
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
