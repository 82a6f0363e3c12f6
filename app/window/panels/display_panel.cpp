#include <algorithm>

#include <imgui.h>

#include "app/window/panels/widgets.h"
#include "app/window/workstation.h"

namespace fettle::app {

void Workstation::displayPanel() {
  bool deviation = display_.deviation;
  if (ImGui::Checkbox("colours show the change", &deviation)) act(Action::kDeviation);
  tip(Action::kDeviation);
  ImGui::Checkbox("contour lines", &display_.contours);
  tip(Action::kContours);
  ImGui::Checkbox("scale bar and colour bar", &display_.furniture);
  tip(Action::kFurniture);
  bool light = display_.theme == render::Theme::kLight;
  if (ImGui::Checkbox("light background", &light)) act(Action::kTheme);
  tip(Action::kTheme);
  ImGui::Checkbox("half as sharp while it moves", &display_.half_in_motion);
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip(
        "While the view moves, every second pixel is drawn each way, so that it follows the hand.");
  ImGui::Checkbox("ask before quitting", &settings_.ask_before_quitting);
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip(
        "With unsaved work. Without the question it is kept as well, and offered when the scan is "
        "opened again.");
  beginFields();
  detailChooser();
  const char* maps[] = {"automatic", "viridis", "cividis", "grey", "diverging"};
  int map = static_cast<int>(display_.map);
  if (field("colours", [&] { return ImGui::Combo("##colours", &map, maps, 5); }))
    display_.map = static_cast<render::ColourMap>(map);
  const char* eyes[] = {"one eye", "two, side by side", "two, red-cyan glasses"};
  int mode = static_cast<int>(display_.stereo);
  if (field("eyes", [&] { return ImGui::Combo("##eyes", &mode, eyes, 3); }))
    display_.stereo = static_cast<render::StereoMode>(mode);
  constexpr ImGuiSliderFlags kClamp = ImGuiSliderFlags_AlwaysClamp;
  (void)field("marks", [&] {
    return ImGui::SliderFloat("##opacity", &display_.marks_opacity, 0.0F, 1.0F, "opacity %.2f", kClamp);
  });
  (void)field("light from", [&] {
    return ImGui::SliderFloat("##azimuth", &display_.light_azimuth_deg, 0.0F, 360.0F, "%.0f deg", kClamp);
  });
  (void)field("light above", [&] {
    return ImGui::SliderFloat("##elevation", &display_.light_elevation_deg, 5.0F, 90.0F, "%.0f deg", kClamp);
  });
  if (display_.stereo != render::StereoMode::kOff)
    (void)field("depth", [&] {
      return ImGui::SliderFloat("##eye_separation", &display_.eye_separation, 0.005F, 0.1F, "eyes %.3f apart",
                                kClamp);
    });
  (void)field("heights", [&] {
    return typeNumber("##exaggeration", view_.vertical_exaggeration, 0.0, 1e6,
                      view_.vertical_exaggeration > 0.0 ? "%.3g times" : "0: automatic");
  });
  endFields();
}

}  // namespace fettle::app
