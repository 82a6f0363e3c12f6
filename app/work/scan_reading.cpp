#include "app/work/scan_reading.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace fettle::app {

ScanOptions scanOptionsOf(const engine::ImportOptions& import) {
  ScanOptions options;
  options.no_data = import.no_data;
  if (import.spacing) options.spacing = {import.spacing->first, import.spacing->second};
  options.z_scale = import.z_scale;
  if (import.unit) options.unit = import.unit->name;
  options.cell_size = import.cell_size;
  if (import.cell_rule == engine::CellRule::kMean) options.cell_rule = "mean";
  if (import.cell_rule == engine::CellRule::kHighest) options.cell_rule = "highest";
  if (const auto& camera = import.depth_camera) {
    options.depth_camera = {camera->fx, camera->fy};
    if (camera->cx && camera->cy)
      options.depth_camera.insert(options.depth_camera.end(), {*camera->cx, *camera->cy});
  }
  return options;
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
  if (const auto& camera = options.depth_camera; !camera.empty()) {
    if (camera.size() != 1 && camera.size() != 2 && camera.size() != 4)
      return engine::inputError(fmt::format("{} numbers are no camera", camera.size()), "--depth-camera",
                                "give FX[,FY[,CX,CY]]");
    import.depth_camera = engine::DepthCamera{camera[0], camera.size() > 1 ? camera[1] : camera[0]};
    if (camera.size() == 4) {
      import.depth_camera->cx = camera[2];
      import.depth_camera->cy = camera[3];
    }
  }
  if (options.cell_rule == "mean") import.cell_rule = engine::CellRule::kMean;
  if (options.cell_rule == "highest") import.cell_rule = engine::CellRule::kHighest;
  if (!options.unit.empty()) {
    import.unit = engine::lengthUnitFromName(options.unit);
    if (!import.unit)
      return engine::inputError(fmt::format("unknown unit {}", options.unit), "--unit",
                                fmt::format("take one of {}", fmt::join(engine::lengthUnitNames(), ", ")));
  }
  return import;
}

}  // namespace fettle::app
