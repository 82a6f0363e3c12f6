// What the hand holds: the stylus as a pen with its shadow, the brush's falloff and spacing, Shift that smooths, the
// tools around the cursor.
#include <csignal>
#include <fstream>
#include <string>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;
using Place = User::Place;

constexpr Place kOnPart{330, 400};

class HandTools : public WindowTest {
 protected:
  // Only these panels are open.
  void openOnly(const std::vector<std::string>& names, const State& others = State::object()) const {
    State panels;
    for (const char* closed : {"Tool", "Filters", "Steps", "Change since the scan"}) panels[closed] = false;
    for (const std::string& name : names) panels[name] = true;
    State settings{{"edge_lines", false}, {"panels", panels}};
    settings.update(others);
    std::ofstream(folder.path() / "fettle" / "window.json") << settings;
  }
  void hold(const std::string& key) const { display.hands({"keydown", key}); }
  void letGo(const std::string& key) const { display.hands({"keyup", key}); }
  // The end, whether something was changed or not.
  static void end(ViewProgram& program) {
    program.signal(SIGTERM);
    EXPECT_EQ(program.wait(), 0) << program.err();
    expectSilence(program);
  }
  static State waitRadial(ViewProgram& program, const State& is) {
    return program.until("the menu at " + is.dump(), [&](const State& s) { return s["radial"] == is; });
  }
  static State waitTool(ViewProgram& program, const std::string& tool) {
    return program.until(tool, [&](const State& s) { return s["tool"] == tool && s["radial"].is_null(); });
  }
};

TEST_F(HandTools, the_stylus_is_a_pen_whose_shadow_and_arrow_can_be_switched_off) {
  openOnly({"Display"});
  const auto program = start({scan});
  User user(display, *program, "pen");
  (void)opened(*program);
  (void)user.rest();
  const Screen none = user.look("no pen");
  EXPECT_EQ(user.key("s")["stylus_pen"], true);
  user.at(kOnPart);
  (void)user.rest();
  const Screen pen = user.look("a pen over the part");
  // It stands up from the tip, to the right.
  const Part above{kOnPart.x + 10, kOnPart.y - 70, 60, 60}, below{kOnPart.x - 70, kOnPart.y + 40, 60, 60};
  EXPECT_GT(differing(pen, none, above), 100);
  EXPECT_EQ(differing(pen, none, below), 0);

  // Pressed: the arrow of the force.
  user.at(kOnPart);
  user.down(1);
  (void)program->until("contact", [](const State& s) { return s["touching"] == true; });
  const Screen pressed = user.look("pressed");
  user.up(1);
  EXPECT_GT(differing(pen, pressed, {kOnPart.x - 30, kOnPart.y - 80, 60, 80}), 60);

  // From above the pen leaves the place of work free, and a ball at its point is seen.
  (void)user.key("7");
  (void)user.key("shift+t");
  user.at(kOnPart);
  (void)user.rest();
  (void)user.look("a ball from above");
  (void)user.key("alt+t");

  user.at(kOnPart);
  (void)user.rest();
  const Screen with = user.look("before it is switched off");
  (void)user.click("its shadow");
  user.at(kOnPart);
  (void)user.rest();
  const Screen without = user.look("no shadow");
  EXPECT_GT(differing(with, without, user.surface()), 30);
  EXPECT_EQ(user.click("stylus as a pen")["stylus_pen"], false);
  user.at(kOnPart);
  (void)user.rest();
  const Screen disc = user.look("a disc");
  EXPECT_GT(differing(without, disc, user.surface()), 100);
  end(*program);
}

