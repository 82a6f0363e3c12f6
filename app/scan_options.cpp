#include "app/scan_options.h"

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

#include "app/session_guard.h"
#include "app/spelling.h"
#include "app/streams.h"
#include "app/terminal.h"
#include "app/view/open_document.h"
#include "engine/field/tile_store.h"

namespace fettle::app {

namespace {

constexpr const char* kReading = "Reading the scan";

std::vector<std::string> extensions(bool engine::FormatInfo::*able) {
  std::vector<std::string> all;
  for (const engine::FormatInfo& format : engine::formats())
    if (format.*able) all.insert(all.end(), format.extensions.begin(), format.extensions.end());
  return all;
}

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
        const auto known = extensions(&engine::FormatInfo::reads);
        if (std::find(known.begin(), known.end(), withDot(typed)) != known.end()) return std::string();
        const std::string meant = didYouMean(withDot(typed), known);
        return fmt::format("{} is no format that can be read{}{}", typed, meant.empty() ? "" : "; ", meant);
      }})
      .group(group);
}

void addStreamFormat(Command command, std::string& to) {
  command.option("--to", to, "With - for OUT, standard output: its format, as extension");
}

std::string scanOptionsText(const ScanOptions& options) {
  std::string text;
  if (options.no_data) text += fmt::format(" --no-data {}", *options.no_data);
  if (!options.spacing.empty()) text += fmt::format(" --spacing {}", fmt::join(options.spacing, ","));
  if (options.z_scale) text += fmt::format(" --z-scale {}", *options.z_scale);
  if (!options.unit.empty()) text += " --unit " + options.unit;
  if (options.cell_size) text += fmt::format(" --cell-size {}", *options.cell_size);
  if (!options.cell_rule.empty()) text += " --cell-rule " + options.cell_rule;
  if (!options.depth_camera.empty())
    text += fmt::format(" --depth-camera {}", fmt::join(options.depth_camera, ","));
  return text;
}

