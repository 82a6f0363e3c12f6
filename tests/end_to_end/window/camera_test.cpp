// The camera by hand: turned about what the cursor holds, from the sides, by the axes, to bookmarks and back.
#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;
using Place = User::Place;

void expectDirection(const State& state, double azimuth, double elevation) {
  EXPECT_NEAR(std::remainder(state["view"][0].get<double>() - azimuth, 360.0), 0.0, 1e-5) << state["view"];
  EXPECT_NEAR(state["view"][1].get<double>(), elevation, 1e-5) << state["view"];
}

Place ballAt(const State& state, const char* name) {
  return {state["axes"][name][0].get<int>(), state["axes"][name][1].get<int>()};
}

TEST_F(WindowTest, a_turn_keeps_what_was_under_the_cursor_there) {
  const auto program = start({scan});
  User user(display, *program, "turn");
  (void)opened(*program);
  // With a tool on, the window says what lies under the cursor.
  (void)user.key("7");
  (void)user.key("t");
  const Place held{260, 500};
  user.at(held);
  const State before = user.rest();
  ASSERT_TRUE(before["under_cursor"].is_array()) << before["under_cursor"];
  const auto same = [&](const State& state, int within) {
    ASSERT_TRUE(state["under_cursor"].is_array());
    for (const int i : {0, 1})
      EXPECT_NEAR(state["under_cursor"][i].get<int>(), before["under_cursor"][i].get<int>(), within)
          << state["under_cursor"] << " and " << before["under_cursor"];
  };
  for (const Place& to : {Place{340, 470}, Place{180, 480}}) {
    (void)user.drag(1, held, to, 5, "alt");
    user.at(held);
    const State after = user.rest();
    EXPECT_NE(after["view"], before["view"]);
    same(after, 1);
  }
  (void)user.look("turned about the cursor");
  // Over the whole picture: a full turn.
  const State picture = program->now()["picture"];
  const int left = picture[0].get<int>() + 5, width = picture[2].get<int>();
  const State first = program->now()["view"];
  (void)user.drag(1, {left, 500}, {left + width / 2, 500}, 6, "alt");
  expectDirection(program->now(), first[0].get<double>() - 360.0 * (width / 2) / width,
                  first[1].get<double>());
  EXPECT_EQ(program->now()["steps"], 0);
  (void)quit(user);
}

TEST_F(WindowTest, the_axes_lead_to_true_side_views_and_bookmarks_back) {
  const std::string session = folder.file("views.fettle");
  {
    const auto program = start({scan});
    User user(display, *program, "axes");
    (void)opened(*program);
    user.at({20, 790});
    const Screen oblique = user.look("oblique");
    EXPECT_EQ(user.key("shift+F2")["bookmarks"], 1);
    const State begun = program->now()["view"];
    EXPECT_EQ(user.key("1")["view"][1], 0.0);
    expectDirection(program->now(), 0.0, 0.0);
    user.at({20, 790});
    Screen seen = user.changed("from the front", oblique, 2000);
    for (const auto& [ball, azimuth, elevation] :
         {std::tuple{"x+", 90.0, 0.0}, {"z+", 0.0, 90.0}, {"y+", 180.0, 0.0}, {"x-", 270.0, 0.0}}) {
      const Place place = ballAt(program->now(), ball);
      user.at(place);
      user.down(1);
      user.up(1);
      expectDirection(user.rest(), azimuth, elevation);
      user.at({20, 790});
      seen = user.changed(std::string("by the axes ") + ball, seen, 500);
    }
    // A click on an end presses no stylus on the surface below.
    (void)user.key("m");
    user.at(ballAt(program->now(), "z+"));
    user.down(1);
    user.up(1);
    expectDirection(user.rest(), 0.0, 90.0);
    EXPECT_EQ(program->now()["steps"], 0);
    (void)user.key("Escape");
    EXPECT_EQ(user.key("F2")["view"], begun);
    user.at({20, 790});
    (void)user.same("the bookmark", oblique);
    EXPECT_EQ(user.key("F3")["view"], begun) << "none there";
    EXPECT_TRUE(user.key("shift+j")["axes"].empty());
    (void)user.changed("without axes", oblique, 300);
    (void)user.key("shift+j");
    (void)user.key("7");
    EXPECT_EQ(user.key("shift+F5")["bookmarks"], 2);
    saveAs(user, session);
    (void)quit(user);
  }
  const auto again = start({session});
  User user(display, *again, "axes again");
  EXPECT_EQ(opened(*again)["bookmarks"], 2);
  expectDirection(user.key("F2"), 330.0, 45.0);
  expectDirection(user.key("F5"), 0.0, 90.0);
  (void)quit(user);
}

