// Edge lines by hand: drawn with the mark tool, seen, cut, chosen, removed, undone, and kept in the session.
#include <csignal>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "engine/io/lines/lines.h"
#include "engine/session/line_codec.h"
#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

TEST_F(WindowTest, strokes_become_edge_lines_that_are_cut_chosen_removed_and_kept) {
  const std::filesystem::path settings = folder.path() / "fettle";
  std::ofstream(settings / "window.json") << State{{"edge_lines", true}, {"panels", {{"Edge lines", true}}}};
  const auto program = start({scan});
  User user(display, *program, "lines");
  (void)opened(*program);
  user.at({20, 790});
  (void)user.key("7");
  const Screen empty = user.look("before");
  const auto lines = [&](int number) {
    (void)program->until(fmt::format("{} lines", number), [&](const State& s) {
      return s["lines"] == number && s["marking"] == false && s["settled"] == true;
    });
    return State(program->now());
  };
  (void)user.key("m");
  (void)user.stroke({196, 250}, {197, 560}, 30);
  State now = lines(1);
  EXPECT_EQ(now["steps"], 2) << "the marks, and the line in their place";
  (void)user.key("Escape");
  user.at({20, 790});
  const Screen drawn = user.changed("a line", empty);
  EXPECT_TRUE(user.reads("found"));
  // The legend's row of lines is there with them: an orange sample and its words.
  const State area = program->now()["picture"];
  const Part legend{area[0], area[1].get<int>() + area[3].get<int>() - 13, area[2], 13};
  EXPECT_GT(differing(empty, drawn, legend), 60);
  const auto isOrange = [](const std::uint8_t* p) {
    return p[0] > 220 && p[1] > 100 && p[1] < 190 && p[2] < 80;
  };
  int orange = 0;
  for (int y = legend.y; y < legend.y + legend.height; ++y)
    for (int x = legend.x; x < legend.x + legend.width; ++x) orange += isOrange(drawn.at(x, y));
  EXPECT_GT(orange, 20);

  // One stroke, one undo: the line and the marks it came from.
  (void)user.key("ctrl+z");
  EXPECT_EQ(lines(0)["steps"], 0);
  EXPECT_EQ(differing(empty, user.same("undone", empty), legend), 0) << "no lines, no legend of them";
  (void)user.key("ctrl+shift+z");
  EXPECT_EQ(lines(1)["steps"], 2);
  (void)user.same("the line again", drawn);

  // Across it with the unmark tool.
  (void)user.key("u");
  (void)user.stroke({175, 400}, {196, 400}, 10);
  (void)lines(2);
  (void)user.key("Escape");
  user.at({20, 790});
  (void)user.changed("cut", drawn);
  (void)user.key("y");
  (void)user.key("shift+y");
  (void)lines(1);
  (void)user.key("ctrl+z");
  (void)lines(2);
  (void)user.key("y");
  (void)user.key("ctrl+shift+y");
  (void)lines(1);

  // Dragged aside, the line is located again: the edge is where it was.
  (void)user.drag(1, {196, 330}, {199, 332}, 8, "ctrl+shift");
  now = lines(1);
  EXPECT_EQ(now["steps"], 5);
  (void)user.key("ctrl+z");
  (void)lines(1);

  const std::string scan_with_lines = folder.file("work.tif");
  saveAs(user, scan_with_lines);
  const std::string session = folder.file("work.fettle");
  saveAs(user, session);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
  const engine::Version kept = load(session);
  ASSERT_TRUE(kept.lines());
  EXPECT_EQ(kept.lines()->size(), 1U);
  const engine::Version saved = load(scan_with_lines);
  const auto beside = engine::importLines(folder.file("work_lines.csv"), saved);
  ASSERT_TRUE(beside) << beside.error().line();
  EXPECT_EQ(beside->size(), 1U);
  const Outcome again = runProcess({FETTLE_PROGRAM, "replay", session, folder.file("again.tif")});
  EXPECT_EQ(again.status, 0) << again.err;
}

}  // namespace
}  // namespace fettle::tests
