#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {

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
    for (std::int64_t i = history.first() + 1; i <= history.last(); ++i) {
      const engine::StepInfo& info = history.info(i);
      const std::string text = fmt::format("{}  {}   {}###step {}", i, tr(std::string_view(info.name)),
                                           bytesText(static_cast<double>(info.bytes)), i);
      if (i > history.number()) ImGui::PushStyleColor(ImGuiCol_Text, colourOf(render::PanelColour::kMuted));
      if (ImGui::Selectable(text.c_str(), i == history.number())) chosen = i;
      if (ImGui::IsItemHovered()) pointed = i;
      if (i > history.number()) ImGui::PopStyleColor();
    }
    if (chosen >= 0) {
      edit.cancel();
      context.client.goTo(chosen);
    }
  }
  ImGui::EndChild();
}

}  // namespace fettle::app
