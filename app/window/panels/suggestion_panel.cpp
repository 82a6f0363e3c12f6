#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"
#include "app/work/suggestion_text.h"

namespace fettle::app {
namespace {

constexpr int kListLines = 16;
constexpr double kMostError = 1e30, kMostBudget_s = 1e9;

void requestFields(const PanelContext& context, FilterSuggester& suggester) {
  beginFields();
  (void)field(
      "allowed error",
      "Root mean square error against the true surface that may be left, on flats and near edges. Of "
      "the filters that stay within it the one with the least computing is suggested. 0: half of the noise.",
      [&] {
        return typeLength("##allowed error", suggester.tolerance, 0.0, kMostError, context.units.change,
                          textOf("half of the noise"));
      });
  (void)field("time",
              "Filters that take longer for the whole scan are not suggested. 0: whatever time it takes.",
              [&] {
                return typeNumber("##time", suggester.budget_s, 0.0, kMostBudget_s,
                                  suggester.budget_s > 0.0 ? "%.4g s" : tr("0: any"));
              });
  endFields();
}

// A button of several lines as wide as there is room; true when it was pressed.
bool entry(int index, const std::string& text, bool chosen) {
  const float room = ImGui::GetContentRegionAvail().x;
  const std::string lines = inLines(text, room);
  const ImVec2 at = ImGui::GetCursorPos(), size = ImGui::CalcTextSize(lines.c_str());
  const bool pressed =
      ImGui::Selectable(fmt::format("##listed {}", index).c_str(), chosen, 0, ImVec2(0.0F, size.y));
  explain("Puts this filter into the fields below and shows its preview.");
  const ImVec2 after = ImGui::GetCursorPos();
  ImGui::SetCursorPos(at);
  ImGui::TextUnformatted(lines.c_str());
  ImGui::SetCursorPos(after);
  return pressed;
}

void take(const PanelContext& context, const engine::FilterCandidate& candidate, FilterPreview& filters,
          EdgeTool& edges) {
  filters.choose(candidate.spec);
  if (!candidate.around_edges) {
    context.act(Action::kFilterPreview);
    return;
  }
  // It was tried around marks, which only the user sets.
  edges.sigma = engine::EdgeMap::kUsualSigma;
  edges.choice = {};
  edges.choice.thickness = candidate.thickness;
  context.act(Action::kEdges);
  context.notices.push_back({tr("this filter goes around marked edges, which are suggested now"),
                             tr("take them as marks, then preview it (P)")});
}

void writeFound(const PanelContext& context, const FilterSuggester& suggester, FilterPreview& filters,
                EdgeTool& edges) {
  const FilterSuggester::Found& found = *suggester.found();
  const SuggestionWords words{context.units.change, candidateName};
  if (suggester.outdated()) writeIn(render::PanelColour::kWarning, "the scan has changed since: try again");
  int index = 0;
  ImGui::BeginDisabled(suggester.outdated() || filters.applying());
  for (const ListedFilter& each : listedFilters(found.suggestion, found.asked, words.unit)) {
    const engine::FilterCandidate& candidate = found.suggestion.candidates[each.candidate];
    const std::string text = trFormat("{}\n{}: leaves {}, takes about {}", words.method(candidate), each.why,
                                      leftText(candidate, words.unit), filterTimeText(candidate.seconds));
    if (entry(index++, text, filters.says(candidate.spec))) take(context, candidate, filters, edges);
    ImGui::Separator();
  }
  ImGui::EndDisabled();
  writeWrapped(reasonText(found.suggestion, found.asked, words));
}

}  // namespace

void suggestionPanel(const PanelContext& context, FilterSuggester& suggester, FilterPreview& filters,
                     EdgeTool& edges) {
  requestFields(context, suggester);
  ImGui::BeginDisabled(suggester.busy());
  if (ImGui::Button(labelOf("Try filters"))) suggester.search(context.client);
  tip(Action::kFilterSuggest);
  ImGui::EndDisabled();
  if (workRow(suggester.busy() ? std::optional(suggester.progress()) : std::nullopt, "trying filters",
              "Cancel"))
    suggester.cancel();
  beginPlace("##listed filters", kListLines);
  if (suggester.found() != nullptr)
    writeFound(context, suggester, filters, edges);
  else if (!suggester.nothing().empty())
    writeWrapped(trFormat("Nothing helps: {}", suggester.nothing()));
  else
    writeIn(render::PanelColour::kMuted,
            "Filters are tried on the scan as it is seen, with its marks; the best are listed here.");
  endPlace();
}

}  // namespace fettle::app
