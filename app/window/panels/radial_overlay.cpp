#include <algorithm>
#include <cmath>
#include <numbers>

#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

using render::PanelColour;

constexpr float kRing_px = 40.0F;  // radius of the ring that shows the direction, at scale 1

}  // namespace

void radialOverlay(const Parts& parts) {
  const RadialMenu& menu = parts.radial;
  if (!menu.active()) return;
  const auto scale = static_cast<float>(parts.window.scale());
  const ImVec2 middle(static_cast<float>(menu.drawnAt().x), static_cast<float>(menu.drawnAt().y));
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  const float ring = kRing_px * scale, wide = 7.0F * scale;
  list.PathArcTo(middle, ring, 0.0F, 2.0F * std::numbers::pi_v<float>, 64);
  list.PathStroke(colourOf(PanelColour::kRing), ImDrawFlags_None, wide);
  constexpr auto kCount = static_cast<float>(RadialMenu::kItems.size());
  for (std::size_t i = 0; i < RadialMenu::kItems.size(); ++i) {
    const RadialMenu::Item& item = RadialMenu::kItems[i];
    const bool pointed = menu.pointed() == i;
    const ActionRow& row = rowOf(item.action);
    const bool on = row.ticked != nullptr && row.ticked(parts);
    const float turn = (static_cast<float>(i) / kCount - 0.25F) * 2.0F * std::numbers::pi_v<float>;
    if (pointed) {
      const float half = std::numbers::pi_v<float> / kCount;
      list.PathArcTo(middle, ring, turn - half, turn + half, 12);
      list.PathStroke(colourOf(PanelColour::kTick), ImDrawFlags_None, wide);
    }
    const std::string_view name = tr(item.name);
    const ImVec2 text = ImGui::CalcTextSize(name.data(), name.data() + name.size());
    const ImVec2 half(0.5F * text.x + 9.0F * scale, 0.5F * text.y + 5.0F * scale);
    const float away = static_cast<float>(RadialMenu::kNames_px) * scale;
    // Names to the sides begin where those above and below have their middle.
    const ImVec2 at(middle.x + std::cos(turn) * (away + 0.5F * half.x), middle.y + std::sin(turn) * away);
    const ImVec2 low(at.x - half.x, at.y - half.y), high(at.x + half.x, at.y + half.y);
    list.AddRectFilled(low, high, colourOf(pointed ? PanelColour::kButtonHeld : PanelColour::kPlate),
                       5.0F * scale);
    if (on) list.AddRect(low, high, colourOf(PanelColour::kTick), 5.0F * scale, 0, 2.0F * scale);
    list.AddText(ImVec2(at.x - 0.5F * text.x, at.y - 0.5F * text.y), colourOf(PanelColour::kText),
                 name.data(), name.data() + name.size());
  }
}

}  // namespace fettle::app