TEST_F(HandTools, the_trail_follows_the_tip_and_is_gone_a_second_later) {
  openOnly({"Display"}, {{"stylus_trail", true}});
  const auto program = start({scan});
  User user(display, *program, "trail");
  (void)opened(*program);
  (void)user.key("7");
  (void)user.key("s");
  user.at({200, 332});
  program->until("the cursor", [](const State& s) { return s["cursor"][0] == 200; });
  // The way to here is a trail too; it fades first.
  (void)user.rest();
  const Screen before = user.look("before");
  for (int x = 210; x <= 420; x += 10) user.at({x, 332 + (x / 10) % 3 * 8});
  // Left of where the tip comes to rest, and far from where it was before.
  const Part way{350, 310, 50, 50};
  // It changes from frame to frame: no two looks are the same. The tip keeps away from the part that is looked at.
  bool seen = false;
  for (int k = 0; k < 100 && !seen; ++k) {
    seen = differing(before, display.screen(), way) > 20;
    if (!seen) user.at({k % 2 == 0 ? 200 : 420, 332});
  }
  EXPECT_TRUE(seen);
  user.at({420, 340});
  (void)user.until("no trail", [&](const Screen& now) { return differing(before, now, way) == 0; });
  // Nothing moves any more: no frames for a trail that has ended.
  (void)user.rest();
  end(*program);
}

TEST_F(HandTools, falloff_spacing_and_shift_are_kept_to_the_bit) {
  openOnly({"Tool"});
  const std::string work = folder.file("work.fettle"), saved = folder.file("saved.tif"),
                    replayed = folder.file("replayed.tif");
  const auto program = start({scan});
  User user(display, *program, "brush");
  (void)opened(*program);
  (void)user.key("7");
  EXPECT_EQ(user.key("s")["falloff"], "flat");
  EXPECT_EQ(program->now()["spacing"], 0.0);
  (void)user.press("f");
  user.type(
      "98");  // two digits: two presses of one key in a millisecond are one to the window system's library
  EXPECT_TRUE(user.reads(
      "brush radius 64 samples (the largest) [98]: move or type, Enter or left button keeps it, Esc "
      "or right button leaves it"));
  (void)user.look("clamped");
  (void)user.key("Escape");
  (void)user.press("f");
  user.type("9");
  (void)user.key("Return");
  user.tap("flat");
  program->until("the list",
                 [](const State& s) { return s["texts"].dump().find("\"sphere\"") != std::string::npos; });
  (void)user.look("falloffs");
  (void)user.click("smooth");
  program->until("a falloff", [](const State& s) { return s["falloff"] == "smooth"; });
  const State spaced = user.click("all the time");  // the middle of the slider
  EXPECT_GT(spaced["spacing"], 0.5);
  // A double click types into a slider.
  EXPECT_EQ(user.enter("radius", "7")["brush"], 7.0);
  EXPECT_EQ(user.enter("radius", "9")["brush"], 9.0);
  (void)user.look("the brush's panel");
  EXPECT_EQ(user.stroke({240, 332}, {440, 332}, 8)["steps"], 1);

  // The mark tool with Shift smooths: heights change, and nothing is marked.
  EXPECT_EQ(user.key("m")["tool"], "mark");
  const State smoothed = user.drag(1, {240, 420}, {440, 420}, 8, "shift");
  EXPECT_EQ(smoothed["steps"], 2);
  EXPECT_EQ(smoothed["tool"], "mark") << "the tool of before";
  (void)user.key("Escape");
  saveAs(user, work);
  (void)quit(user);
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "convert", work, saved}).status, 0);
  const Differences changed = compare(load(scan), load(saved));
  EXPECT_GT(changed.changed, 500);
  const Outcome again = runProcess({FETTLE_PROGRAM, "replay", work, replayed});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(compare(load(saved), load(replayed)).changed, 0);
  const Outcome journal = runProcess({FETTLE_PROGRAM, "journal", work});
  EXPECT_NE(journal.out.find("falloff = \\\"smooth\\\""), std::string::npos);
  EXPECT_EQ(journal.out.find("\"Mark\""), std::string::npos) << "no step marks";
}

TEST_F(HandTools, the_scan_as_it_was_is_seen_while_a_key_is_held) {
  openOnly({"Tool"});
  const auto program = start({scan});
  User user(display, *program, "before");
  (void)opened(*program);
  (void)user.key("7");
  user.at({20, 790});
  const Screen before = user.look("the scan");
  (void)user.key("s");
  EXPECT_EQ(user.stroke({240, 332}, {440, 332}, 8)["steps"], 1);
  (void)user.key("Escape");
  user.at({20, 790});
  const Screen after = user.changed("smoothed", before);
  hold("BackSpace");
  program->until("held", [](const State& s) { return s["shows_before"] == true && s["settled"] == true; });
  // Below the label, which is there from the first frame on.
  Part below = user.surface();
  below.height -= 66 - below.y;
  below.y = 66;
  (void)user.until("as it was", [&](const Screen& now) { return differing(before, now, below) == 0; });
  EXPECT_TRUE(user.reads("before: the scan as it was"));
  letGo("BackSpace");
  program->until("released",
                 [](const State& s) { return s["shows_before"] == false && s["settled"] == true; });
  (void)user.same("as it is", after);
  EXPECT_EQ(program->now()["steps"], 1);
  end(*program);
}

