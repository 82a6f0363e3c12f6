#include "app/commands/scan_options.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "app/terminal.h"
#include "app/work/open_document.h"
#include "app/work/session_guard.h"
#include "app/work/spelling.h"
#include "app/work/streams.h"
#include "engine/field/tile_store.h"
#include "engine/formats/formats.h"

namespace fettle::app {

namespace {

constexpr const char* kReading = "Reading the scan";

}  // namespace

void addStoreOption(Command command) {
  command
      .onOption(
          "--store",
          [](const std::string& folder) {
            engine::StorePolicy policy;
            policy.folder = folder;
            policy.always = true;
            engine::setStorePolicy(policy);
          },
          "Folder on a disk for the samples, so that they may be more than memory holds")
      .check(folderName())
      .group(kReading);
}

void addScanOptions(Command command, ScanOptions& options) {
  const std::string group = kReading;
  addStoreOption(command);
  command.option("--no-data", options.no_data, "Height that means a hole, besides what the file declares")
      .group(group);
  command
      .option("--spacing", options.spacing,
              "Sample spacing X[,Y] in the scan's unit, where the file has none")
      .delimiter(',')
      .oneValueEach()  // "--spacing 0.5 SCAN": what follows is the scan
      .group(group);
  command.option("--z-scale", options.z_scale, "Height of one count of the file").group(group);
  command
      .option("--unit", options.unit, "Unit of the file's lengths, where it has none (nm, um, mm, m, in, ft)")
      .group(group);
  command.option("--cell-size", options.cell_size, "Point clouds: side of a grid cell in the scan's unit")
      .group(group);
  command.option("--cell-rule", options.cell_rule, "Point clouds: height of a cell with several points")
      .check(oneOf({"median", "mean", "highest"}))
      .group(group);
  command
      .option("--depth-camera", options.depth_camera,
              "PNG, TIFF: distances from a camera with FX,FY,CX,CY in pixels, kept in its perspective")
      .delimiter(',')
      .expected(4)
      .group(group);
  command
      .option("--from", options.from,
              "Format of standard input (-), as extension, where its content leaves doubt")
      .check({[](const std::string& typed) {
        const auto known = extensionsOf(&engine::FormatInfo::reads);
        if (std::find(known.begin(), known.end(), withDot(typed)) != known.end()) return std::string();
        const std::string meant = didYouMean(withDot(typed), known);
        return fmt::format("{} is no format that can be read{}{}", typed, meant.empty() ? "" : "; ", meant);
      }})
      .group(group);
}

void addStreamFormat(Command command, std::string& to) {
  command.option("--to", to, "With - for OUT, standard output: its format, as extension");
}

namespace {

engine::Result<engine::Imported> warned(engine::Result<engine::Imported> imported, const std::string& name) {
  if (imported)
    for (const std::string& warning : imported->warnings) warn(fmt::format("{}: {}", name, warning));
  return imported;
}

}  // namespace

engine::Result<engine::Imported> loadScan(const std::string& path, const ScanOptions& options,
                                          engine::JobControl& job) {
  const auto import = importOptions(options);
  if (!import) return tl::unexpected(import.error());
  if (!isStream(path)) return warned(engine::importField(path, *import, job), path);
  const auto input = StandardInput::read(options.from.empty() ? "" : withDot(options.from), job);
  if (!input) return tl::unexpected(input.error());
  auto imported = engine::importField(input->path(), *import, job);
  if (!imported) return tl::unexpected(input->renamed(imported.error()));
  return warned(std::move(imported), shownInput(path));
}

void addOriginalOption(Command command, std::string& original) {
  command.option("--original", original,
                 "The scan that the work began with: changes are limited against it; without it against "
                 "what is read, or against the original that a session has");
}

namespace {

// Whether files of a format say where samples lie.
bool keepsPlace(const engine::Imported& scan) {
  return scan.format != "PNG" && scan.format != "STL";
}

// How far two numbers are apart. A format that loses the unit keeps the number: then that is what must agree.
double apart(double a, double b, const engine::Grid& of_a, const engine::Grid& of_b) {
  return std::min(std::abs(a - b),
                  std::abs(a * of_a.lateral_unit.mm - b * of_b.lateral_unit.mm) / of_b.lateral_unit.mm);
}

// Whether two grids of the same sides put each sample in the same place, but for the rounding of a format.
engine::Status checkSamePlace(const engine::Grid& original, const engine::Grid& scan,
                              const std::string& where) {
  constexpr double kPartOfSample = 0.05;
  constexpr const char* kRemedy = "give the scan that this one was made from";
  const auto refused = [&](const char* what, double ax, double ay, double bx, double by) {
    return engine::inputError(
        fmt::format(
            "the {} of the original is {:.10g} x {:.10g} {} and that of the scan {:.10g} x {:.10g} {}", what,
            ax, ay, original.lateral_unit.name, bx, by, scan.lateral_unit.name),
        where, kRemedy);
  };
  // At the far side, where a wrong spacing adds up.
  if (apart(original.spacing_x, scan.spacing_x, original, scan) * scan.width >
          kPartOfSample * scan.spacing_x ||
      apart(original.spacing_y, scan.spacing_y, original, scan) * scan.height >
          kPartOfSample * scan.spacing_y)
    return refused("spacing", original.spacing_x, original.spacing_y, scan.spacing_x, scan.spacing_y);
  if (apart(original.origin_x, scan.origin_x, original, scan) > kPartOfSample * scan.spacing_x ||
      apart(original.origin_y, scan.origin_y, original, scan) > kPartOfSample * scan.spacing_y)
    return refused("origin", original.origin_x, original.origin_y, scan.origin_x, scan.origin_y);
  return {};
}

}  // namespace

engine::Result<engine::Version> originalOf(const engine::Imported& imported, const std::string& given,
                                           const ScanOptions& reading, engine::JobControl& job) {
  if (given.empty()) return imported.original.value_or(imported.field);
  if (imported.original)
    return engine::inputError("a session has its own original", given, "leave --original out");
  const auto other = loadScan(given, reading, job);
  if (!other) return tl::unexpected(other.error());
  const engine::Version& original = other->original.value_or(other->field);
  const engine::Grid &is = original.grid(), &wanted = imported.field.grid();
  if (is.width != wanted.width || is.height != wanted.height)
    return engine::inputError(fmt::format("the original has {} x {} samples and the scan {} x {}", is.width,
                                          is.height, wanted.width, wanted.height),
                              given, "give the scan that this one was made from");
  if (!(is.height_unit == wanted.height_unit))
    return engine::inputError(fmt::format("heights of the original are in {} and those of the scan in {}",
                                          is.height_unit.name, wanted.height_unit.name),
                              given, "convert one of them, or say --unit where a file states none");
  if (keepsPlace(*other) && keepsPlace(imported))
    if (auto same = checkSamePlace(is, wanted, given); !same) return tl::unexpected(same.error());
  return original.withGrid(wanted);
}

engine::Status checkOriginal(const std::string& given, bool limited, const std::string& out) {
  if (given.empty() || limited || isSessionPath(out)) return {};
  return engine::inputError("the original is what changes are limited against, and nothing limits them",
                            "--original", "give --max-change, or a scene with max_change, or leave it out");
}

engine::Status saveField(const engine::Version& field, const std::string& path, engine::JobControl& job,
                         const engine::ExportOptions& writing, const std::string& to) {
  return writeTo(path, withDot(to), job, [&](const std::string& file) -> engine::Status {
    auto written = engine::exportField(field, file, writing, job);
    if (!written) return tl::unexpected(written.error());
    for (const std::string& warning : written->warnings)
      warn(fmt::format("{}: {}", shownOutput(path), warning));
    return {};
  });
}

engine::Result<double> parseHeight(const std::string& text, const engine::Grid& grid,
                                   const std::string& option) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !std::isfinite(value) || value < 0.0)
    return engine::inputError(fmt::format("{} is not a length", text), option,
                              "give a number at or above 0, such as 0.5 or 20um");
  const std::string suffix(end, text.data() + text.size());
  if (suffix.empty()) return value;
  const auto unit = engine::lengthUnitFromName(suffix);
  if (!unit)
    return engine::inputError(fmt::format("unknown unit {}", suffix), option,
                              "take one of nm, um, mm, cm, m, in, ft");
  return value * unit->mm / grid.height_unit.mm;
}

