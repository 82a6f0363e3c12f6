#include "app/window/workstation.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <imgui.h>

#include "app/window/panels/widgets.h"
#include "render/plan/overlay.h"

namespace fettle::app {
namespace {

using haptic::Tool;

constexpr float kSide_px = 320.0F;

}  // namespace

void Workstation::panels() {
  if (questions_.pending()) leavePanels();
  menuBar();
  const float scale = static_cast<float>(window_->scale());
  const float top = ImGui::GetFrameHeight();
  const float bottom = ImGui::GetFrameHeight();
  const float width = ImGui::GetIO().DisplaySize.x, height = ImGui::GetIO().DisplaySize.y;
  if (side_width_ <= 0.0F)
    side_width_ = (settings_.side_width > 0.0F ? settings_.side_width : kSide_px) * scale;
  // A small window narrows the panels for as long as it is small.
  const float fits = std::clamp(side_width_, 160.0F * scale, std::max(0.6F * width, 161.0F * scale));
  const float side = side_panel_ && touch_ ? fits : 0.0F;
  if (side > 0.0F) {
    ImGui::SetNextWindowPos(ImVec2(width - side, top));
    ImGui::SetNextWindowSize(ImVec2(side, height - top - bottom));
    ImGui::SetNextWindowSizeConstraints(ImVec2(160.0F * scale, 0.0F), ImVec2(width, height));
    // ImGui rounds sizes, and has its own ideas about a window of no size: only a hand sets the width.
    const float drawn = sidePanel();
    if (std::abs(drawn - side) > 1.5F && ImGui::IsMouseDown(ImGuiMouseButton_Left)) side_width_ = drawn;
    settings_.side_width = side_width_ / scale;
  }
  statusBar();
  window_->setPictureArea(
      {0, static_cast<int>(top), static_cast<int>(width - side), static_cast<int>(height - top - bottom)});
  if (const bool announces = announcesPicture(); (!touch_ && !coarse_) || announces) {
    ImGui::SetNextWindowPos(ImVec2(0.5F * (width - side), 0.45F * height), ImGuiCond_Always,
                            ImVec2(0.5F, 0.5F));
    ImGui::Begin("##empty", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize |
                     ImGuiWindowFlags_NoSavedSettings);
    if (announces) {
      ImGui::Text("%s: making the first picture", std::filesystem::path(path_).filename().c_str());
    } else if (loading_.busy()) {
      ImGui::Text("%s: %s", std::filesystem::path(loading_path_).filename().c_str(), loading_.stage());
      ImGui::ProgressBar(static_cast<float>(loading_.progress()), ImVec2(360.0F * scale, 0.0F));
      if (ImGui::Button("Cancel")) loading_.cancel();
    } else {
      ImGui::TextUnformatted("Drop a scan here, or press Ctrl+O");
    }
    ImGui::End();
  }
  splitLine();
  drawLasso();
  dialogs();
}

render::Rectangle Workstation::plot() const {
  const render::Rectangle& area = window_->pictureArea();
  const auto layout =
      render::layOut(view_, display_.furniture ? render::Decoration::kFull : render::Decoration::kNone, 1,
                     shown_.versions.size() > 1 ? render::Titles::kAbove : render::Titles::kNone,
                     kFurniture * window_->scale());
  render::Rectangle rectangle = layout.plots.front();
  rectangle.x += area.x;
  rectangle.y += area.y;
  return rectangle;
}

void Workstation::splitLine() {
  if (!display_.split || shown_.versions.size() != 2 || display_.stereo != render::StereoMode::kOff) return;
  const render::Rectangle area = plot();
  const auto x = static_cast<float>(area.x + display_.split_at * area.width);
  const auto y = static_cast<float>(area.y + area.height / 2);
  ImGui::GetBackgroundDrawList()->AddCircleFilled(ImVec2(x, y), 7.0F * static_cast<float>(window_->scale()),
                                                  IM_COL32(255, 255, 255, 220));
}

void Workstation::statusBar() {
  const float height = ImGui::GetFrameHeight();
  ImGui::SetNextWindowPos(ImVec2(0.0F, ImGui::GetIO().DisplaySize.y - height));
  ImGui::SetNextWindowSize(ImVec2(ImGui::GetIO().DisplaySize.x, height));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(8.0F, 2.0F));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1.0F, 1.0F));
  ImGui::Begin("##status", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav);
  if (adjusting_ != Adjusting::kNothing) {
    const haptic::Scene& scene = touch_->scene();
    const bool marking = touch_->tool() == Tool::kMark || touch_->tool() == Tool::kUnmark;
    const std::string now =
        adjusting_ == Adjusting::kRadius
            ? fmt::format("brush radius {:.3g} samples",
                          marking ? scene.mark_radius_samples : scene.brush_radius_samples)
            : fmt::format("press depth {:.4g} mm", touch_->mouse()->pressMm());
    ImGui::TextUnformatted(
        fmt::format("{} {}: move or type, Enter or left button keeps it, Esc or right button leaves it", now,
                    typed_.empty() ? "" : "[" + typed_ + "]")
            .c_str());
  } else if (lasso_.active()) {
    ImGui::TextUnformatted(
        lasso_.shape() == Lasso::Shape::kBox
            ? "box: drag, or corners with arrows and Space; Enter marks, Ctrl+Enter unmarks, Esc leaves"
            : "lasso: draw, or corners by click or arrows and Space; Enter or right button marks, with Ctrl "
              "unmarks; Esc leaves");
  } else if (edges_.suggestion() != nullptr) {
    ImGui::TextUnformatted(
        fmt::format(
            "suggested: {} lines; Enter takes them, Ctrl+[ and Ctrl+] fewer and more, M and U paint over "
            "them, Esc drops them",
            edges_.suggestion()->lines)
            .c_str());
  } else if (saving_.busy()) {
    ImGui::ProgressBar(static_cast<float>(saving_.progress()), ImVec2(240.0F, 0.0F), "saving");
    ImGui::SameLine();
    if (ImGui::SmallButton("Cancel")) saving_.cancel();
  } else if (keeper_ && keeper_->saving()) {
    ImGui::ProgressBar(static_cast<float>(keeper_->progress()), ImVec2(240.0F, 0.0F), "saving");
    ImGui::SameLine();
    if (ImGui::SmallButton("Cancel")) keeper_->cancelSaving();
  } else if (coarse_) {
    ImGui::ProgressBar(static_cast<float>(loading_.progress()), ImVec2(160.0F, 0.0F), "reading");
    ImGui::SameLine();
    if (ImGui::SmallButton("Cancel")) loading_.cancel();
    ImGui::SameLine();
    ImGui::TextUnformatted(coarseText().c_str());
  } else if (touch_ && loading_.busy()) {
    ImGui::ProgressBar(static_cast<float>(loading_.progress()), ImVec2(240.0F, 0.0F), "opening");
    ImGui::SameLine();
    if (ImGui::SmallButton("Cancel")) loading_.cancel();
  } else {
    std::string text = status_text_;
    if (touch_) {
      if (const std::string kept = sessionText(); !kept.empty()) text += "  (" + kept + ")";
      if (tool_on_ && under_cursor_) {
        const engine::Grid& grid = touch_->field().grid();
        text += fmt::format("   x {:.4f}  y {:.4f}  z {:.5g} {}",
                            grid.origin_x + under_cursor_->position_mm.x / grid.lateral_unit.mm,
                            grid.origin_y + under_cursor_->position_mm.y / grid.lateral_unit.mm,
                            under_cursor_->position_mm.z / grid.height_unit.mm, grid.height_unit.name);
      }
    }
    ImGui::TextUnformatted(text.c_str());
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
}