TEST_F(HandTools, the_step_under_the_cursor_is_outlined_where_it_changed_something) {
  openOnly({"Steps"});
  const auto program = start({scan});
  User user(display, *program, "steps");
  (void)opened(*program);
  (void)user.key("7");
  (void)user.key("s");
  (void)user.stroke({240, 332}, {440, 332}, 8);
  (void)user.key("Escape");
  user.at({20, 790});
  const Screen plain = user.look("no step under the cursor");
  const State before = program->now();
  const int panels = before["picture"][0].get<int>() + before["picture"][2].get<int>();
  Place step{0, 0};
  for (const State& text : before["texts"])
    if (text["text"].get<std::string>().find("Smooth") != std::string::npos && text["at"][0] > panels)
      step = {text["at"][0].get<int>() + 20, text["at"][1].get<int>() + text["at"][3].get<int>() / 2};
  ASSERT_GT(step.x, 0);
  user.at(step);
  program->until("the step", [](const State& s) { return s["pointed_step"] == 1 && s["settled"] == true; });
  const Screen outlined = user.look("outlined");
  // Around what the stroke changed, and nowhere else: not around its tiles.
  EXPECT_EQ(differing(plain, outlined, {140, 180, 420, 100}), 0);
  EXPECT_EQ(differing(plain, outlined, {140, 390, 420, 80}), 0);
  EXPECT_GT(differing(plain, outlined, {210, 305, 260, 60}), 300);
  EXPECT_EQ(differing(plain, outlined, {240, 326, 200, 16}), 0);
  EXPECT_EQ(differing(plain, outlined, {4, 470, 640, 200}), 0);
  user.at({20, 790});
  (void)user.same("gone again", plain);
  end(*program);
}

TEST_F(HandTools, tools_around_the_cursor_are_chosen_by_a_direction) {
  openOnly({"Tool"});
  const auto program = start({scan});
  User user(display, *program, "radial");
  (void)opened(*program);
  user.at(kOnPart);
  hold("space");
  waitRadial(*program, "");
  (void)user.look("open");
  user.at({kOnPart.x + 50, kOnPart.y - 50});
  waitRadial(*program, "Mark");
  (void)user.look("at mark");
  letGo("space");
  (void)waitTool(*program, "mark");
  // Escape, and the middle: nothing.
  user.at(kOnPart);
  hold("space");
  waitRadial(*program, "");
  user.at({kOnPart.x + 50, kOnPart.y});
  waitRadial(*program, "Unmark");
  (void)user.press("Escape");
  letGo("space");
  (void)waitTool(*program, "mark");
  user.at(kOnPart);
  hold("space");
  waitRadial(*program, "");
  user.at({kOnPart.x + 50, kOnPart.y});
  waitRadial(*program, "Unmark");
  user.at(kOnPart);
  waitRadial(*program, "");
  letGo("space");
  (void)waitTool(*program, "mark");
  // By keys alone.
  hold("space");
  waitRadial(*program, "");
  letGo("space");
  (void)user.press("Up");
  waitRadial(*program, "Smooth");
  (void)user.press("Return");
  (void)waitTool(*program, "smooth");
  // The mouse's second button, on the whole screen, near its corner: the menu is whole, and presses nothing.
  (void)user.press("F11");
  program->until("the picture alone",
                 [](const State& s) { return s["picture"][1] == 0 && s["settled"] == true; });
  user.at(kOnPart);
  user.down(3);
  waitRadial(*program, "");
  user.at({kOnPart.x + 50, kOnPart.y + 50});
  waitRadial(*program, "Lasso");
  (void)user.look("full screen");
  user.at({kOnPart.x - 50, kOnPart.y});
  waitRadial(*program, "Point tip");
  user.at({kOnPart.x - 40, kOnPart.y + 40});
  waitRadial(*program, "Ball tip");
  user.up(3);
  program->until("a ball",
                 [](const State& s) { return s["contact_level"] == "ball" && s["radial"].is_null(); });
  EXPECT_EQ(program->now()["tool"], "smooth");
  EXPECT_EQ(program->now()["steps"], 0);
  (void)user.press("F11");
  (void)user.rest();
  end(*program);
}

