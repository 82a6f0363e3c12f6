#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "app/commands/align_estimate.h"
#include "app/commands/align_option.h"
#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/output_checks.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/estimate_text.h"
#include "app/work/memory_places.h"
#include "app/work/mosaic_form.h"
#include "app/work/outputs.h"
#include "app/work/read_units.h"
#include "app/work/repeat_text.h"
#include "app/work/streams.h"
#include "engine/field/piece.h"
#include "engine/field/seen_field.h"
#include "engine/fill/filled_samples.h"
#include "engine/formats/formats.h"
#include "engine/mosaic/blended.h"
#include "engine/mosaic/join.h"
#include "engine/mosaic/overlap_motions.h"

namespace fettle::app {

namespace {

constexpr double kOverlap = 20.0, kMostOverlap = 90.0;  // percent

struct MosaicRun {
  std::vector<std::string> files;
  std::string layout;             // COLUMNSxROWS; empty: by the files' places, else searched for
  std::optional<double> overlap;  // of a side, with the layout [%]
  std::optional<double> within;
  std::string moves = "all";
  std::optional<double> rotation;
  std::string blend = "fade";
  Replacing replacing = Replacing::kNoWork;
  bool estimate = false;
  std::string to;
  ScanOptions reading;
  engine::ExportOptions writing;

  [[nodiscard]] std::vector<std::string> scans() const { return {files.begin(), files.end() - 1}; }
};

engine::Blend blendOf(const MosaicRun& options) {
  return options.blend == "mean"    ? engine::Blend::kMean
         : options.blend == "first" ? engine::Blend::kFirst
                                    : engine::Blend::kFade;
}

engine::Status checkMosaic(const MosaicRun& options, engine::JobControl& job) {
  if (options.files.size() < 3)
    return engine::inputError("a mosaic needs two scans and a file to write", "IN", "give IN IN OUT");
  if (options.overlap && options.layout.empty())
    return engine::inputError("places that files state have an overlap of their own", "--overlap",
                              "give --layout too, or leave it out");
  if (options.rotation && !movesOf(options.moves).rotation)
    return engine::inputError(fmt::format("'{}' does not rotate about z", options.moves), "--rotation",
                              "leave it out, or align by all or in-plane");
  return checkOutputs({{options.files.back(), OutputKind::kField, options.to}}, options.scans(),
                      options.replacing, job);
}

engine::Result<std::optional<std::vector<glm::dvec2>>> placesOf(const MosaicRun& options,
                                                                const std::vector<engine::Version>& scans) {
  if (options.layout.empty()) return engine::statedPlaces(scans);
  const auto layout = parseSize(options.layout, "--layout", {1, 1000});
  if (!layout) return tl::unexpected(layout.error());
  const auto [columns, rows] = *layout;
  if (static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) != scans.size())
    return engine::inputError(
        fmt::format("{} x {} places are not those of {} scans", columns, rows, scans.size()), "--layout",
        "give columns x rows");
  return std::optional(engine::placesInRows(scans, static_cast<std::size_t>(columns),
                                            options.overlap.value_or(kOverlap) / 100.0));
}

// What a mosaic has to do, in samples of the first scan.
struct MosaicSize {
  double aligned = 0.0;  // of all pairs, each as it is reduced
  double largest = 0.0;  // of one pair
  double made = 0.0;     // of the result
};

MosaicSize mosaicSizeOf(const std::vector<engine::Version>& scans,
                        const std::optional<std::vector<glm::dvec2>>& places, double play) {
  const engine::Grid& unit = scans[0].grid();
  const double cell = unit.spacingXMm() * unit.spacingYMm();
  const auto sides = [&](std::size_t k) {
    const engine::Grid& grid = scans[k].grid();
    return glm::dvec2(grid.width * grid.spacingXMm(), grid.height * grid.spacingYMm());
  };
  MosaicSize size;
  glm::dvec2 low(0.0), high(0.0);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const glm::dvec2 at = places ? (*places)[i] : glm::dvec2(0.0), end = at + sides(i);
    low = glm::min(low, at);
    high = glm::max(high, end);
    // Nobody knows how they lie: at most side by side.
    if (!places) size.made += sides(i).x * sides(i).y / cell;
    for (std::size_t j = i + 1; j < scans.size(); ++j) {
      glm::dvec2 both = glm::min(sides(i), sides(j));
      if (places) both = glm::min(end, (*places)[j] + sides(j)) - glm::max(at, (*places)[j]) + 2.0 * play;
      if (!(both.x > 2.0 * play && both.y > 2.0 * play)) continue;
      const double samples = std::min(kMostAligned, both.x * both.y / cell);
      size.aligned += samples;
      size.largest = std::max(size.largest, samples);
    }
  }
  if (places) size.made = (high.x - low.x) * (high.y - low.y) / cell;
  return size;
}

