#include <filesystem>
#include <iterator>
#include <string>

#include <imgui.h>

#include "app/window/panels/moves_choice.h"
#include "app/window/panels/panels.h"
#include "app/window/screen_text.h"
#include "engine/io/import.h"

namespace fettle::app {
namespace {

// Lines of the outcome from when a scan is compared, and before.
constexpr int kComparedLines = 15, kUncomparedLines = 3;

// What counts where a nominal mesh is compared.
void meshFields(const PanelContext& context, NominalChoice& nominal) {
  (void)field("mesh in", "The unit of the numbers of an .stl; only one that Fettle wrote says it.", [&] {
    constexpr const char* kAsStated = textOf("as it says, else mm");
    if (!beginList("##mesh unit", nominal.unit.empty() ? tr(kAsStated) : screenText(nominal.unit).c_str()))
      return false;
    if (ImGui::Selectable(labelOf(kAsStated), nominal.unit.empty())) nominal.unit.clear();
    for (const std::string& unit : engine::lengthUnitNames())
      if (ImGui::Selectable(screenText(unit).c_str(), unit == nominal.unit)) nominal.unit = unit;
    ImGui::EndCombo();
    return true;
  });
  (void)field(
      "from a mesh", "Along z, as a scan sees it, or the shortest way to the mesh: for steep walls.", [&] {
        int distance = nominal.shortest ? 1 : 0;
        const bool changed = chooseWord("##mesh distance", distance, {"height over it", "shortest distance"});
        nominal.shortest = distance == 1;
        return changed;
      });
  (void)field("tolerance", "Counts what lies within it of a mesh on both sides, above and below.", [&] {
    return typeLength("##mesh tolerance", nominal.tolerance, 0.0, 1e12, context.units.change, textOf("none"));
  });
}

}  // namespace

void comparePanel(const PanelContext& context, CompareTool& compare, WindowPicture& picture) {
  ImGui::BeginDisabled(compare.busy());
  beginFields();
  (void)field("it is moved", "How the other scan may move until it lies best on this one.",
              [&] { return chooseMoves("##compare moves", compare.options.moves, textOf("not")); });
  (void)field("by", "Which samples of this scan say where the other one comes to lie.", [&] {
    constexpr engine::Region kOf[] = {engine::Region::kAll, engine::Region::kMarked,
                                      engine::Region::kUnmarked};
    int of = 0;
    for (int i = 0; i < 3; ++i)
      if (compare.options.region == kOf[i]) of = i;
    const bool changed = chooseRegion("##compare by", of);
    if (changed) compare.options.region = kOf[of];
    return changed;
  });
  meshFields(context, compare.options.nominal);
  endFields();
  actionButton("Choose a scan", Action::kCompare, context.act);
  const auto* compared = compare.compared();
  ImGui::BeginDisabled(compared == nullptr);
  sameLineIfFits("Again");
  actionButton("Again##compare", Action::kCompareAgain, context.act);
  sameLineIfFits("Remove");
  if (pressButton("Remove##compare", "Forgets the other scan and its colours.")) {
    compare.clear();
    picture.refreshRanges();
    picture.requestRedraw();
  }
  if (tickBox("colours show the deviation from it", compare.shown,
              "Red where this scan is higher than the other, blue where it is lower. Marks are "
              "outlines meanwhile, unless a tool sets them.")) {
    picture.refreshRanges();
    picture.requestRedraw();
  }
  ImGui::EndDisabled();
  ImGui::EndDisabled();
  beginPlace("##compare outcome", compare.busy() || compared != nullptr ? kComparedLines : kUncomparedLines);
  if (compare.busy()) {
    if (cancelledBar(compare.progress(), compare.doing().c_str(), "Cancel##compare")) compare.cancel();
  } else if (compared != nullptr) {
    if (compare.outdated()) writeWrapped("the field has changed since: Again");
    writeWrapped(std::filesystem::path(compared->path).filename().string());
    for (const std::string& line : compare.lines()) writeWrapped(line);
  } else {
    writeIn(render::PanelColour::kMuted,
            "A scan of the same part, or its nominal mesh (.stl), is moved onto this one. Here stands how, "
            "and how far they "
            "differ.");
  }
  endPlace();
}

}  // namespace fettle::app
