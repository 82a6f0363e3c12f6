#include <fmt/format.h>
#include <imgui.h>

#include "app/window/panels/panels.h"

namespace fettle::app {

namespace {

void wrapped(const std::string& text) {
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
}

}  // namespace

void placePanel(const PanelContext& context, PlaceTool& places) {
  using State = PlaceTool::State;
  if (places.busy()) {
    workBar(places.progress(), -ImGui::GetFontSize() * 5.0F, "looking");
    ImGui::SameLine();
    actionButton("Cancel", Action::kHidePlaces, context.act);
    return;
  }
  const engine::WorthPlaces* const found = places.found();
  if (found == nullptr) {
    actionButton("Where is a line worth most?", Action::kNextPlace, context.act);
    return;
  }
  if (found->places.empty()) {
    wrapped("no place was found where a line gains tgv anything");
  } else {
    const render::ShownUnit& unit = context.units.change;
    const std::size_t n = found->places.size();
    if (const auto present = places.present()) {
      const engine::WorthPlace& place = found->places[*present];
      const State state = places.state(*present);
      wrapped(fmt::format("place {} of {}{}: estimated error of tgv {:.3g}, with all up to here {}, {:.0f} s",
                          *present + 1, n, state == State::kDone ? ", done" : "",
                          found->rmseAfter(0) * unit.per_unit,
                          lengthText(found->rmseAfter(*present + 1), unit, 3), place.seconds));
    }
    wrapped(fmt::format("{} done, {} skipped, {} left", places.count(State::kDone),
                        places.count(State::kSkipped), places.count(State::kOpen)));
    if (places.outdated())
      wrapped(
          "heights have changed since: places and estimates are of the surface before; hide them, then look "
          "again");
    actionButton("Next place", Action::kNextPlace, context.act);
    sameLineIfFits("Hide places");
  }
  actionButton("Hide places", Action::kHidePlaces, context.act);
}

}  // namespace fettle::app