engine::Result<Foreseen> foreseeMosaic(const MosaicRun& options, const std::vector<engine::Version>& scans,
                                       const std::optional<std::vector<glm::dvec2>>& places,
                                       engine::JobControl& job) {
  const engine::Version& first = scans[0];
  const MosaicSize size = mosaicSizeOf(scans, places, options.within.value_or(engine::usualPlay(scans)));
  const auto samples = static_cast<double>(first.grid().samples());
  const auto pieceAt = [&](const engine::SampleRect& r) {
    return engine::pieceOf(first, r.column, r.row, r.columns, r.rows);
  };
  // Overlaps are alike enough to the first scan and the second.
  AlignArguments how;
  how.moves = options.moves;
  how.rotation = options.rotation;
  PlannedOnPieces aligning = plannedAlignment(first, scans[1], how);
  // As many times as long as the pairs have more samples.
  aligning.whole->seconds = [one = aligning.whole->seconds,
                             times = size.aligned / std::min(kMostAligned, samples)](
                                engine::JobControl& own) -> engine::Result<double> {
    const auto seconds = one(own);
    return seconds ? engine::Result<double>(*seconds * times) : seconds;
  };
  aligning.most_samples = 1e18;
  aligning.share = size.aligned / samples;
  aligning.memory_each *= size.largest / std::max(1.0, size.aligned);
  const PlannedOnPieces blending{
      .work =
          [&](const engine::SampleRect& r, engine::JobControl& own) {
            const engine::Version piece = pieceAt(r);
            engine::AdjustedPoses poses;
            poses.poses.resize(2);
            return engine::blendedScans({piece, piece}, poses, piece.grid(), blendOf(options), own);
          },
      .share = size.made / samples};
  const std::string& out = options.files.back();
  const PlannedWork planned{.field = first,
                            .original = first,
                            .steps = {aligning, blending},
                            .out = memoryPlace(out) == nullptr ? out : std::string(),
                            .extension = isStream(out) ? withDot(options.to) : engine::extensionOf(out),
                            .writing = options.writing,
                            .result = size.made / samples};
  return foresee(planned, shownOutput(out), options.estimate, job);
}

// Standard errors of what is not free, and of the first scan, are null.
Report scanReport(const std::string& path, const engine::AdjustedPoses& poses, std::size_t k,
                  const engine::AlignMoves& moves) {
  constexpr double kDegree = 180.0 / std::numbers::pi;
  const engine::RigidMotion& pose = poses.poses[k];
  const auto angles = pose.angles();
  const auto c = poses.between(0, k, pose.centre + pose.shift);
  const auto errorOf = [&](std::size_t place, bool free, double unit) {
    return k > 0 && free ? Report(unit * std::sqrt(std::max(0.0, c[place]))) : Report();
  };
  return {{"scan", path},
          {"shift_x_mm", pose.shift.x},
          {"shift_x_error_mm", errorOf(0, moves.shift, 1.0)},
          {"shift_y_mm", pose.shift.y},
          {"shift_y_error_mm", errorOf(7, moves.shift, 1.0)},
          {"shift_z_mm", pose.shift.z},
          {"shift_z_error_mm", errorOf(14, true, 1.0)},
          {"rotation_z_deg", angles.rotation_z},
          {"rotation_z_error_deg", errorOf(35, moves.rotation, kDegree)},
          {"tilt_x_deg", angles.tilt_x},
          {"tilt_x_error_deg", errorOf(28, moves.tilt, kDegree)},
          {"tilt_y_deg", angles.tilt_y},
          {"tilt_y_error_deg", errorOf(21, moves.tilt, kDegree)},
          {"matrix", pose.matrix()}};
}

