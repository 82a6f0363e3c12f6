#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {

namespace {

// Shown again when another step is the present one: the newest one is at the end of a list that shows six.
void scrollTo(std::int64_t present, ImGuiID list) {
  ImGuiStorage& kept = *ImGui::GetStateStorage();
  if (kept.GetInt(list, -1) == static_cast<int>(present)) return;
  kept.SetInt(list, static_cast<int>(present));
  ImGui::SetScrollHereY(0.5F);
}

// Above undone steps, which are a list to go forward in until something else is done.
void saysWhatGoes() {
  writeIn(render::PanelColour::kMuted, "a change now takes the place of these:");
}

}  // namespace

void historyPanel(const PanelContext& context, MarkEdit& edit, std::optional<std::int64_t>& pointed) {
  const engine::History& history = context.client.history();
  actionButton("Undo", Action::kUndo, context.act);
  ImGui::SameLine();
  actionButton("Redo", Action::kRedo, context.act);
  const std::string held =
      trPlural("{} step, {}", "{} steps, {}", static_cast<unsigned long long>(history.last()), history.last(),
               bytesText(static_cast<double>(history.bytes())));
  sameLineIfFits(held.c_str());
  ImGui::TextDisabled("%s", held.c_str());
  constexpr float kSteps = 6.0F;  // whether there are as many or not: what is below stays where it is
  if (ImGui::BeginChild("steps", ImVec2(0.0F, kSteps * ImGui::GetTextLineHeightWithSpacing() + 8.0F), true)) {
    std::int64_t chosen = -1;
    if (history.first() == 0 && ImGui::Selectable(labelOf("0  the scan"), history.number() == 0)) chosen = 0;
    if (history.number() == 0 && history.last() > 0) saysWhatGoes();
    for (std::int64_t i = history.first() + 1; i <= history.last(); ++i) {
      const engine::StepInfo& info = history.info(i);
      // A name that fills the row has it alone: a size cut in the middle reads as another one.
      const std::string name = fmt::format("{}  {}", i, tr(std::string_view(info.name))),
                        sized = fmt::format("{}   {}", name, bytesText(static_cast<double>(info.bytes)));
      const bool fits = ImGui::CalcTextSize(sized.c_str()).x <= ImGui::GetContentRegionAvail().x;
      const std::string text = fmt::format("{}###step {}", fits ? sized : name, i);
      if (i > history.number()) ImGui::PushStyleColor(ImGuiCol_Text, colourOf(render::PanelColour::kMuted));
      if (ImGui::Selectable(text.c_str(), i == history.number())) chosen = i;
      if (i == history.number()) scrollTo(i, ImGui::GetID("present"));
      if (ImGui::IsItemHovered()) pointed = i;
      if (i > history.number()) ImGui::PopStyleColor();
      if (i == history.number() && i < history.last()) saysWhatGoes();
    }
    if (chosen >= 0) {
      edit.cancel();
      context.client.goTo(chosen);
    }
  }
  const float wheel = wheelPastEnd();
  ImGui::EndChild();
  scrollOn(wheel);
}

}  // namespace fettle::app
