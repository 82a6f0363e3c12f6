#include "app/window/workstation.h"

#include <fmt/format.h>
#include <imgui.h>

#include "app/window/panels/widgets.h"

namespace fettle::app {
namespace {

using haptic::Tool;

}  // namespace

void Workstation::menuItem(Action action, bool enabled, bool ticked) {
  const Shortcut& s = shortcutOf(action);
  if (ImGui::MenuItem(std::string(s.name).c_str(), keyText(s.key, s.modifiers).c_str(), ticked, enabled))
    act(action);
}

void Workstation::menuBar() {
  if (!ImGui::BeginMainMenuBar()) return;
  const bool field = touch_ != nullptr;
  if (ImGui::BeginMenu("File")) {
    menuItem(Action::kOpen);
    if (ImGui::BeginMenu("Recent files", !recent_.paths().empty())) {
      const std::vector<std::string> paths = recent_.paths();
      for (std::size_t i = 0; i < paths.size(); ++i)
        if (ImGui::MenuItem(paths[i].c_str(), fmt::format("Ctrl+{}", i + 1).c_str())) askToOpen(paths[i]);
      ImGui::EndMenu();
    }
    menuItem(Action::kSave, field);
    menuItem(Action::kSaveAs, field);
    menuItem(Action::kExport, field);
    if (ImGui::MenuItem("Ask before quitting with unsaved work", nullptr, settings_.ask_before_quitting))
      settings_.ask_before_quitting = !settings_.ask_before_quitting;
    menuItem(Action::kQuit);
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Edit")) {
    menuItem(Action::kUndo, field && touch_->canUndo());
    menuItem(Action::kRedo, field && touch_->canRedo());
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Filter")) {
    for (const Action a : {Action::kFilterNext, Action::kWindowLarger, Action::kWindowSmaller,
                           Action::kMorePasses, Action::kFewerPasses})
      menuItem(a, field);
    menuItem(Action::kFilterScope, field, filters_.spec.scope == engine::FilterScope::kOnlyMarks);
    menuItem(Action::kFilterMaxChange, field, filters_.spec.max_change.has_value());
    ImGui::Separator();
    menuItem(Action::kFilterPreview, field);
    menuItem(Action::kFilterBeside, field);
    menuItem(Action::kFilterDrop, field && !filters_.variants().empty());
    menuItem(Action::kFilterApply, field && (!filters_.variants().empty() || edges_.suggestion() != nullptr));
    menuItem(Action::kSplitPreview, field, display_.split);
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Tool")) {
    const auto on = [&](Tool tool) { return tool_on_ && touch_ && touch_->tool() == tool; };
    menuItem(Action::kNavigate, field, !tool_on_);
    menuItem(Action::kFeel, field, on(Tool::kFeel));
    menuItem(Action::kSmooth, field, on(Tool::kSmooth));
    menuItem(Action::kMark, field, on(Tool::kMark));
    menuItem(Action::kUnmark, field, on(Tool::kUnmark));
    ImGui::Separator();
    for (const Action a :
         {Action::kBrushRadius, Action::kBrushStrength, Action::kBrushSmaller, Action::kBrushLarger})
      menuItem(a, field);
    menuItem(Action::kKeepWithin, field, field && touch_->scene().max_change.has_value());
    menuItem(Action::kInvert, field, field && touch_->scene().invert);
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Marks")) {
    menuItem(Action::kLasso, field, lasso_.active() && lasso_.shape() == Lasso::Shape::kFree);
    menuItem(Action::kBox, field, lasso_.active() && lasso_.shape() == Lasso::Shape::kBox);
    ImGui::Separator();
    for (const Action a : {Action::kEdges, Action::kEdgesMore, Action::kEdgesFewer, Action::kEdgesThicker,
                           Action::kEdgesThinner, Action::kEdgesCoarser, Action::kEdgesFiner})
      menuItem(a, field);
    ImGui::Separator();
    menuItem(Action::kShowMarks, field, display_.marks);
    menuItem(Action::kInvertMarks, field);
    menuItem(Action::kClearMarks, field);
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("View")) {
    menuItem(Action::kDeviation, field, display_.deviation);
    menuItem(Action::kContours, field, display_.contours);
    menuItem(Action::kNextMap, field);
    menuItem(Action::kStereo, field, display_.stereo != render::StereoMode::kOff);
    menuItem(Action::kTheme, field, display_.theme == render::Theme::kLight);
    menuItem(Action::kFurniture, field, display_.furniture);
    ImGui::Separator();
    for (const Action a : {Action::kViewAll, Action::kViewLastStroke, Action::kViewFront, Action::kViewBack,
                           Action::kViewRight, Action::kViewLeft, Action::kViewTop, Action::kProjection,
                           Action::kZoomIn, Action::kZoomOut})
      menuItem(a, a == Action::kViewLastStroke ? field : seenGrid() != nullptr);
    ImGui::Separator();
    if (ImGui::BeginMenu("Mouse")) {
      const auto choice = [&](const char* name, Habits habits) {
        if (ImGui::MenuItem(name, nullptr, habits_ == habits)) habits_ = habits;
      };
      choice("Blender: middle turns, Shift+middle moves", Habits::kBlender);
      choice("CloudCompare: left turns, right moves", Habits::kCloudCompare);
      choice("MeshLab: middle turns, right moves", Habits::kMeshLab);
      ImGui::EndMenu();
    }
    menuItem(Action::kSidePanel, true, side_panel_);
    menuItem(Action::kEnterPanels, field);
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Device")) {
    for (const Action a : {Action::kArm, Action::kDisarm, Action::kCalibrate}) menuItem(a, field);
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Help")) {
    menuItem(Action::kShortcuts);
    ImGui::EndMenu();
  }
  ImGui::EndMainMenuBar();
}

}  // namespace fettle::app
