#include "app/window/actions.h"

#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

TEST(Actions, every_action_has_one_line_a_key_and_a_name) {
  std::set<Action> seen;
  for (const ActionRow& s : actions()) {
    EXPECT_TRUE(seen.insert(s.action).second) << s.name;
    EXPECT_NE(s.key, render::Key::kNone) << s.name;
    EXPECT_FALSE(s.name.empty());
    EXPECT_EQ(actionOf(s.key, s.modifiers), s.action) << s.name;
    EXPECT_FALSE(keyText(s.key, s.modifiers).empty()) << s.name;
  }
  for (int i = 0; i < static_cast<int>(Action::kCount); ++i)
    EXPECT_TRUE(seen.contains(static_cast<Action>(i))) << "action " << i;
}

TEST(Actions, no_key_stands_for_two_actions) {
  std::map<std::tuple<render::Key, bool, bool, bool>, std::string_view> keys;
  for (const ActionRow& s : actions())
    for (const auto& [key, modifiers] :
         {std::pair{s.key, s.modifiers}, std::pair{s.other_key, s.modifiersOfOther()}}) {
      if (key == render::Key::kNone) continue;
      EXPECT_EQ(actionOf(key, modifiers), s.action) << s.name;
      const auto [at, fresh] =
          keys.emplace(std::tuple{key, modifiers.control, modifiers.shift, modifiers.alt}, s.name);
      EXPECT_TRUE(fresh) << s.name << " and " << at->second;
    }
}

TEST(Actions, both_habits_redo) {
  using render::letter;
  EXPECT_EQ(actionOf(letter('Z'), {.control = true, .shift = true}), Action::kRedo);
  EXPECT_EQ(actionOf(letter('Y'), {.control = true}), Action::kRedo);
  EXPECT_NE(actionOf(letter('Y'), {.control = true, .shift = true}), Action::kRedo);
}

TEST(Actions, disarming_gives_way_to_typing_alone_and_pause_to_nothing) {
  const ActionRow& disarm = rowOf(Action::kDisarm);
  EXPECT_TRUE(disarms(disarm.key, disarm.modifiers, Typing::kNo));
  EXPECT_FALSE(disarms(disarm.key, disarm.modifiers, Typing::kYes));
  for (const bool held : {false, true})
    for (const Typing typing : {Typing::kNo, Typing::kYes})
      EXPECT_TRUE(disarms(render::Key::kPause, {held, held, held}, typing));
  for (const ActionRow& s : actions())
    EXPECT_EQ(disarms(s.key, s.modifiers, Typing::kNo), s.action == Action::kDisarm) << s.name;
}

TEST(Actions, stand_together_by_section) {
  std::set<std::string_view> past;
  std::string_view section;
  for (const ActionRow& s : actions()) {
    if (s.section == section) continue;
    EXPECT_TRUE(past.insert(s.section).second) << s.section;
    section = s.section;
  }
}

TEST(Actions, stand_in_menus_without_a_gap_between_groups) {
  std::map<std::string_view, std::set<int>> groups;
  for (const ActionRow& s : actions())
    if (s.menu.group > 0) groups[s.menuTitle()].insert(s.menu.group);
  EXPECT_EQ(groups.size(), 9U) << "eight menus, and bookmarks in one of them";
  for (const auto& [menu, found] : groups) EXPECT_EQ(*found.rbegin(), static_cast<int>(found.size())) << menu;
}

TEST(Actions, what_was_before_is_found_in_the_view_menu) {
  const ActionRow& row = rowOf(Action::kShowBefore);
  EXPECT_EQ(row.menuTitle(), "View");
  EXPECT_GT(row.menu.group, 0);
  ASSERT_NE(row.ticked, nullptr) << "from the menu it stays until it is chosen again";
}

}  // namespace
}  // namespace fettle::app
