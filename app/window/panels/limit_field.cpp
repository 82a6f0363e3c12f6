#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {

bool limitField(const PanelContext& context, std::optional<double>& limit, Action switches) {
  const char* const from_what = tr("of the scan");
  constexpr const char* kSays = textOf(
      "No height moves farther than this from the scan as it was opened, however many steps lie between.");
  return field("keep within", kSays, [&] {
    actionTick("##limited", limit.has_value(), switches, context.act);
    restOfLine();
    if (!limit) {
      noField("no limit");
      return false;
    }
    // From what it counts, where there is room for that and the number.
    const float room = ImGui::GetContentRegionAvail().x,
                from = ImGui::CalcTextSize(from_what).x + ImGui::GetStyle().ItemInnerSpacing.x;
    const bool fits = room > 2.0F * from;
    if (fits) ImGui::SetNextItemWidth(room - from);
    const bool changed = typeLength("##limit", *limit, 0.0, 1e9, context.units.change);
    if (fits) {
      ImGui::SameLine(0.0F, ImGui::GetStyle().ItemInnerSpacing.x);
      ImGui::TextDisabled("%s", from_what);
    }
    return changed;
  });
}

}  // namespace fettle::app