TEST_F(WindowTest, the_mouse_moves_the_view_as_in_the_chosen_program) {
  std::filesystem::create_directories(folder.path() / "fettle");
  std::ofstream(folder.path() / "fettle" / "window.json")
      << State{{"mouse", "cloudcompare"}, {"flights", false}};
  const auto program = start({scan});
  User user(display, *program, "mouse");
  State before = opened(*program);
  EXPECT_EQ(before["mouse"], "cloudcompare");
  const Place from{330, 400}, to{300, 340};
  State after = user.drag(3, from, to, 3);
  EXPECT_EQ(after["view"][2], before["view"][2]) << "right moves";
  EXPECT_NE(after["view"][3], before["view"][3]);
  EXPECT_EQ(after["view"][0], before["view"][0]);
  before = after;
  after = user.drag(2, from, to, 3);
  EXPECT_GT(after["view"][2], before["view"][2]) << "middle zooms";
  EXPECT_EQ(after["view"][0], before["view"][0]);
  before = after;
  after = user.drag(1, from, to, 3);
  EXPECT_NE(after["view"][0], before["view"][0]) << "left turns";
  EXPECT_EQ(user.key("shift+m")["mouse"], "meshlab");
  before = program->now();
  after = user.drag(2, from, to, 3);
  EXPECT_EQ(after["view"][2], before["view"][2]) << "middle moves";
  EXPECT_EQ(after["view"][0], before["view"][0]);
  EXPECT_NE(after["view"], before["view"]);
  (void)quit(user);
}

// Of a window that does not fill the screen; the picture's other sizes are size_test's.
TEST_F(WindowTest, the_picture_takes_the_whole_screen_and_gives_it_back) {
  const auto program = start({scan, "--size", "900x640"});
  User user(display, *program, "full screen");
  const State before = opened(*program);
  const auto until = [&](const char* what, bool full, int width) {
    return program->until(what, [&](const State& s) {
      return s["full_screen"] == full && s["frame"][0] == width && s["settled"] == true;
    });
  };
  (void)user.press("F11");
  const State alone = until("full screen", true, 1100);
  EXPECT_EQ(alone["frame"], (State{1100, 800}));
  EXPECT_EQ(alone["picture"][1], 0);
  EXPECT_EQ(alone["picture"][2], 1100);
  (void)user.look("full screen");
  EXPECT_NE(user.key("1")["view"], alone["view"]) << "keys act as before";
  (void)user.press("Tab");
  EXPECT_EQ(until("back", false, 900)["picture"], before["picture"]);
  (void)user.press("F11");
  (void)until("full screen again", true, 1100);
  (void)user.press("F11");
  EXPECT_EQ(until("back again", false, 900)["status"].get<std::string>().find("F11"), std::string::npos);
  // Escape ends a tool first.
  (void)user.key("m");
  (void)user.press("F11");
  (void)until("full screen with a tool", true, 1100);
  EXPECT_EQ(user.key("Escape")["full_screen"], true);
  EXPECT_EQ(program->now()["tool"], "view");
  (void)user.press("Escape");
  (void)until("back by Escape", false, 900);
  (void)quit(user);
}

}  // namespace
}  // namespace fettle::tests
