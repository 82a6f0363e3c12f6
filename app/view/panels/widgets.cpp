#include "app/view/panels/widgets.h"

#include <fmt/format.h>
#include <imgui.h>

namespace fettle::app {

void figure(const char* name, const std::string& value) {
  ImGui::TextDisabled("%s", name);
  ImGui::SameLine(0.5F * ImGui::GetContentRegionAvail().x);
  ImGui::TextUnformatted(value.c_str());
}

std::string bytesText(double bytes) {
  if (bytes < 1e4) return fmt::format("{:.0f} B", bytes);
  if (bytes < 1e7) return fmt::format("{:.1f} kB", bytes * 1e-3);
  if (bytes < 1e10) return fmt::format("{:.1f} MB", bytes * 1e-6);
  return fmt::format("{:.1f} GB", bytes * 1e-9);
}

}  // namespace fettle::app