engine::Result<engine::ImportOptions> importOptions(const ScanOptions& options) {
  engine::ImportOptions import;
  import.no_data = options.no_data;
  if (options.spacing.size() > 2)
    return engine::inputError(fmt::format("{} numbers are no spacing", options.spacing.size()), "--spacing",
                              "give X[,Y]");
  if (!options.spacing.empty()) import.spacing = {options.spacing.front(), options.spacing.back()};
  import.z_scale = options.z_scale;
  import.cell_size = options.cell_size;
  if (const auto& camera = options.depth_camera; camera.size() == 4)
    import.depth_camera = engine::DepthCamera{camera[0], camera[1], camera[2], camera[3]};
  if (options.cell_rule == "mean") import.cell_rule = engine::CellRule::kMean;
  if (options.cell_rule == "highest") import.cell_rule = engine::CellRule::kHighest;
  if (!options.unit.empty()) {
    import.unit = engine::lengthUnitFromName(options.unit);
    if (!import.unit)
      return engine::inputError(fmt::format("unknown unit {}", options.unit), "--unit",
                                "take one of nm, um, mm, cm, m, km, in, ft");
  }
  return import;
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

std::string withDot(const std::string& extension) {
  std::string dotted = extension.starts_with('.') ? extension : "." + extension;
  std::transform(dotted.begin(), dotted.end(), dotted.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return dotted;
}

std::string extensionOf(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

namespace {

// Formats whose files a terminal can show.
bool isText(const std::string& extension) {
  return std::ranges::any_of(engine::formats(), [&](const engine::FormatInfo& format) {
    return (format.name == "XYZ" || format.name == "AAIGrid") &&
           std::ranges::find(format.extensions, extension) != format.extensions.end();
  });
}

std::vector<std::string> extensionsFor(OutputKind kind) {
  if (kind == OutputKind::kMarks) return {".png", ".tif", ".tiff"};
  if (kind == OutputKind::kPicture) return {".png"};
  return kind == OutputKind::kField ? extensions(&engine::FormatInfo::writes) : std::vector<std::string>();
}

// One spelling for one place, links and dots resolved as far as the path exists.
std::filesystem::path placeOf(const std::string& path) {
  std::error_code error;
  std::filesystem::path place = std::filesystem::weakly_canonical(path, error);
  return error ? std::filesystem::path(path) : place;
}

engine::Status checkExtension(const std::string& extension, OutputKind kind, const std::string& where) {
  const std::vector<std::string> known = extensionsFor(kind);
  if (known.empty() || std::find(known.begin(), known.end(), extension) != known.end()) return {};
  const std::string meant = didYouMean(extension, known);
  return engine::inputError(
      extension.empty() ? "no extension names the format to write"
                        : fmt::format("{} is no format to write", extension),
      where, fmt::format("{}{}take one of {}", meant, meant.empty() ? "" : " ", fmt::join(known, " ")));
}

// Standard output in the place of a file.
engine::Status checkStream(const Output& output) {
  if (!output.stream)
    return engine::inputError("this cannot be written to standard output", output.path, "name a file");
  if (output.stream->empty())
    return engine::inputError("the format of standard output is not said", "--to",
                              "give it as extension: --to xyz");
  const std::string extension = withDot(*output.stream);
  if (auto known = checkExtension(extension, output.kind, "--to"); !known) return known;
  const bool text = output.kind == OutputKind::kField && isText(extension);
  if (!text && isatty(STDOUT_FILENO) != 0)
    return engine::inputError(fmt::format("standard output is a terminal, and {} is no text", extension), "-",
                              "send it into a file or another program, with > or |");
  return {};
}

engine::Status checkOutput(const Output& output) {
  if (isStream(output.path)) return checkStream(output);
  std::error_code error;
  if (output.path.ends_with('/') || std::filesystem::is_directory(output.path, error))
    return engine::inputError("the output is a folder", output.path, "name a file in it");
  if (auto known = checkExtension(extensionOf(output.path), output.kind, output.path); !known) return known;
  std::filesystem::path folder = std::filesystem::path(output.path).parent_path();
  if (output.makes_folder)
    while (!folder.empty() && !std::filesystem::exists(folder, error)) folder = folder.parent_path();
  if (folder.empty()) folder = ".";
  if (!std::filesystem::is_directory(folder, error))
    return std::filesystem::exists(folder, error)
               ? engine::inputError("this is a file and no folder", folder.string(), "name another")
               : engine::inputError("there is no such folder", folder.string(), "make it or name another");
  if (std::filesystem::exists(output.path, error) && !std::filesystem::is_regular_file(output.path, error))
    return engine::inputError("the output is no regular file", output.path,
                              "outputs are put in place whole, by renaming: name a file");
  if (access(folder.c_str(), W_OK) != 0)
    return engine::inputError("the folder cannot be written to", folder.string(),
                              "name another or change its rights");
  return {};
}

}  // namespace

engine::Status checkPlaces(const std::vector<Output>& outputs, const std::vector<std::string>& inputs) {
  enum class Use : std::uint8_t { kInput, kOutput };
  std::map<std::filesystem::path, Use> taken;
  for (const std::string& input : inputs)
    if (!input.empty() && !isStream(input)) taken.emplace(placeOf(input), Use::kInput);
  for (const Output& output : outputs) {
    if (output.path.empty()) continue;
    if (auto status = checkOutput(output); !status) return status;
    // A file or folder of that name is another place than standard output.
    const auto place = isStream(output.path) ? std::filesystem::path() : placeOf(output.path);
    const auto [earlier, fresh] = taken.emplace(place, Use::kOutput);
    if (!fresh)
      return engine::inputError(earlier->second == Use::kInput ? "the output would replace an input"
                                                               : "two outputs are in the same place",
                                output.path, "name another file");
  }
  return {};
}

void addForceOption(Command command, Replacing& replacing) {
  command.onFlagAnyhow(
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
      if (auto status = guard.spare(output.path, job); !status) return status;
  return {};
}

}  // namespace fettle::app