// A part of the panels that can be folded away, and is found as it was left.
bool Workstation::section(const char* name, bool open_at_first) {
  const auto known = settings_.panels.find(name);
  ImGui::SetNextItemOpen(known != settings_.panels.end() ? known->second : open_at_first, ImGuiCond_Once);
  const bool open = ImGui::CollapsingHeader(name);
  settings_.panels[name] = open;
  return open;
}

// Its width: what it was given, or what the user pulled it to.
float Workstation::sidePanel() {
  ImGui::Begin("Panels", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoBringToFrontOnFocus);
  const float width = ImGui::GetWindowSize().x;
  if (std::exchange(enter_panels_, false)) {
    ImGui::SetWindowFocus();
    ImGui::SetKeyboardFocusHere();
  }
  for (const Notice& notice : notices_) {
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextColored(ImVec4(1.0F, 0.75F, 0.3F, 1.0F), "%s%s%s", notice.what.c_str(),
                       notice.remedy.empty() ? "" : ": ", notice.remedy.c_str());
    ImGui::PopTextWrapPos();
  }
  if (!notices_.empty() && ImGui::SmallButton("Understood")) notices_.clear();
  if (section("Tool", true)) toolPanel();
  if (section("Edges", false)) edgePanel();
  if (section("Filters", true)) filterPanel();
  if (section("Steps", true)) historyPanel();
  if (section("Change since the scan", true)) deviationPanel();
  if (section("Display", false)) displayPanel();
  if (section("Status", true)) statusPanel();
  if (section("Haptics", false)) hapticsPanel();
  ImGui::End();
  return width;
}

}  // namespace fettle::app
