#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

using render::PanelColour;

ImVec2 at(const glm::dvec2& p) {
  return ImVec2(static_cast<float>(p.x), static_cast<float>(p.y));
}

void drawLasso(const Lasso& lasso, float scale) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  std::vector<ImVec2> line;
  for (const glm::dvec2& p : lasso.line()) line.push_back(at(p));
  // Dark under light: visible on every background.
  for (const auto& [colour, width] :
       {std::pair{colourOf(PanelColour::kLassoRim), 4.0F}, {colourOf(PanelColour::kLasso), 2.0F}}) {
    if (line.size() > 1)
      list.AddPolyline(line.data(), static_cast<int>(line.size()), colour, ImDrawFlags_Closed, width * scale);
    const ImVec2 c = at(lasso.cross());
    const float arm = 9.0F * scale;
    list.AddLine(ImVec2(c.x - arm, c.y), ImVec2(c.x + arm, c.y), colour, width * scale);
    list.AddLine(ImVec2(c.x, c.y - arm), ImVec2(c.x, c.y + arm), colour, width * scale);
  }
}

// Words over the picture, in its middle or over its last plot, in lines that are no wider than that.
void labelOver(const char* id, const char* words, const ImVec2& middle, float widest) {
  ImGui::SetNextWindowPos(middle, ImGuiCond_Always, ImVec2(0.5F, 0.0F));
  // A window that takes its size from what is in it is seen a frame later, when the key may have been released.
  const ImVec2 padding = ImGui::GetStyle().WindowPadding;
  const float room = std::max(widest - 2.0F * padding.x, 1.0F);
  const ImVec2 text = ImGui::CalcTextSize(words, nullptr, false, room);
  ImGui::SetNextWindowSize(ImVec2(text.x + 2.0F * padding.x, text.y + 2.0F * padding.y));
  ImGui::Begin(id, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoBringToFrontOnFocus);
  ImGui::PushTextWrapPos(padding.x + room);
  ImGui::TextUnformatted(words);
  ImGui::PopTextWrapPos();
  ImGui::End();
}

// Of the picture's width, below the titles.
ImVec2 placeOver(const Parts& parts, double share, float scale) {
  const render::Rectangle area = parts.window.pictureArea();
  constexpr float kBelow = 12.0F, kBelowTitles = 60.0F;  // of three lines
  return ImVec2(static_cast<float>(area.x) + static_cast<float>(share * area.width),
                static_cast<float>(area.y) + (share == 0.5 ? kBelow : kBelowTitles) * scale);
}

float widthOf(const Parts& parts, double share) {
  return static_cast<float>(share * parts.window.pictureArea().width);
}

// Who looks at what was must know it.
void beforeLabel(const Parts& parts, float scale) {
  labelOver("##before", tr("before: the scan as it was"), placeOver(parts, 0.5, scale), widthOf(parts, 1.0));
}

// Means are smoother than what comes of them: who judges a filter by them is misled.
void coarseLabel(const Parts& parts, float scale) {
  const std::size_t plots = parts.picture.shown().versions.size();
  const bool filters = parts.filters.showsMeans(), heights = parts.heights.showsMeans();
  if (plots < 2 || !(filters || heights)) return;
  // What is computed is the last plot; in one plot with a line it is the right part.
  const double share = 1.0 - 0.5 / static_cast<double>(plots);
  labelOver("##coarse", tr("coarse as yet: smoother than the result"), placeOver(parts, share, scale),
            widthOf(parts, 1.0 / static_cast<double>(plots)));
}

}  // namespace

void pictureOverlay(const Parts& parts) {
  const auto scale = static_cast<float>(parts.window.scale());
  const Display& display = parts.settings.display;
  if (display.axes && !parts.picture.empty())
    axesOverlay(AxesGizmo(parts.view, parts.picture.plot(parts.view, display), parts.window.scale()),
                parts.cursor, scale);
  if (parts.picture.hasSplitLine(display)) {
    const render::Rectangle plot = parts.picture.plot(parts.view, display);
    ImGui::GetBackgroundDrawList()->AddCircleFilled(
        at({plot.x + display.split_at * plot.width, plot.y + plot.height / 2}), 7.0F * scale,
        colourOf(PanelColour::kSplitHandle));
  }
  if (parts.shows_before && parts.document.isOpen()) beforeLabel(parts, scale);
  if (parts.document.isOpen()) coarseLabel(parts, scale);
  if (parts.marking.lasso().active()) drawLasso(parts.marking.lasso(), scale);
}

}  // namespace fettle::app