engine::Result<Report> mosaic(const MosaicRun& options, engine::JobControl& job) {
  if (auto status = checkMosaic(options, job); !status) return tl::unexpected(status.error());
  const std::string& out = options.files.back();
  if (auto status = checkCompress(options.writing, {{options.files.front(), out, options.to}}); !status)
    return tl::unexpected(status.error());
  std::vector<engine::Version> scans;
  std::vector<engine::FieldForm> forms;
  forms.reserve(options.scans().size());
  for (const std::string& path : options.scans()) {
    auto scan = loadScan(path, options.reading, job);
    if (!scan) return tl::unexpected(scan.error());
    forms.push_back(engine::formOfHeights(scan->field));
    if (auto status = takeSamples(*scan, job); !status) return tl::unexpected(status.error());
    if (scan->field.lines() != nullptr)
      warn(fmt::format("{}: its edge lines do not go along", shownInput(path)));
    if (const std::int64_t filled = scan->original ? engine::countFilled(scan->field, *scan->original) : 0;
        filled > 0) {
      // What another scan measured there counts more.
      warn(fmt::format("{}: {} filled samples are left out: fill what is still a hole of the mosaic",
                       shownInput(path), filled));
      auto measured = engine::withoutFilled(scan->field, *scan->original, job);
      if (!measured) return tl::unexpected(measured.error());
      scan->field = *std::move(measured);
    }
    scans.push_back(std::move(scan->field));
  }
  const auto places = placesOf(options, scans);
  if (!places) return tl::unexpected(places.error());
  engine::JoinOptions how;
  how.places = *places;
  how.play = options.within;
  how.align.moves = movesOf(options.moves);
  how.align.most_rotation_deg = options.rotation.value_or(how.align.most_rotation_deg);
  how.blend = blendOf(options);
  for (const std::string& path : options.scans()) how.names.push_back(shownInput(path));
  auto foreseen = foreseeMosaic(options, scans, *places, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  const auto joined = engine::joinScans(scans, how, job);
  if (!joined) {
    engine::Error error = joined.error();
    if (error.remedy.ends_with("say where scans lie")) error.remedy += " with --layout";
    return tl::unexpected(error);
  }
  // Over loops of pairs they would agree to about 1.
  constexpr double kMisfit = 5.0;
  if (const int freedom = joined->poses.freedom; freedom > 0)
    if (const double misfit = std::sqrt(joined->poses.misfit / freedom); misfit > kMisfit)
      warn(fmt::format(
          "the pairs agree only to {:.2g} of their standard errors: some of the scans lie elsewhere; state "
          "their places with --layout",
          misfit));
  for (const engine::RepeatedPair& pair : joined->repeated)
    warn(fmt::format("{} over {}: {}", how.names[pair.second], how.names[pair.first],
                     repeatText(pair.shift, readLengthAs(glm::length(pair.shift), 1.0, "mm"))));
  const auto formed = underCommonForm(*joined, scans, forms, how.names, job);
  if (!formed) return tl::unexpected(formed.error());
  if (!formed->left_out.empty()) warn(formed->left_out);
  engine::ExportOptions writing = options.writing;
  writing.original = formed->field;
  if (auto status = saveField(formed->field, out, job, writing, options.to); !status)
    return tl::unexpected(status.error());

  Report report{{"width", joined->field.grid().width},
                {"height", joined->field.grid().height},
                {"blend", options.blend},
                {"moves", options.moves},
                {"pairs", joined->pairs.size()},
                {"freedom", joined->poses.freedom},
                {"misfit", joined->poses.misfit},
                {"error_factor", joined->poses.factor},
                {"scans", Report::array()},
                {"overlaps", Report::array()}};
  for (std::size_t k = 0; k < scans.size(); ++k)
    report["scans"].push_back(scanReport(options.files[k], joined->poses, k, how.align.moves));
  for (const engine::OverlapDeviation& overlap : joined->overlaps)
    report["overlaps"].push_back({{"a", options.files[overlap.first]},
                                  {"b", options.files[overlap.second]},
                                  {"places", overlap.places},
                                  {"median_mm", overlap.median},
                                  {"mean_mm", overlap.mean},
                                  {"rms_mm", overlap.rms},
                                  {"spread_mm", overlap.spread},
                                  {"height_error_mm", overlap.height_error}});
  for (const engine::RepeatedPair& pair : joined->repeated)
    report["repeats"].push_back({{"a", options.files[pair.first]},
                                 {"b", options.files[pair.second]},
                                 {"shift_x_mm", pair.shift.x},
                                 {"shift_y_mm", pair.shift.y}});
  report["out"] = out;
  report["hash"] = hashOf(joined->field);
  return report;
}

void printMosaic(const Report& report) {
  if (report.contains("text")) return printReport(report);
  double longest = 1e-12;
  for (const Report& scan : report["scans"])
    for (const char* key : {"shift_x_mm", "shift_y_mm", "shift_z_mm"})
      longest = std::max(longest, std::abs(scan[key].get<double>()));
  const ReadAs length = readLengthAs(longest, 1.0, "mm"), degrees{"degrees", 1.0};
  for (const Report& scan : report["scans"]) {
    const bool first = scan["shift_z_error_mm"].is_null();
    fmt::print("{}{}\n", scan["scan"].get<std::string>(), first ? " stays" : "");
    if (first) continue;
    for (const char* key : {"shift_x", "shift_y", "shift_z"})
      fmt::print("  {:<10} {}\n", key, shownEstimate(scan, key, "mm", length));
    for (const char* key : {"rotation_z", "tilt_x", "tilt_y"})
      fmt::print("  {:<10} {}\n", key, shownEstimate(scan, key, "deg", degrees));
  }
  for (const Report& overlap : report["overlaps"]) {
    const double spread = overlap["spread_mm"].get<double>();
    const ReadAs height = readLengthAs(std::max(spread, 1e-12), 1.0, "mm");
    fmt::print("{} over {}: {:.3g} +- {:.2g} {}, spread {:.3g} {}, at {} places\n",
               overlap["b"].get<std::string>(), overlap["a"].get<std::string>(),
               overlap["median_mm"].get<double>() / height.size,
               overlap["height_error_mm"].get<double>() / height.size, height.name, spread / height.size,
               height.name, overlap["places"].get<std::int64_t>());
  }
  const int freedom = report["freedom"].get<int>();
  if (freedom > 0)
    fmt::print("{} pairs agree to {:.3g} of their standard errors\n", report["pairs"].get<int>(),
               std::sqrt(report["misfit"].get<double>() / freedom));
  else
    fmt::print("{} pairs, no loop that would test them\n", report["pairs"].get<int>());
  fmt::print("{}: {} x {} samples, hash {}\n", report["out"].get<std::string>(), report["width"].get<int>(),
             report["height"].get<int>(), report["hash"].get<std::string>());
}

}  // namespace