std::string seedProblem(const std::string& text) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  return error == std::errc{} && end == text.data() + text.size()
             ? ""
             : "give a whole number from 0 to 18446744073709551615";
}

engine::Result<std::pair<int, int>> parseSize(const std::string& text, const std::string& option,
                                              SideRange sides) {
  int width = 0;
  int height = 0;
  char rest = 0;
  const auto fits = [&](int side) { return side >= sides.smallest && side <= sides.largest; };
  if (std::sscanf(text.c_str(), "%6dx%6d%c", &width, &height, &rest) != 2 || !fits(width) || !fits(height))
    return engine::inputError(fmt::format("{} is not a size", text), option,
                              fmt::format("give WIDTHxHEIGHT, each {} to {}", sides.smallest, sides.largest));
  return std::pair{width, height};
}

void addForceOption(Command command, Replacing& replacing) {
  command.onFlag(
      "--force", [&replacing] { replacing = Replacing::kAnything; }, "Replace a session that has a journal");
}

engine::Status checkOutputs(const std::vector<Output>& outputs, const std::vector<std::string>& inputs,
                            Replacing replacing, engine::JobControl& job) {
  if (auto status = checkPlaces(outputs, inputs); !status) return status;
  if (replacing == Replacing::kNoWork)
    for (const Output& output : outputs)
      if (isSessionPath(output.path))
        if (auto status = refuseToLoseWork(output.path); !status) return status;
  ScanGuard guard;
  for (const Output& output : outputs)
    if (!output.path.empty() && !isStream(output.path))
      if (auto status = guard.protectSessions(output.path, job); !status) return status;
  return {};
}

}  // namespace fettle::app
