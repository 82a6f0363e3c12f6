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
  tickBox("crop to what is visible", options.crop, "Samples outside the picture are left out.");
  tickBox("left and right change places", options.turning.mirror_x, "The field is mirrored along its rows.");
  tickBox("top and bottom change places", options.turning.mirror_y,
          "The field is mirrored along its columns.");
  beginFields();
  (void)field("turned by", "Counter-clockwise as seen from above; no height changes.", [&] {
    return chooseWord("##quarters", options.turning.quarters,
                      {"0 degrees", "90 degrees", "180 degrees", "270 degrees"});
  });
  (void)field("and by", "A further angle, counter-clockwise; heights between samples are resampled.",
              [&] { return typeNumber("##angle", options.angle_deg, -180.0, 180.0, "%.6g\u00b0"); });
  endFields();
  if (tickBox("other spacing", options.resample,
              "Distance of the samples of the new field, along rows and columns.") &&
      !(options.spacing_mm > 0.0))
    options.spacing_mm = std::fmax(grid.spacingXMm(), grid.spacingYMm());
  restOfLine();
  if (options.resample)
    (void)typeLength("##spacing", options.spacing_mm, 1e-12, 1e12, length);
  else
    noField("as the scan's");
  beginFields();
  ImGui::BeginDisabled(!options.resample && options.angle_deg == 0.0);
  (void)field("resampling", "How a height between samples is found.", [&] {
    int method = static_cast<int>(options.method);
    const bool changed = chooseWord("##resampling", method, {"means of areas", "linear", "cubic"});
    if (changed) options.method = static_cast<engine::Resampling>(method);
    return changed;
  });
  ImGui::EndDisabled();
  endFields();
  const bool asked =
      pressButton("Make a session of it",
                  "Writes the transformed field as a session beside the scan, and opens it.") &&
      !options.none();
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
