// Lists and menus lie over other things: what a hand does in them is not done to those.
#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/end_to_end/window/work_panels.h"

namespace fettle::tests {
namespace {

using State = User::State;

// Where a text lies [left, top, width, height]; of several the last one, which lies over the others.
State boxOf(const State& now, const std::string& words) {
  State found;
  for (const State& text : now["texts"])
    if (text["text"] == words) found = text["at"];
  return found;
}

class ListsTest : public WindowTest {
 protected:
  void doubleClick(User& user, User::Place place) const {
    user.at(place);
    display.hands({"click", "--repeat", "2", "--delay", "90", "1"});
    (void)user.rest("after two clicks");
  }
};

TEST_F(ListsTest, two_clicks_on_an_entry_choose_it_and_press_no_button_below_it) {
  std::ofstream(folder.path() / "fettle" / "window.json") << State{{"panels", {{"Remove samples", true}}}};
  const auto program = start({scan});
  User user(display, *program, "lists");
  (void)opened(*program);
  for (const char* header : {"Tool", "Filters"}) (void)user.click(header);
  ASSERT_EQ(user.key("ctrl+i")["steps"], 1) << "all samples are marked";
  const engine::Version field = load(scan);
  const engine::HeightBounds bounds = field.reader().bounds();
  (void)user.enter(
      "lower than",
      fmt::format("{} mm", 0.5 * (static_cast<double>(bounds.min) + static_cast<double>(bounds.max)) *
                               field.grid().height_unit.mm));
  (void)user.click("samples not marked");
  const State open = program->until("the list", [](const State& s) {
    return s["settled"] == true && !boxOf(s, "all, marked too").is_null();
  });
  const State entry = boxOf(open, "marked samples"), button = boxOf(open, "Remove");
  ASSERT_FALSE(entry.is_null());
  ASSERT_FALSE(button.is_null());
  const int top = std::max(entry[1].get<int>(), button[1].get<int>());
  const int end =
      std::min(entry[1].get<int>() + entry[3].get<int>(), button[1].get<int>() + button[3].get<int>());
  ASSERT_LT(top + 2, end) << "the entry does not lie over the button: " << open["texts"].dump();
  doubleClick(user, {button[0].get<int>() + 10, (top + end) / 2});
  const State chosen = program->now();
  EXPECT_TRUE(boxOf(chosen, "all, marked too").is_null());
  EXPECT_FALSE(boxOf(chosen, "marked samples").is_null());
  EXPECT_GT(chosen["would_remove"].get<std::int64_t>(), 0) << "the button would have had something to do";
  EXPECT_EQ(chosen["steps"], 1) << chosen["heights_found"];
  // A click of its own does it.
  EXPECT_EQ(user.click("Remove")["steps"], 2);
  quitWithoutSaving(user);
}

TEST_F(ListsTest, two_clicks_on_an_entry_of_a_menu_do_nothing_to_the_scan_below_it) {
  const auto program = start({scan});
  User user(display, *program, "menus");
  (void)opened(*program);
  (void)user.key("7");
  (void)user.key("m");
  const State open = user.click("Marks");
  const State entry = boxOf(open, "Strokes of the mark tool become edge lines");
  ASSERT_FALSE(entry.is_null()) << open["texts"].dump();
  const User::Place place{entry[0].get<int>() + 20, entry[1].get<int>() + entry[3].get<int>() / 2};
  doubleClick(user, place);
  const State after = program->now();
  EXPECT_NE(after["draws_lines"], open["draws_lines"]) << "the first click is the menu's";
  EXPECT_TRUE(after["under_cursor"].is_array()) << "no scan lies there";
  EXPECT_EQ(after["steps"], 0);
  quit(user);
}

TEST_F(WindowTest, the_wheel_goes_on_with_the_panels_where_a_list_ends) {
  openPanels(folder, {"Steps", "Change since the scan", "Colours", "Display"});
  const auto program = start({scan});
  User user(display, *program, "wheel");
  (void)opened(*program);
  for (int i = 0; i < 12; ++i) (void)user.key("ctrl+i");
  const auto undo = [&] {
    const State now = program->now();
    for (const State& text : now["texts"])
      if (text["text"] == "Undo") return User::Place{text["at"][0], text["at"][1]};
    ADD_FAILURE() << "no button Undo: " << program->now()["texts"].dump();
    return User::Place{};
  };
  // The newest step is at the list's end.
  const User::Place before = undo();
  user.at({before.x, before.y + 60});
  (void)user.wheel(1);
  EXPECT_EQ(undo().y, before.y) << "the list alone";
  (void)user.wheel(-1);
  EXPECT_EQ(undo().y, before.y) << "back to its end";
  (void)user.look("at its end");
  (void)user.wheel(-1);
  EXPECT_LT(undo().y, before.y) << "and on with the panels";
  (void)quitWithoutSaving(user);
}

}  // namespace
}  // namespace fettle::tests
