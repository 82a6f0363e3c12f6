#include <utility>

#include <imgui.h>

#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

// A section of the panels that can be collapsed; its state is stored in the settings.
bool section(Parts& parts, const char* name, bool open_at_first) {
  Settings& settings = parts.settings;
  const auto known = settings.panels.find(name);
  if (parts.enter_panel == name) {
    ImGui::SetScrollHereY(0.0F);
    parts.enter_panel.clear();
  }
  // In each frame: an action opens a panel by its setting, too.
  ImGui::SetNextItemOpen(known != settings.panels.end() ? known->second : open_at_first);
  const bool open = ImGui::CollapsingHeader(name);
  settings.panels[name] = open;
  return open;
}

}  // namespace

LoopRequests sidePanel(Parts& parts, const Act& act, float& width) {
  LoopRequests requests;
  Settings& settings = parts.settings;
  ImGui::Begin("Panels", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_AlwaysVerticalScrollbar);
  width = ImGui::GetWindowSize().x;
  if (std::exchange(parts.enter_panels, false)) {
    ImGui::SetWindowFocus();
    ImGui::SetKeyboardFocusHere();
  }
  const PanelContext context{*parts.document.client(), parts.feedback.notices, act, parts.units};
  if (section(parts, "Tool", true)) toolPanel(context, parts.stylus, parts.marking, settings.display);
  if (section(parts, "Edges", false)) edgePanel(context, parts.marking.edges);
  if (section(parts, "Edge lines", false)) {
    placePanel(context, parts.marking.places);
    linePanel(context, parts.marking.lines, settings.draw_lines);
  }
  if (section(parts, "Suggested filters", false))
    suggestionPanel(context, parts.suggester, parts.filters, parts.marking.edges);
  if (section(parts, "Filters", true)) filterPanel(context, parts.filters, settings.display);
  if (section(parts, "Remove samples", false))
    removePanel(context, parts.heights, parts.removal, parts.picture);
  if (section(parts, "Holes and lines", false)) heightsPanel(context, parts.heights);
  if (section(parts, "Form", false)) formPanel(context, parts.form, parts.plane_points);
  if (section(parts, "Steps", true)) historyPanel(context, parts.marking.edit, parts.pointed_step);
  if (section(parts, "Change since the scan", true)) changePanel(context, parts.change);
  if (section(parts, "Measure", false)) measurePanel(context, parts.measure, parts.picture);
  if (section(parts, "Section", false)) sectionPanel(context, parts.section);
  if (section(parts, "Fit", false)) fitPanel(context, parts.fit, parts.picture);
  if (section(parts, "Features", false)) featurePanel(context, parts.features, parts.picture);
  if (section(parts, "Transform", false) && transformPanel(context, parts.transform))
    parts.writeTransformed();
  if (section(parts, "Join", false) && joinPanel(context, parts.join)) parts.writeJoined();
  if (section(parts, "Compare", false)) comparePanel(context, parts.compare, parts.picture);
  parts.colours.handles.reset();
  if (section(parts, "Colours", false)) colourPanel(context, settings.display, parts.colours, parts.picture);
  if (section(parts, "Display", false))
    displayPanel(context, settings, parts.picture, parts.view, parts.costs);
  if (section(parts, "Status", false)) statusPanel(context, parts.picture, parts.opening.times());
  if (section(parts, "Haptics", false)) requests = hapticsPanel(context, parts);
  ImGui::End();
  return requests;
}

}  // namespace fettle::app
