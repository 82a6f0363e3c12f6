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

#include "app/terminal.h"
#include "engine/field/tile_store.h"
#include "engine/io/export.h"

namespace fettle::app {

namespace {

constexpr const char* kReading = "Reading the scan";

}  // namespace

void addStoreOption(CLI::App* command) {
  command
      ->add_option_function<std::string>(
          "--store",
          [](const std::string& folder) {
            engine::StorePolicy policy;
            policy.folder = folder;
            policy.always = true;
            engine::setStorePolicy(policy);
          },
          "Folder on a disk for the samples, so that they may be more than memory holds")
      ->group(kReading);
}

void addScanOptions(CLI::App* command, ScanOptions& options) {
  const std::string group = kReading;
  addStoreOption(command);
  command
      ->add_option("--no-data", options.no_data, "Height that means a hole, besides what the file declares")
      ->group(group);
  command
      ->add_option("--spacing", options.spacing,
                   "Sample spacing X[,Y] in the scan's unit, where the file has none")
      ->delimiter(',')
      ->expected(1, 2)
      ->group(group);
  command->add_option("--z-scale", options.z_scale, "Height of one count of the file")->group(group);
  command
      ->add_option("--unit", options.unit,
                   "Unit of the file's lengths, where it has none (nm, um, mm, m, in, ft)")
      ->group(group);
  command
      ->add_option("--cell-size", options.cell_size, "Point clouds: side of a grid cell in the scan's unit")
      ->group(group);
  command->add_option("--cell-rule", options.cell_rule, "Point clouds: height of a cell with several points")
      ->check(CLI::IsMember({"median", "mean", "highest"}))
      ->group(group);
  command
      ->add_option("--depth-camera", options.depth_camera,
                   "PNG, TIFF: distances from a camera with FX,FY,CX,CY in pixels, kept in its perspective")
      ->delimiter(',')
      ->expected(4)
      ->group(group);
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

engine::Result<engine::Imported> loadScan(const std::string& path, const ScanOptions& options,
                                          engine::JobControl& job) {
  const auto import = importOptions(options);
  if (!import) return tl::unexpected(import.error());
  auto imported = engine::importField(path, *import, job);
  if (imported)
    for (const std::string& warning : imported->warnings) warn(fmt::format("{}: {}", path, warning));
  return imported;
}

engine::Status saveField(const engine::Version& field, const std::string& path, engine::JobControl& job) {
  auto written = engine::exportField(field, path, {}, job);
  if (!written) return tl::unexpected(written.error());
  for (const std::string& warning : written->warnings) warn(fmt::format("{}: {}", path, warning));
  return {};
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

std::string extensionOf(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

namespace {

std::vector<std::string> extensionsFor(OutputKind kind) {
  if (kind == OutputKind::kMarks) return {".png", ".tif", ".tiff"};
  if (kind == OutputKind::kPicture) return {".png"};
  std::vector<std::string> extensions;
  if (kind == OutputKind::kField)
    for (const engine::FormatInfo& format : engine::formats())
      if (format.writes)
        extensions.insert(extensions.end(), format.extensions.begin(), format.extensions.end());
  return extensions;
}

// One spelling for one place, links and dots resolved as far as the path exists.
std::filesystem::path placeOf(const std::string& path) {
  std::error_code error;
  std::filesystem::path place = std::filesystem::weakly_canonical(path, error);
  return error ? std::filesystem::path(path) : place;
}

engine::Status checkOutput(const Output& output) {
  const std::vector<std::string> extensions = extensionsFor(output.kind);
  if (!extensions.empty() &&
      std::find(extensions.begin(), extensions.end(), extensionOf(output.path)) == extensions.end())
    return engine::inputError("no format to write has this extension", output.path,
                              fmt::format("take one of {}", fmt::join(extensions, " ")));
  std::filesystem::path folder = std::filesystem::path(output.path).parent_path();
  if (folder.empty()) folder = ".";
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error))
    return engine::inputError("there is no such folder", folder.string(), "make it or name another");
  if (std::filesystem::is_directory(output.path, error))
    return engine::inputError("the output is a folder", output.path, "name a file in it");
  if (std::filesystem::exists(output.path, error) && !std::filesystem::is_regular_file(output.path, error))
    return engine::inputError("the output is no regular file", output.path,
                              "outputs are put in place whole, by renaming: name a file");
  if (access(folder.c_str(), W_OK) != 0)
    return engine::inputError("the folder cannot be written to", folder.string(),
                              "name another or change its rights");
  return {};
}

}  // namespace

engine::Status checkOutputs(const std::vector<Output>& outputs, const std::vector<std::string>& inputs) {
  enum class Use : std::uint8_t { kInput, kOutput };
  std::map<std::filesystem::path, Use> taken;
  for (const std::string& input : inputs)
    if (!input.empty()) taken.emplace(placeOf(input), Use::kInput);
  for (const Output& output : outputs) {
    if (output.path.empty()) continue;
    if (auto status = checkOutput(output); !status) return status;
    const auto [earlier, fresh] = taken.emplace(placeOf(output.path), Use::kOutput);
    if (!fresh)
      return engine::inputError(earlier->second == Use::kInput ? "the output would replace an input"
                                                               : "two outputs are in the same place",
                                output.path, "name another file");
  }
  return {};
}

}  // namespace fettle::app
