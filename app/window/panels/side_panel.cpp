#include <utility>

#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

// Of the panels' height: a panel that begins above it shows what one came for.
constexpr float kInSight = 0.5F;

// A section of the panels that can be collapsed; its state is stored in the settings. Names of fields are its own: a text field and
// a list of one name in two sections would be one item, which ends the program when the field is typed into.
template <class Panel>
void section(Parts& parts, const char* name, bool open_at_first, const Panel& panel) {
  Settings& settings = parts.settings;
  const auto known = settings.panels.find(name);
  if (parts.enter_panel == name) {
    // A panel in sight stays where the hand is.
    const float below = ImGui::GetCursorScreenPos().y - ImGui::GetWindowPos().y;
    if (below < 0.0F || below > kInSight * ImGui::GetWindowHeight()) ImGui::SetScrollHereY(0.0F);
    parts.enter_panel.clear();
  }
  // In each frame: an action opens a panel by its setting, too.
  ImGui::SetNextItemOpen(known != settings.panels.end() ? known->second : open_at_first);
  const bool open = ImGui::CollapsingHeader(labelOf(name));
  tabGoesOn();
  settings.panels[name] = open;
  if (!open) return;
  ImGui::PushID(name);
  panel();
  ImGui::PopID();
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
  section(parts, "Tool", true, [&] { toolPanel(context, parts.stylus, parts.marking, settings.display); });
  section(parts, "Edges", false, [&] { edgePanel(context, parts.marking.edges); });
  section(parts, "Edge lines", false, [&] {
    placePanel(context, parts.marking.places);
    linePanel(context, parts.marking.lines, settings.draw_lines);
  });
  section(parts, "Suggested filters", false,
          [&] { suggestionPanel(context, parts.suggester, parts.filters, parts.marking.edges); });
  section(parts, "Filters", true,
          [&] { filterPanel(context, parts.filters, parts.heights, settings.display); });
  section(parts, "Remove samples", false,
          [&] { removePanel(context, parts.heights, parts.removal, parts.picture); });
  section(parts, "Holes and lines", false,
          [&] { heightsPanel(context, parts.heights, parts.line_suggester); });
  section(parts, "Form", false, [&] { formPanel(context, parts.form, parts.plane_points); });
  section(parts, "Steps", true, [&] { historyPanel(context, parts.marking.edit, parts.pointed_step); });
  section(parts, "Change since the scan", true, [&] { changePanel(context, parts.change); });
  section(parts, "Measure", false, [&] { measurePanel(context, parts.measure, parts.picture); });
  section(parts, "Section", false, [&] { sectionPanel(context, parts.section); });
  section(parts, "Fit", false, [&] { fitPanel(context, parts.fit, parts.picture); });
  section(parts, "Features", false, [&] { featurePanel(context, parts.features, parts.picture); });
  section(parts, "Transform", false, [&] {
    if (transformPanel(context, parts.transform)) parts.writeTransformed();
  });
  section(parts, "Join", false, [&] {
    if (joinPanel(context, parts.join)) parts.writeJoined();
  });
  section(parts, "Compare", false, [&] { comparePanel(context, parts.compare, parts.picture); });
  parts.colours.handles.reset();
  section(parts, "Colours", false,
          [&] { colourPanel(context, settings.display, parts.colours, parts.picture); });
  section(parts, "Display", false,
          [&] { displayPanel(context, settings, parts.picture, parts.view, parts.costs); });
  section(parts, "Status", false, [&] { statusPanel(context, parts.picture, parts.opening.times()); });
  section(parts, "Haptics", false, [&] { requests = hapticsPanel(context, parts); });
  ImGui::End();
  return requests;
}

}  // namespace fettle::app
