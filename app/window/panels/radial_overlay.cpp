#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string_view>

#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

using render::PanelColour;

constexpr float kRing_px = 40.0F;  // radius of the ring that shows the direction, at scale 1

// A name and its plate, from the middle of the menu.
struct Plate {
  std::string_view name;
  ImVec2 text, half, at;
};

Plate plateOf(std::size_t item, float scale) {
  constexpr auto kCount = static_cast<float>(RadialMenu::kItems.size());
  Plate plate;
  plate.name = tr(RadialMenu::kItems[item].name);
  plate.text = ImGui::CalcTextSize(plate.name.data(), plate.name.data() + plate.name.size());
  plate.half = ImVec2(0.5F * plate.text.x + 9.0F * scale, 0.5F * plate.text.y + 5.0F * scale);
  const float turn = (static_cast<float>(item) / kCount - 0.25F) * 2.0F * std::numbers::pi_v<float>;
  const float away = static_cast<float>(RadialMenu::kNames_px) * scale;
  // Names to the sides begin where those above and below have their middle.
  plate.at = ImVec2(std::cos(turn) * (away + 0.5F * plate.half.x), std::sin(turn) * away);
  return plate;
}

RadialMenu::Reach reachOf(std::span<const Plate> plates) {
  RadialMenu::Reach reach;
  for (const Plate& plate : plates) {
    reach.left = std::max(reach.left, static_cast<double>(plate.half.x - plate.at.x));
    reach.right = std::max(reach.right, static_cast<double>(plate.half.x + plate.at.x));
    reach.up = std::max(reach.up, static_cast<double>(plate.half.y - plate.at.y));
    reach.down = std::max(reach.down, static_cast<double>(plate.half.y + plate.at.y));
  }
  return reach;
}

}  // namespace

void radialOverlay(const Parts& parts) {
  const RadialMenu& menu = parts.radial;
  if (!menu.active()) return;
  const auto scale = static_cast<float>(parts.window.scale());
  // Names have another length in another language.
  std::array<Plate, RadialMenu::kItems.size()> plates;
  for (std::size_t i = 0; i < plates.size(); ++i) plates[i] = plateOf(i, scale);
  const glm::dvec2 drawn_at = menu.drawnAt(reachOf(plates));
  const ImVec2 middle(static_cast<float>(drawn_at.x), static_cast<float>(drawn_at.y));
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
    const auto& [name, text, half, off] = plates[i];
    const ImVec2 at(middle.x + off.x, middle.y + off.y);
    const ImVec2 low(at.x - half.x, at.y - half.y), high(at.x + half.x, at.y + half.y);
    list.AddRectFilled(low, high, colourOf(pointed ? PanelColour::kButtonHeld : PanelColour::kPlate),
                       5.0F * scale);
    if (on) list.AddRect(low, high, colourOf(PanelColour::kTick), 5.0F * scale, 0, 2.0F * scale);
    list.AddText(ImVec2(at.x - 0.5F * text.x, at.y - 0.5F * text.y), colourOf(PanelColour::kText),
                 name.data(), name.data() + name.size());
  }
}

}  // namespace fettle::app