TEST_F(HandTools, box_after_box_is_marked_until_escape_or_another_tool) {
  openOnly({"Tool", "Filters"});
  const auto program = start({scan});
  User user(display, *program, "boxes");
  (void)opened(*program);
  (void)user.key("7");
  (void)user.click("Box");
  EXPECT_EQ(program->now()["lasso"], "box");
  (void)user.look("hint");
  EXPECT_TRUE(user.reads("Esc or another tool ends it"));
  EXPECT_EQ(user.drag(1, {240, 300}, {280, 340}, 4)["steps"], 1);
  EXPECT_EQ(program->now()["lasso"], "box") << "it stays";
  EXPECT_EQ(user.drag(1, {300, 300}, {340, 340}, 4)["steps"], 2);
  (void)user.look("two boxes");
  // A click that encloses nothing is no box, and does not end it.
  EXPECT_EQ(user.drag(1, {400, 400}, {400, 400}, 1)["steps"], 2);
  EXPECT_EQ(user.key("BackSpace")["lasso"], "box") << "the corner is taken back";
  // What is no line does what it does elsewhere: undo, and the right button that moves the view.
  EXPECT_EQ(user.key("ctrl+z")["steps"], 1);
  EXPECT_EQ(program->now()["lasso"], "box");
  // Enter applies a preview where no line is begun.
  EXPECT_EQ(user.key("p")["variants"].size(), 1U);
  EXPECT_EQ(user.key("Return")["steps"], 2);
  EXPECT_EQ(program->now()["lasso"], "box");
  EXPECT_EQ(user.key("Escape")["lasso"], "");
  EXPECT_EQ(program->now()["tool"], "view");
  // The lasso likewise, ended by another tool.
  (void)user.click("Lasso");
  EXPECT_EQ(user.drag(1, {260, 300}, {300, 360}, 2)["lasso"], "free");
  (void)user.click("Smooth");
  EXPECT_EQ(program->now()["lasso"], "");
  EXPECT_EQ(program->now()["tool"], "smooth");
  end(*program);
}

TEST_F(HandTools, all_names_around_the_cursor_are_seen_in_each_corner_of_the_picture) {
  openOnly({});
  const auto program = start({scan});
  User user(display, *program, "radial corners");
  (void)opened(*program);
  const State picture = program->now()["picture"];
  const int left = picture[0], top = picture[1], right = left + picture[2].get<int>() - 1,
            bottom = top + picture[3].get<int>() - 1;
  for (const auto& [x, y] : {std::pair{left + 2, top + 2},
                             {right - 2, top + 2},
                             {left + 2, bottom - 2},
                             {right - 2, bottom - 2}}) {
    user.at({x, y});
    hold("space");
    const State open = waitRadial(*program, "");
    (void)user.look("corner");
    const State now = program->now();
    for (const char* name : {"Smooth", "Mark", "Unmark", "Lasso", "View", "Ball tip", "Point tip", "Feel"}) {
      int whole = 0;
      for (const State& text : now["texts"])
        whole += text["text"] == name && text["cut"] == false && text["at"][0] >= left &&
                 text["at"][0].get<int>() + text["at"][2].get<int>() <= right && text["at"][1] >= top &&
                 text["at"][1].get<int>() + text["at"][3].get<int>() <= bottom;
      EXPECT_GE(whole, 1) << name << " at " << x << ", " << y << ": " << now["texts"].dump();
    }
    (void)user.press("Escape");
    letGo("space");
    program->until("no menu", [](const State& s) { return s["radial"].is_null() && s["settled"] == true; });
  }
  end(*program);
}

}  // namespace
}  // namespace fettle::tests