void addMosaic(Command root, Chosen& chosen) {
  auto options = std::make_shared<MosaicRun>();
  Command command = addCommand(
      root, chosen, "mosaic", "Join overlapping scans: all are aligned to each other at once and blended",
      [options](engine::JobControl& job) { return mosaic(*options, job); }, printMosaic);
  command.add(
      {{.name = "IN",
        .to = &options->files,
        .text = "The scans, the first of which stays where it is, and the file to write, format by extension",
        .kind = ValueKind::kInput,
        .shown = "IN... OUT",
        .required = true},
       {.name = "--layout",
        .to = &options->layout,
        .text = "The scans lie in so many columns and rows, left to right, then the next row above",
        .kind = ValueKind::kSize,
        .shown = "COLUMNSxROWS",
        .otherwise = "where the files place them; where these state nothing, searched for"},
       {.name = "--overlap",
        .to = &options->overlap,
        .text = "With --layout: share of a side that neighbours have in common, roughly",
        .range = Range{1.0, kMostOverlap},
        .unit = "percent",
        .otherwise = "20"},
       {.name = "--within",
        .to = &options->within,
        .text = "How far the places that files or the layout state may be wrong",
        .range = Range{0.0, 1e9},
        .unit = "mm",
        .otherwise = "a tenth of the shortest side"},
       {.name = "--moves", .to = &options->moves, .text = "How scans may be moved", .words = alignWords()},
       {.name = "--rotation",
        .to = &options->rotation,
        .text = "Rotations about z that the search tries, both ways",
        .range = Range{0.0, 180.0},
        .unit = "degrees",
        .otherwise = "10"},
       {.name = "--blend",
        .to = &options->blend,
        .text = "The height where several scans have one",
        .words = {{"fade", "weights by the distance to each scan's rim: no step where a scan ends"},
                  {"mean", "the mean of all"},
                  {"first", "that of the first of them"}}}});
  addForceOption(command, options->replacing);
  addEstimateOption(command, options->estimate);
  addStreamFormat(command, options->to);
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
  command.notes(
      "Every two scans that overlap are aligned as fettle align does, and the places of all are those that "
      "fit all pairs "
      "best, each by its standard errors. A scan that no overlap joins to the first is refused by its name.\n"
      "Shifts are those of each scan's middle; the matrix takes millimetres from a scan's lower left sample "
      "to those from "
      "the first's. The result has the first scan's samples and continues them; heights of the others are "
      "bilinear "
      "between theirs. Holes of one scan are filled by the others. Marks go along, edge lines do not. Where "
      "a form lies over every scan and all are one form, within the noise of the first scan, it lies over "
      "the result, a session.");
  command.examples(
      {{"fettle mosaic west.tif east.tif both.tif", "Two scans, by the places that the files state"},
       {"fettle mosaic west.tif east.tif both.tif --layout 2x1 --overlap 40 --blend mean",
        "Two scans side by side that overlap by about two fifths"}});
}

}  // namespace fettle::app
