#include "app/commands/section_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "app/commands/typed_values.h"
#include "app/plots/gnuplot.h"
#include "app/work/interpolation_words.h"
#include "app/work/typed_lengths.h"
#include "engine/measure/roughness.h"

namespace fettle::app {

namespace {

std::vector<Word> wordsOfInterpolation() {
  std::vector<Word> words;
  for (const InterpolationWord& known : interpolationWords()) words.emplace_back(known.word, known.text);
  return words;
}

std::vector<Word> wordsOfProfiles() {
  std::vector<Word> words;
  for (const engine::ProfileInfo& profile : engine::profileInfos())
    words.emplace_back(std::string(profile.word), std::string(profile.text));
  for (const engine::ProfileInfo& profile : engine::profileInfos())
    words.emplace_back(std::string(1, profile.letter), fmt::format("the same as {}", profile.word));
  return words;
}

// Whether the profiles that are named fit to the cut-off.
engine::Status checkProfiles(const SectionArguments& options) {
  bool by_cutoff = options.profiles.empty();
  for (const std::string& word : options.profiles) {
    const engine::ProfileInfo* const profile = profileCalled(word);
    if (profile->by_cutoff && !options.cutoff)
      return engine::inputError(fmt::format("{} needs a cut-off", word), "--profile", "add --cutoff");
    by_cutoff = by_cutoff || profile->by_cutoff;
  }
  if (options.cutoff && !by_cutoff)
    return engine::inputError("an option would have no effect", "--cutoff",
                              "add roughness or waviness to --profile, or leave it out");
  return {};
}

constexpr const char* kLineGroup = "The line";
constexpr const char* kFigureGroup = "What is measured (lengths along the line, from its first point)";

// An option that would have no effect beside the others, and what it needs.
engine::Status checkEffects(const SectionArguments& options) {
  const auto needs = [](const char* option, const char* what) {
    return engine::inputError("an option would have no effect", option,
                              fmt::format("add {}, or leave it out", what));
  };
  const bool profiles = options.cutoff || !options.profiles.empty();
  if (!options.within.empty() && options.step.empty() && options.groove.empty() && !profiles)
    return needs("--within", "--step, --groove, --cutoff or --profile");
  if (options.lambda_s && !profiles) return needs("--lambda-s", "--cutoff or --profile");
  if (!options.at_heights.empty() && !profiles) return needs("--at-height", "--cutoff or --profile");
  if (!options.between.empty() && !profiles) return needs("--height-between", "--cutoff or --profile");
  if (auto status = checkProfiles(options); !status) return status;
  if (options.probe_radius && options.probes.empty()) return needs("--probe-radius", "--probe");
  if (!options.from.empty() || !options.to.empty() || !options.polylines.empty() || !options.lines.empty() ||
      options.kept)
    return {};
  for (const auto& [given, option] : {std::pair(options.width > 0.0, "--width"),
                                      {!options.compare.empty(), "--compare"},
                                      {!options.cursors.empty(), "--cursors"},
                                      {!options.line.empty(), "--fit-line"},
                                      {!options.step.empty(), "--step"},
                                      {!options.groove.empty(), "--groove"},
                                      {!options.angle.empty(), "--angle"},
                                      {!options.arc.empty(), "--arc"},
                                      {options.cutoff.has_value(), "--cutoff"},
                                      {!options.profiles.empty(), "--profile"},
                                      {!options.csv.empty(), "--csv"},
                                      {!options.plot.empty(), "--plot"},
                                      {!options.dxf.empty(), "--dxf"}})
    if (given && !options.probes.empty())
      return needs(option, "a line: --start and --end, --line or --lines");
  return {};
}

}  // namespace

engine::Result<engine::AskedRatios> askedRatiosOf(const SectionArguments& options) {
  engine::AskedRatios asked;
  asked.at_heights_mm.reserve(options.at_heights.size());
  for (const std::string& text : options.at_heights) {
    const auto height = parseSignedHeight(text, engine::Grid(), "--at-height");  // whose unit is mm
    if (!height)
      return engine::inputError(height.error().what, "--at-height",
                                "give numbers about the mean line in mm or with a unit, such as 0,-0.5um");
    asked.at_heights_mm.push_back(*height);
  }
  if (options.between.empty()) return asked;
  const double first = options.between[0], second = options.between[1];
  for (const double ratio : options.between)
    if (!(ratio >= 0.0 && ratio <= 100.0))
      return engine::inputError(fmt::format("{:.6g} is no material ratio", ratio), "--height-between",
                                "give 0 to 100, in per cent");
  if (!(first < second))
    return engine::inputError(fmt::format("the ratios {:.6g} and {:.6g} are not in order", first, second),
                              "--height-between", "give the smaller one first");
  asked.between.push_back({first / 100.0, second / 100.0});
  return asked;
}

engine::Status checkSectionWords(const SectionArguments& options) {
  if (auto status = checkEffects(options); !status) return status;
  if (!options.step.empty() && options.step != "auto" && lengthsOf(options.step, 1).empty())
    return engine::inputError(fmt::format("'{}' is no length", options.step), "--step",
                              "give the edge's length along the line in mm or as 0.5mm, or auto");
  if (!options.groove.empty() && options.groove != "auto" && lengthsOf(options.groove, 2).empty())
    return engine::inputError(
        fmt::format("'{}' is not two lengths", options.groove), "--groove",
        "give the lengths of both edges along the line, A,B, in mm or as 1mm,2.5mm, or auto");
  for (const std::string& probe : options.probes)
    if (lengthsOf(probe, 2).empty())
      return engine::inputError(fmt::format("'{}' is no point", probe), "--probe",
                                "give X,Y in mm, or as 12.5mm,3mm");
  for (const auto& [numbers, option] : {std::pair(&options.within, "--within"),
                                        {&options.line, "--fit-line"},
                                        {&options.angle, "--angle"},
                                        {&options.arc, "--arc"}})
    for (std::size_t i = 0; i + 1 < numbers->size(); i += 2)
      if (!((*numbers)[i] < (*numbers)[i + 1]))
        return engine::inputError(
            fmt::format("the stretch {:.6g},{:.6g} is not in order", (*numbers)[i], (*numbers)[i + 1]),
            option, "give the nearer end first");
  if (auto status = checkRegion(options); !status) return status;
  return options.plot.empty() ? engine::Status() : plotsCanBeMade();
}

void addLineOptions(Command command, SectionArguments& options) {
  command.add(
      {
          {.name = "--start",
           .to = &options.from,
           .text = "First point, from the lower left sample",
           .unit = "mm",
           .shown = "X,Y",
           .values = 2,
           .between = ','},
          {.name = "--end",
           .to = &options.to,
           .text = "Last point",
           .unit = "mm",
           .shown = "X,Y",
           .values = 2,
           .between = ','},
          {.name = "--line",
           .to = &options.polylines,
           .text = "A polyline; give it again for another section",
           .unit = "mm",
           .shown = "X,Y:X,Y[:...]",
           .one_word = true},
          {.name = "--lines",
           .to = &options.lines,
           .text = "A section along each line of a file, GeoJSON too",
           .kind = ValueKind::kLines},
          {.name = "--kept",
           .to = &options.kept,
           .text = "The sections that the window kept with a session, each with its width and what is "
                   "measured between its cursors"},
          {.name = "--width",
           .to = &options.width,
           .text = "Average across this width; 0: the line alone",
           .range = Range{0.0, 1e9},
           .unit = "mm"},
          {.name = "--interpolation",
           .to = &options.interpolation,
           .text = "Heights between samples",
           .words = wordsOfInterpolation()},
      },
      kLineGroup);
  addRegionOptions(command, options, "The samples that count; others are holes", kLineGroup);
  command.add({{.name = "--compare",
                .to = &options.compare,
                .text = "Another scan, sectioned and measured at the same places",
                .kind = ValueKind::kInput}},
              kLineGroup);
}

void addFigureOptions(Command command, SectionArguments& options) {
  command.add(
      {{.name = "--within",
        .to = &options.within,
        .text = "Stretch for --step, --groove, --cutoff and --profile",
        .unit = "mm",
        .shown = "A,B",
        .otherwise = "the whole line",
        .values = 2,
        .between = ','},
       {.name = "--cursors",
        .to = &options.cursors,
        .text = "Distance, height difference and slope between two places",
        .unit = "mm",
        .shown = "A,B",
        .values = 2,
        .between = ','},
       {.name = "--fit-line",
        .to = &options.line,
        .text = "Least-squares line of a stretch",
        .unit = "mm",
        .shown = "A,B",
        .values = 2,
        .between = ','},
       {.name = "--step",
        .to = &options.step,
        .text = "Step height at an edge; auto finds the edge",
        .unit = "mm",
        .shown = "A|auto"},
       {.name = "--groove",
        .to = &options.groove,
        .text = "Depth of a groove between two edges, ISO 5436-1; below 0 a ridge; auto finds them",
        .unit = "mm",
        .shown = "A,B|auto"},
       {.name = "--angle",
        .to = &options.angle,
        .text = "Angle between the lines of two stretches",
        .unit = "mm",
        .shown = "A,B,C,D",
        .values = 4,
        .between = ','},
       {.name = "--arc",
        .to = &options.arc,
        .text = "Radius of the circle of a stretch",
        .unit = "mm",
        .shown = "A,B",
        .values = 2,
        .between = ','},
       {.name = "--cutoff",
        .to = &options.cutoff,
        .text = "Ra, Rq, Rz, Rzx, Rp, Rv, Rt, Rc, RSm, Rsk, Rku, Rdq, Rk, Rpk, Rvk of ISO 21920-2 with this "
                "Gaussian cut-off",
        .range = Range{1e-9, 1e9},
        .unit = "mm"},
       {.name = "--profile",
        .to = &options.profiles,
        .text = "The profiles whose parameters are measured, named with R, P or W",
        .words = wordsOfProfiles(),
        .shown = "PROFILE[,PROFILE...]",
        .otherwise = "roughness with --cutoff",
        .between = ','},
       {.name = "--lambda-s",
        .to = &options.lambda_s,
        .text = "S-filter of --cutoff and --profile: waves shorter than this are taken out first, by a "
                "Gaussian too",
        .range = Range{1e-9, 1e9},
        .unit = "mm",
        .otherwise = "none"},
       {.name = "--at-height",
        .to = &options.at_heights,
        .text =
            "Heights about the mean line for the material ratio Rmr(c) of --cutoff and --profile, in mm or "
            "with a unit, below it with -: 0,-0.5um",
        .shown = "C[,C...]",
        .between = ','},
       {.name = "--height-between",
        .to = &options.between,
        .text = "Rdc of --cutoff and --profile, the height difference between two material ratios, in %",
        .shown = "P,Q",
        .values = 2,
        .between = ','},
       {.name = "--probe",
        .to = &options.probes,
        .text = "Height, slope and curvature around a point of the scan; give it again for another",
        .unit = "mm",
        .shown = "X,Y",
        .one_word = true},
       {.name = "--probe-radius",
        .to = &options.probe_radius,
        .text = "Samples this near to the point count",
        .range = Range{1e-9, 1e9},
        .unit = "mm",
        .otherwise = "5 samples"}},
      kFigureGroup);
}

}  // namespace fettle::app
