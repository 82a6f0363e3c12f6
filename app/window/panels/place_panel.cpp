#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {

namespace {

constexpr int kOutcomeOfPlaces = 5;  // lines

void writePlaces(const engine::WorthPlaces& found, const PlaceTool& places, const render::ShownUnit& unit) {
  using State = PlaceTool::State;
  if (found.places.empty()) {
    writeWrapped("no place was found where a line gains tgv anything");
    return;
  }
  if (const auto present = places.present()) {
    const engine::WorthPlace& place = found.places[*present];
    const State state = places.state(*present);
    writeWrapped(trFormat("place {} of {}{}: estimated error of tgv {:.3g}, with all up to here {}, {:.0f} s",
                          *present + 1, found.places.size(), state == State::kDone ? tr(", done") : "",
                          found.rmseAfter(0) * unit.per_unit,
                          lengthText(found.rmseAfter(*present + 1), unit, 3), place.seconds));
  }
  writeWrapped(trFormat("{} done, {} skipped, {} left", places.count(State::kDone),
                        places.count(State::kSkipped), places.count(State::kOpen)));
  if (places.outdated())
    writeWrapped(
        "heights have changed since: places and estimates are of the surface before; hide them, then look "
        "again");
}

}  // namespace

void placePanel(const PanelContext& context, PlaceTool& places) {
  const engine::WorthPlaces* const found = places.busy() ? nullptr : places.found();
  const bool some = found != nullptr && !found->places.empty();
  ImGui::BeginDisabled(places.busy() || (found != nullptr && !some));
  actionButton(
      some ? textOf("Next place") : textOf("Where is a line worth most?"), Action::kNextPlace, context.act,
      ImGui::CalcTextSize(tr("Where is a line worth most?")).x + 2.0F * ImGui::GetStyle().FramePadding.x);
  ImGui::EndDisabled();
  sameLineIfFits("Hide places");
  ImGui::BeginDisabled(found == nullptr);
  actionButton("Hide places", Action::kHidePlaces, context.act);
  ImGui::EndDisabled();
  beginPlace("##places outcome", kOutcomeOfPlaces);
  if (found != nullptr)
    writePlaces(*found, places, context.units.change);
  else if (places.busy() && cancelledBar(places.progress(), "looking", "Cancel"))
    context.act(Action::kHidePlaces);
  else if (!places.busy())
    writeIn(render::PanelColour::kMuted,
            "Finds stretches of edges where a line drawn by hand probably gains most beyond the filter tgv, "
            "the best first.");
  endPlace();
}

}  // namespace fettle::app
