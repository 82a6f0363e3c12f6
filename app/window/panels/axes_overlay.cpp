#include <imgui.h>

#include "app/window/axes_gizmo.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

using render::PanelColour;

// Usual for x, y and z; told apart by the letters, too, where colours are not.
constexpr PanelColour kAxisColours[] = {PanelColour::kAxisX, PanelColour::kAxisY, PanelColour::kAxisZ};
constexpr const char* kAxisLetters[] = {"x", "y", "z"};
constexpr const char* kBelowZero[] = {"-x", "-y", "-z"};

ImVec2 pixel(const glm::dvec2& p) {
  return ImVec2(static_cast<float>(p.x), static_cast<float>(p.y));
}

void letterIn(ImDrawList& list, const ImVec2& middle, const char* letter, ImU32 colour) {
  const ImVec2 size = ImGui::CalcTextSize(letter);
  list.AddText(ImVec2(middle.x - 0.5F * size.x, middle.y - 0.55F * size.y), colour, letter);
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
      letterIn(list, at, kAxisLetters[ball.axis], colourOf(PanelColour::kAxisLetter));
    } else {
      list.AddCircleFilled(at, radius, colourOf(PanelColour::kAxisHollow));
      letterIn(list, at, kBelowZero[ball.axis], colour);
      list.AddCircle(at, radius, colour, 0, 1.5F * scale);
    }
    if (&ball == meant)
      list.AddCircle(at, radius + 2.0F * scale, colourOf(PanelColour::kAxisPointed), 0, 2.0F * scale);
  }
}

}  // namespace fettle::app
