// What the window asks before work is lost, and each answer.
#include <algorithm>
#include <csignal>
#include <filesystem>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

bool asks(const State& s) {
  return s["dialog"] == "unsaved" && s["settled"] == true;
}

class QuestionTest : public WindowTest {
 protected:
  // A scan with a mark that is not saved.
  Screen mark(User& user) {
    (void)opened(user.program());
    (void)user.key("7");
    const Screen before = user.look("opened");
    (void)user.key("m");
    (void)user.stroke({240, 360}, {340, 360}, 4);
    (void)user.key("Escape");
    user.at({20, 790});
    return user.changed("marked", before);
  }
};

TEST_F(QuestionTest, work_is_not_lost_without_a_question) {
  const std::string second = folder.file("second.tif"), third = folder.file("saved by Enter.tif");
  std::filesystem::copy_file(scan, second);
  const auto program = start({second});
  User user(display, *program, "ask");
  (void)opened(*program);
  // What was opened last is first in the list of recent files.
  const std::uint32_t window = other.windowOf("fettle");
  EXPECT_EQ(other.drop(window, {scan}), "");
  program->until("the other scan", [&](const State& s) { return s["path"] == scan && s["settled"] == true; });
  const Screen marked = mark(user);

  // Going back leaves everything as it is.
  (void)user.press("ctrl+q");
  program->until("a question", asks);
  const Screen asked = user.changed("the question", marked, 1000);
  (void)user.key("Escape");
  (void)user.same("as before the question", marked);
  // Opening another scan asks as well: by drop, and by its number among the recent files.
  EXPECT_EQ(other.drop(window, {second}), "");
  program->until("a question", asks);
  (void)user.key("Escape");
  (void)user.press("ctrl+2");
  program->until("a question", asks);
  // Save (Enter) asks where to, and continues with what was requested.
  (void)user.press("Return");
  program->until("where to", [](const State& s) { return s["dialog"] == "save as" && s["settled"] == true; });
  user.type(third);
  (void)user.press("Return");
  const State next = program->until(
      "the second scan", [&](const State& s) { return s["path"] == second && s["settled"] == true; });
  EXPECT_EQ(next["steps"], 0);
  EXPECT_EQ(next["unsaved"], false);
  EXPECT_TRUE(std::filesystem::exists(third));
  EXPECT_TRUE(std::filesystem::exists(folder.file("saved by Enter_marks.png")));

  // Discarding ends it.
  (void)mark(user);
  (void)user.press("ctrl+q");
  program->until("a question", asks);
  (void)user.press("Delete");
  EXPECT_EQ(program->wait(), 0) << program->err();
  EXPECT_EQ(program->report()["unsaved_changes"], true);
  expectSilence(*program);
}

TEST_F(QuestionTest, the_question_at_quitting_is_turned_off_and_on_again_and_no_work_is_lost) {
  {
    const auto program = start({scan});
    User user(display, *program, "stop asking");
    (void)mark(user);
    EXPECT_EQ(program->now()["asks_before_quitting"], true);
    // Who goes back decided nothing.
    (void)user.press("ctrl+q");
    program->until("a question", asks);
    (void)user.click("Do not ask again (N)");
    (void)user.look("the question, ticked");
    EXPECT_EQ(user.key("Escape")["asks_before_quitting"], true);
    (void)user.press("ctrl+q");
    program->until("a question", asks);
    (void)user.click("Do not ask again (N)");
    user.at({20, 790});
    (void)user.press("Delete");
    EXPECT_EQ(program->wait(), 0) << program->err();
    expectSilence(*program);
  }
  {
    const auto program = start({scan});
    User user(display, *program, "not asked");
    (void)mark(user);
    EXPECT_EQ(program->now()["asks_before_quitting"], false);
    (void)user.press("ctrl+q");
    EXPECT_EQ(program->wait(), 0) << program->err();
    EXPECT_NE(program->report()["warnings"].dump().find("unsaved work is stored"), std::string::npos)
        << program->report();
    expectSilence(*program);
  }
  const auto program = start({scan});
  User user(display, *program, "ask again");
  program->until("the work is offered",
                 [](const State& s) { return s["dialog"] == "recover" && s["settled"] == true; });
  (void)user.press("Return");
  EXPECT_EQ(opened(*program)["steps"], 1);
  for (const char* header : {"Filters", "Display"}) (void)user.click(header);
  EXPECT_EQ(user.click("ask before quitting")["asks_before_quitting"], true);
  (void)user.look("asks again");
  (void)user.press("ctrl+q");
  program->until("a question", asks);
  (void)user.press("Delete");
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

TEST_F(QuestionTest, a_display_that_closes_keeps_the_work_and_ends_the_program_with_a_word) {
  const auto program = start({scan});
  User user(display, *program, "display");
  (void)mark(user);
  display.close();
  EXPECT_EQ(program->wait(), 1);
  EXPECT_EQ(program->err().rfind(
                "{\"schema\":\"fettle.error/1\",\"error\":\"the connection to the display was lost", 0),
            0U)
      << program->err();
  EXPECT_EQ(std::count(program->err().begin(), program->err().end(), '\n'), 1) << program->err();
  EXPECT_NE(program->err().find("unsaved work is stored"), std::string::npos) << program->err();
}

TEST(NoWindowTest, without_a_display_the_program_says_so) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const Outcome outcome = runProcess({FETTLE_PROGRAM, "view"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("there is no display"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace fettle::tests
