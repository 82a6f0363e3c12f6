#include "app/view/workstation.h"

#include <algorithm>

#include <imgui.h>

#include "app/view/panels/widgets.h"

namespace fettle::app {

void Workstation::displayPanel() {
  const char* maps[] = {"automatic", "viridis", "cividis", "grey", "diverging"};
  int map = static_cast<int>(display_.map);
  if (ImGui::Combo("colours", &map, maps, 5)) display_.map = static_cast<render::ColourMap>(map);
  bool deviation = display_.deviation;
  if (ImGui::Checkbox("change since the scan", &deviation)) act(Action::kDeviation);
  ImGui::Checkbox("contour lines", &display_.contours);
  ImGui::SameLine();
  ImGui::Checkbox("scale and colour bar", &display_.furniture);
  bool light = display_.theme == render::Theme::kLight;
  if (ImGui::Checkbox("light background", &light))
    display_.theme = light ? render::Theme::kLight : render::Theme::kDark;
  ImGui::SliderFloat("marks' opacity", &display_.marks_opacity, 0.0F, 1.0F, "%.2f");
  ImGui::SliderFloat("light from", &display_.light_azimuth_deg, 0.0F, 360.0F, "%.0f deg");
  ImGui::SliderFloat("light above", &display_.light_elevation_deg, 5.0F, 90.0F, "%.0f deg");
  auto exaggeration = static_cast<float>(view_.vertical_exaggeration);
  if (ImGui::InputFloat("exaggeration", &exaggeration, 0.0F, 0.0F,
                        exaggeration > 0.0F ? "%.3g x" : "automatic"))
    view_.vertical_exaggeration = exaggeration > 1e-6F ? std::min(exaggeration, 1e6F) : 0.0;
}

}  // namespace fettle::app
