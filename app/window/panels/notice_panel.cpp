// Notices, under the panels, where what comes and goes moves no row of theirs, or over the picture where there are none.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

using render::PanelColour;

constexpr float kMostOfHeight = 0.35F;  // of the window's, more of them scroll
constexpr float kTopLine = 2.0F;        // [pixels]

std::string noticeText(const Notice& notice) {
  const std::string_view what = tr(std::string_view(notice.what)),
                         remedy = tr(std::string_view(notice.remedy));
  return remedy.empty() ? std::string(what) : fmt::format("{}: {}", what, remedy);
}

}  // namespace

float noticesHeight(const std::vector<Notice>& notices, float width) {
  if (notices.empty()) return 0.0F;
  const ImGuiStyle& style = ImGui::GetStyle();
  float height = 2.0F * style.WindowPadding.y + ImGui::GetTextLineHeight();  // of the buttons
  const float room = width - 2.0F * style.WindowPadding.x;
  for (const Notice& notice : notices)
    height += style.ItemSpacing.y +
              ImGui::CalcTextSize(inLines(noticeText(notice), room).c_str(), nullptr, false, room).y;
  return std::min(std::ceil(height), kMostOfHeight * ImGui::GetIO().DisplaySize.y);
}

void noticePanel(const std::vector<Notice>& notices, const Act& act, ImVec2 corner, ImVec2 size,
                 NoticesLie lie) {
  ImGui::SetNextWindowPos(corner);
  ImGui::SetNextWindowSize(size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1.0F, 1.0F));
  ImGui::Begin("Notices", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing |
                   (lie == NoticesLie::kBesideTheRest ? ImGuiWindowFlags_NoBringToFrontOnFocus : 0));
  ImGui::GetWindowDrawList()->AddLine(corner, ImVec2(corner.x + size.x, corner.y),
                                      colourOf(PanelColour::kWarning), kTopLine);
  for (const Notice& notice : notices) writeIn(PanelColour::kWarning, noticeText(notice));
  if (std::ranges::any_of(notices, &Notice::of_reading)) {
    if (ImGui::SmallButton(labelOf("Read as ..."))) act(Action::kReadAs);
    tip(Action::kReadAs);
    ImGui::SameLine();
  }
  if (ImGui::SmallButton(labelOf("Understood"))) act(Action::kUnderstood);
  tip(Action::kUnderstood);
  ImGui::End();
  ImGui::PopStyleVar();
}

}  // namespace fettle::app
