#include <array>
#include <string_view>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"

namespace fettle::app {
namespace {

constexpr std::array<std::string_view, 8> kMenus{"File",  "Edit", "Filter", "Tool",
                                                 "Marks", "View", "Device", "Help"};
constexpr int kGroups = 3;  // of a menu, at most
// Of the menu of marks, and looked for among the tools as well: the radial menu has them there.
constexpr std::array kToolsToo{Action::kBox, Action::kLasso};

void item(const ActionRow& row, const Parts& parts, const Act& act) {
  const bool ticked = row.ticked != nullptr && row.ticked(parts);
  const bool enabled = row.enabled != nullptr ? row.enabled(parts) : ready(row, parts);
  if (ImGui::MenuItem(labelOf(std::string(row.name).c_str()), keyText(row.key, row.modifiers).c_str(), ticked,
                      enabled))
    act(row.action);
}

void items(std::string_view menu, int group, const Parts& parts, const Act& act) {
  for (const ActionRow& row : actions())
    if (row.menu.group == group && row.menuTitle() == menu) item(row, parts, act);
  if (menu == "Tool" && group == 1)
    for (const Action action : kToolsToo) item(rowOf(action), parts, act);
}

bool hasItems(std::string_view menu, int group) {
  return std::ranges::any_of(
      actions(), [&](const ActionRow& row) { return row.menu.group == group && row.menuTitle() == menu; });
}

std::optional<std::string> recentFiles(const RecentFiles& recent) {
  std::optional<std::string> chosen;
  if (!ImGui::BeginMenu(labelOf("Recent files"), !recent.paths().empty())) return chosen;
  for (std::size_t i = 0; i < recent.paths().size(); ++i)
    if (ImGui::MenuItem(recent.paths()[i].c_str(), trFormat("Ctrl+{}", i + 1).c_str()))
      chosen = recent.paths()[i];
  ImGui::EndMenu();
  return chosen;
}

void mouseHabits(Habits& habits) {
  if (!ImGui::BeginMenu(labelOf("Mouse"))) return;
  for (const MousePreset& preset : kMousePresets)
    if (ImGui::MenuItem(labelOf(preset.line.data()), nullptr, habits == preset.habits))
      habits = preset.habits;
  ImGui::EndMenu();
}

void bookmarks(const Parts& parts, const Act& act) {
  if (!ImGui::BeginMenu(labelOf("Bookmarks"))) return;
  items("Bookmarks", 1, parts, act);
  ImGui::Separator();
  items("Bookmarks", 2, parts, act);
  ImGui::EndMenu();
}

}  // namespace

std::optional<std::string> menuBar(Parts& parts, const Act& act) {
  std::optional<std::string> chosen;
  if (!ImGui::BeginMainMenuBar()) return chosen;
  for (const std::string_view menu : kMenus) {
    if (!ImGui::BeginMenu(labelOf(menu.data()))) continue;
    const bool file = menu == "File";
    for (int group = 1; group <= kGroups && hasItems(menu, group); ++group) {
      if (group > 1 && !file) ImGui::Separator();
      if (group == 3 && menu == "View") mouseHabits(parts.settings.habits);
      if (group == 3 && file) {
        bool& asks = parts.settings.ask_before_quitting;
        if (ImGui::MenuItem(labelOf("Ask before quitting with unsaved work"), nullptr, asks)) asks = !asks;
      }
      items(menu, group, parts, act);
      if (group == 2 && menu == "View") bookmarks(parts, act);
      if (group == 1 && file) chosen = recentFiles(parts.recent);
    }
    ImGui::EndMenu();
  }
  ImGui::EndMainMenuBar();
  return chosen;
}

}  // namespace fettle::app
