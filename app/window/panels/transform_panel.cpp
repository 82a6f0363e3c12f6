#include <cmath>
#include <iterator>

#include <imgui.h>

#include "app/window/panels/panels.h"

namespace fettle::app {

namespace {
constexpr int kOutcomeOfTransform = 2;  // lines
}

bool transformPanel(const PanelContext& context, TransformTool& transform) {
  ImGui::BeginDisabled(transform.busy());
  TransformTool::Options& options = transform.options;
  const engine::Grid& grid = context.client.field().grid();
  const render::ShownUnit length = ofMillimetres(context.units.length, grid.lateral_unit.mm);
  ImGui::Checkbox("crop to what is visible", &options.crop);
  ImGui::Checkbox("left and right change places", &options.turning.mirror_x);
  ImGui::Checkbox("top and bottom change places", &options.turning.mirror_y);
  beginFields();
  (void)field("turned by", [&] {
    constexpr const char* kQuarters[] = {"0 degrees", "90 degrees", "180 degrees", "270 degrees"};
    return ImGui::Combo("##quarters", &options.turning.quarters, kQuarters, std::size(kQuarters));
  });
  (void)field("and by",
              [&] { return typeNumber("##angle", options.angle_deg, -180.0, 180.0, "%.6g degrees"); });
  endFields();
  if (ImGui::Checkbox("other spacing", &options.resample) && !(options.spacing_mm > 0.0))
    options.spacing_mm = std::fmax(grid.spacingXMm(), grid.spacingYMm());
  restOfLine();
  if (options.resample)
    (void)typeLength("##spacing", options.spacing_mm, 1e-12, 1e12, length);
  else
    noField("as the scan's");
  beginFields();
  ImGui::BeginDisabled(!options.resample && options.angle_deg == 0.0);
  (void)field("resampling", "How a height between samples is found.", [&] {
    constexpr const char* kMethods[] = {"means of areas", "linear", "cubic"};
    int method = static_cast<int>(options.method);
    const bool changed = ImGui::Combo("##resampling", &method, kMethods, std::size(kMethods));
    if (changed) options.method = static_cast<engine::Resampling>(method);
    return changed;
  });
  ImGui::EndDisabled();
  endFields();
  const bool asked = ImGui::Button("Make a session of it") && !options.none();
  ImGui::EndDisabled();
  beginPlace("##transform outcome", kOutcomeOfTransform);
  if (!transform.busy())
    writeWrapped("beside the scan, and opened; the work here stays as it is");
  else if (cancelledBar(transform.progress(), "transforming", "Cancel##transform"))
    transform.cancel();
  endPlace();
  return asked;
}

}  // namespace fettle::app
