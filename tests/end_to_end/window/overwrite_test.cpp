// Saving over what is there already, the open scan first of all.
#include <csignal>
#include <filesystem>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

class OverwriteTest : public WindowTest {
 protected:
  // Up to the question that stands before `path` is written over.
  static void exportTo(User& user, const std::string& path) {
    (void)user.press("ctrl+e");
    user.program().until("where to",
                         [](const State& s) { return s["dialog"] == "export" && s["settled"] == true; });
    user.type(path);
    (void)user.press("Return");
    user.program().until("a question",
                         [](const State& s) { return s["dialog"] == "replace" && s["settled"] == true; });
  }
  static void replace(User& user, const std::string& path) {
    (void)user.press("r");
    user.program().until("written", [&](const State& s) {
      return s["dialog"] == "none" && s["saving"] == false && s["status"] == "written: " + path;
    });
  }
  static void untilKept(User& user, int steps) {
    user.program().until("on the disk",
                         [&](const State& s) { return s["steps"] == steps && s["kept"] == true; });
  }
};

TEST_F(OverwriteTest, a_session_survives_that_the_open_scan_is_saved_over) {
  const std::string as_it_was = folder.file("as it was.tif"), after = folder.file("after.tif");
  std::filesystem::copy_file(scan, as_it_was);
  {
    const auto program = start({scan});
    User user(display, *program, "over");
    (void)opened(*program);
    (void)user.key("7");
    (void)user.key("s");
    (void)user.stroke({240, 360}, {400, 360}, 5);
    user.at({20, 790});
    // Going back leaves the file as it is, and the path to be changed.
    exportTo(user, scan);
    EXPECT_TRUE(user.reads("Replace (R)"));
    EXPECT_NE(program->now()["texts"].dump().find("is the scan that is worked on"), std::string::npos);
    (void)user.look("the question");
    (void)user.press("Escape");
    program->until("where to", [&](const State& s) {
      return s["dialog"] == "export" && s["dialog_path"] == scan && s["settled"] == true;
    });
    (void)user.press("Escape");
    program->until("no dialog", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
    EXPECT_EQ(compare(load(as_it_was), load(scan)).changed, 0);
    exportTo(user, scan);
    replace(user, scan);
    EXPECT_GT(compare(load(as_it_was), load(scan)).changed, 0);
    (void)user.stroke({240, 460}, {400, 460}, 5);
    untilKept(user, 2);
    program->signal(SIGKILL);
    EXPECT_EQ(program->wait(), 128 + SIGKILL);
  }
  const auto program = start({scan});
  User user(display, *program, "over again");
  program->until("the work is offered",
                 [](const State& s) { return s["dialog"] == "recover" && s["settled"] == true; });
  (void)user.press("Return");
  EXPECT_EQ(opened(*program)["steps"], 2);
  saveAs(user, after);
  // Both strokes, and undo goes back to the scan as it was.
  EXPECT_EQ(user.key("ctrl+z")["steps"], 1);
  EXPECT_EQ(user.key("ctrl+z")["steps"], 0);
  const std::string undone = folder.file("undone.tif");
  saveAs(user, undone);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
  EXPECT_EQ(compare(load(as_it_was), load(undone)).changed, 0);
  const Differences first = compare(load(as_it_was), load(scan));
  const Differences both = compare(load(as_it_was), load(after));
  const Differences second = compare(load(scan), load(after));
  EXPECT_GT(second.changed, 50);
  EXPECT_EQ(both.changed, first.changed + second.changed);
}

TEST_F(OverwriteTest, a_file_that_is_there_is_replaced_after_a_question_alone) {
  const std::string there = folder.file("there.tif");
  ASSERT_TRUE(std::filesystem::copy_file(scan, there));
  const auto program = start({scan});
  User user(display, *program, "there");
  (void)opened(*program);
  (void)user.key("7");
  (void)user.key("m");
  (void)user.stroke({240, 360}, {340, 360}, 4);
  (void)user.key("Escape");
  user.at({20, 790});
  exportTo(user, there);
  EXPECT_TRUE(user.reads("there.tif is there already."));
  replace(user, there);
  // The marks lie next to it now, and would be replaced as well.
  std::filesystem::remove(there);
  exportTo(user, there);
  EXPECT_TRUE(user.reads("there_marks.png is there already."));
  replace(user, there);
  // Where nothing was marked when it was first saved, Ctrl+S comes upon the marks of another.
  const std::string later = folder.file("later.tif"), later_marks = folder.file("later_marks.png");
  while (program->now()["steps"] > 0) (void)user.key("ctrl+z");
  saveAs(user, later);
  std::filesystem::copy_file(folder.file("there_marks.png"), later_marks);
  (void)user.key("ctrl+shift+z");
  (void)user.press("ctrl+s");
  program->until("a question",
                 [](const State& s) { return s["dialog"] == "replace" && s["settled"] == true; });
  EXPECT_TRUE(user.reads("later_marks.png is there already."));
  (void)user.press("Escape");
  program->until("no dialog", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  // Into a session: on to that session's own path there is nothing to ask, and no copy can be made of it.
  const std::string session = folder.file("work.fettle");
  saveAs(user, session);
  saveAs(user, session);
  (void)user.press("ctrl+e");
  program->until("where to", [](const State& s) { return s["dialog"] == "export" && s["settled"] == true; });
  user.type(session);
  (void)user.press("Return");
  const State refused = program->until(
      "a message", [](const State& s) { return s["dialog"] == "message" && s["settled"] == true; });
  EXPECT_NE(refused["message"].get<std::string>().find("everything is stored there"), std::string::npos);
  (void)user.press("Return");
  program->until("no dialog", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  (void)quit(user);
}

}  // namespace
}  // namespace fettle::tests
