#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <imgui.h>
#include <imgui_internal.h>  // the window under the cursor

#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

constexpr float kSide = 320.0F;  // of the side panel, at scale 1 [pixels]
constexpr float kNarrowest = 160.0F;

// The height under the panels, which end at `bottom`, that notices have now.
float roomOfNotices(Parts& parts, float side, float bottom) {
  const ImGuiIO& io = ImGui::GetIO();
  const auto now = NoticeRoom::Clock::now();
  if (ImGui::IsAnyMouseDown() && io.MousePos.x >= io.DisplaySize.x - side)
    parts.notice_room.press(bottom - io.MousePos.y, now);
  const bool inside = io.MousePos.x >= io.DisplaySize.x - side && io.MousePos.x < io.DisplaySize.x;
  parts.notice_room.point(inside ? bottom - io.MousePos.y : -1.0F, inside ? io.MousePos.x : -1.0F, now);
  return parts.notice_room.follow(noticesHeight(parts.feedback.notices, side), now);
}

// The side panel with the menus above and the status bar below, both `bar` high; returns the remaining width.
float sideOf(Parts& parts, const Act& act, float bar, LoopRequests& requests) {
  const auto scale = static_cast<float>(parts.window.scale());
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  if (!parts.settings.side_panel || !parts.document.isOpen()) return size.x;
  float& set = parts.settings.side_width;
  if (set <= 0.0F) set = kSide;
  // A small window narrows the panels only as long as it is small.
  const float side =
      std::clamp(set * scale, kNarrowest * scale, std::max(0.6F * size.x, (kNarrowest + 1.0F) * scale));
  ImGui::SetNextWindowPos(ImVec2(size.x - side, bar));
  const float said = roomOfNotices(parts, side, size.y - bar), height = size.y - 2.0F * bar - said;
  ImGui::SetNextWindowSize(ImVec2(side, height));
  ImGui::SetNextWindowSizeConstraints(ImVec2(kNarrowest * scale, 0.0F), size);
  // ImGui rounds sizes, and changes those of a window without size: only the user sets the width.
  float drawn = side;
  requests = sidePanel(parts, act, drawn);
  if (said > 0.0F)
    noticePanel(parts.feedback.notices, act, ImVec2(size.x - side, bar + height), ImVec2(side, said),
                NoticesLie::kBesideTheRest);
  if (std::abs(drawn - side) > 1.5F && ImGui::IsMouseDown(ImGuiMouseButton_Left)) set = drawn / scale;
  return size.x - side;
}

// Over the picture, where no panels are: in full screen, with the panels hidden, before a scan is open.
void noticesAlone(Parts& parts, const Act& act, float bar) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float width = std::min(kSide * static_cast<float>(parts.window.scale()), screen.x);
  const float height = noticesHeight(parts.feedback.notices, width);
  if (height <= 0.0F) return;
  noticePanel(parts.feedback.notices, act, ImVec2(screen.x - width, screen.y - bar - height),
              ImVec2(width, height), NoticesLie::kOverTheRest);
}

// Takes the second press of a double click on an entry from what the list covered: the first one closed it.
void leaveSecondPress(ListPress& press) {
  ImGuiIO& io = ImGui::GetIO();
  if (!io.MouseClicked[ImGuiMouseButton_Left]) return;
  const ImGuiWindow* const under = ImGui::GetCurrentContext()->HoveredWindow;
  const int kind =
      under == nullptr ? 0 : under->RootWindow->Flags & (ImGuiWindowFlags_Popup | ImGuiWindowFlags_Modal);
  if (!press.press(io.MousePos.x, io.MousePos.y, kind == ImGuiWindowFlags_Popup, ListPress::Clock::now()))
    return;
  io.MouseClicked[ImGuiMouseButton_Left] = false;
  io.MouseDoubleClicked[ImGuiMouseButton_Left] = false;
  io.MouseClickedCount[ImGuiMouseButton_Left] = 0;
}

// Tab without a field that is typed into asks for the first stop of the window, though a header, a button or a list has the focus:
// it goes on from there (tabGoesOn).
void tabFromTheFocus() {
  ImGuiContext& g = *ImGui::GetCurrentContext();
  const bool asks = g.NavMoveScoringItems && (g.NavMoveFlags & ImGuiNavMoveFlags_Tabbing) != 0;
  if (asks && g.NavTabbingDir == 0 && g.NavId != 0) g.NavTabbingDir = 1;
}

}  // namespace

PanelRequests layOutPanels(Parts& parts) {
  PanelRequests requests;
  tabFromTheFocus();
  leaveSecondPress(parts.list_press);
  usePanelTheme(parts.settings.panels_theme);
  const std::optional<std::int64_t> pointed_before = std::exchange(parts.pointed_step, std::nullopt);
  const Act act = [&parts](Action action) { carryOut(action, parts); };
  if (parts.feedback.questions.pending()) parts.leavePanels();
  const bool alone = parts.full_screen;
  if (!alone) requests.open = menuBar(parts, act);
  const float bar = ImGui::GetFrameHeight();
  const float top = alone ? 0.0F : bar;
  const float screen = ImGui::GetIO().DisplaySize.x;
  const float width = alone ? screen : sideOf(parts, act, bar, requests.loop);
  if (width >= screen) noticesAlone(parts, act, bar);
  statusBar(parts);
  parts.window.setPictureArea({0, static_cast<int>(top), static_cast<int>(width),
                               static_cast<int>(ImGui::GetIO().DisplaySize.y - bar - top)});
  placeholder(parts, width, act, requests);
  if (parts.pointed_step != pointed_before) parts.picture.requestRedraw();
  pictureOverlay(parts);
  radialOverlay(parts);
  requests.answer = dialog(parts);
  return requests;
}

}  // namespace fettle::app
