#include <imgui.h>

#include "app/window/axes_gizmo.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

using render::PanelColour;

// Usual for x, y and z; told apart by the letters, too, where colours are not.
constexpr PanelColour kAxisColours[] = {PanelColour::kAxisX, PanelColour::kAxisY, PanelColour::kAxisZ};
constexpr const char* kAxisLetters[] = {"x", "y", "z"};
constexpr float kFarEnd = 0.35F;  // opacity of the balls at the ends below zero

ImU32 withOpacity(ImU32 colour, float opacity) {
  ImVec4 c = ImGui::ColorConvertU32ToFloat4(colour);
  c.w *= opacity;
  return ImGui::ColorConvertFloat4ToU32(c);
}

ImVec2 pixel(const glm::dvec2& p) {
  return ImVec2(static_cast<float>(p.x), static_cast<float>(p.y));
}

}  // namespace

void axesOverlay(const AxesGizmo& gizmo, const glm::dvec2& cursor, float scale) {
  if (!gizmo.shown()) return;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const AxesGizmo::Ball* const meant = gizmo.under(cursor);
  const auto radius = static_cast<float>(gizmo.ballRadius());
  for (const AxesGizmo::Ball& ball : gizmo.balls()) {
    const ImU32 colour = colourOf(kAxisColours[ball.axis]);
    const ImVec2 at = pixel(ball.at);
    if (ball.positive) {
      list.AddLine(pixel(gizmo.middle()), at, colour, 2.5F * scale);
      list.AddCircleFilled(at, radius, colour);
      const char* const letter = kAxisLetters[ball.axis];
      const ImVec2 size = ImGui::CalcTextSize(letter);
      list.AddText(ImVec2(at.x - 0.5F * size.x, at.y - 0.55F * size.y), colourOf(PanelColour::kAxisLetter),
                   letter);
    } else {
      const float opacity = ball.action ? kFarEnd : 0.5F * kFarEnd;
      list.AddCircleFilled(at, radius, colourOf(PanelColour::kAxisHollow));
      list.AddCircleFilled(at, radius, withOpacity(colour, opacity));
      list.AddCircle(at, radius, withOpacity(colour, ball.action ? 1.0F : kFarEnd), 0, 1.5F * scale);
    }
    if (&ball == meant)
      list.AddCircle(at, radius + 2.0F * scale, colourOf(PanelColour::kAxisPointed), 0, 2.0F * scale);
  }
}

}  // namespace fettle::app
