// Saving over what is there already, the open scan first of all.
#include <csignal>
#include <filesystem>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = Hand::State;

class OverwriteTest : public WindowTest {
 protected:
  // Up to the question that stands before `path` is written over.
  static void exportTo(Hand& hand, const std::string& path) {
    (void)hand.press("ctrl+e");
    hand.program().until("where to",
                         [](const State& s) { return s["dialog"] == "export" && s["settled"] == true; });
    hand.type(path);
    (void)hand.press("Return");
    hand.program().until("a question",
                         [](const State& s) { return s["dialog"] == "replace" && s["settled"] == true; });
  }
  static void replace(Hand& hand, const std::string& path) {
    (void)hand.press("r");
    hand.program().until("written", [&](const State& s) {
      return s["dialog"] == "none" && s["saving"] == false && s["status"] == "written: " + path;
    });
  }
  static void untilKept(Hand& hand, int steps) {
    hand.program().until("on the disk",
                         [&](const State& s) { return s["steps"] == steps && s["kept"] == true; });
  }
};

TEST_F(OverwriteTest, a_session_survives_that_the_open_scan_is_saved_over) {
  const std::string as_it_was = folder.file("as it was.tif"), after = folder.file("after.tif");
  std::filesystem::copy_file(scan, as_it_was);
  {
    const auto program = start({scan});
    Hand hand(display, *program, "over");
    (void)opened(*program);
    (void)hand.key("7");
    (void)hand.key("s");
    (void)hand.stroke({240, 360}, {400, 360}, 5);
    hand.at({20, 790});
    // Going back leaves the file as it is, and the path to be changed.
    exportTo(hand, scan);
    EXPECT_TRUE(hand.reads("Replace (R)"));
    EXPECT_NE(program->now()["texts"].dump().find("is the scan that is worked on"), std::string::npos);
    (void)hand.look("the question");
    (void)hand.press("Escape");
    program->until("where to", [&](const State& s) {
      return s["dialog"] == "export" && s["dialog_path"] == scan && s["settled"] == true;
    });
    (void)hand.press("Escape");
    program->until("no dialog", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
    EXPECT_EQ(compare(load(as_it_was), load(scan)).changed, 0);
    exportTo(hand, scan);
    replace(hand, scan);
    EXPECT_GT(compare(load(as_it_was), load(scan)).changed, 0);
    (void)hand.stroke({240, 460}, {400, 460}, 5);
    untilKept(hand, 2);
    program->signal(SIGKILL);
    EXPECT_EQ(program->wait(), 128 + SIGKILL);
  }
  const auto program = start({scan});
  Hand hand(display, *program, "over again");
  program->until("the work is offered",
                 [](const State& s) { return s["dialog"] == "recover" && s["settled"] == true; });
  (void)hand.press("Return");
  EXPECT_EQ(opened(*program)["steps"], 2);
  saveAs(hand, after);
  // Both strokes, and undo goes back to the scan as it was.
  EXPECT_EQ(hand.key("ctrl+z")["steps"], 1);
  EXPECT_EQ(hand.key("ctrl+z")["steps"], 0);
  const std::string undone = folder.file("undone.tif");
  saveAs(hand, undone);
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
  Hand hand(display, *program, "there");
  (void)opened(*program);
  (void)hand.key("7");
  (void)hand.key("m");
  (void)hand.stroke({240, 360}, {340, 360}, 4);
  (void)hand.key("Escape");
  hand.at({20, 790});
  exportTo(hand, there);
  EXPECT_TRUE(hand.reads("there.tif is there already."));
  replace(hand, there);
  // The marks lie beside it now, and would be replaced as well.
  std::filesystem::remove(there);
  exportTo(hand, there);
  EXPECT_TRUE(hand.reads("there_marks.png is there already."));
  replace(hand, there);
  // Where nothing was marked when it was first saved, Ctrl+S comes upon the marks of another.
  const std::string later = folder.file("later.tif"), later_marks = folder.file("later_marks.png");
  while (program->now()["steps"] > 0) (void)hand.key("ctrl+z");
  saveAs(hand, later);
  std::filesystem::copy_file(folder.file("there_marks.png"), later_marks);
  (void)hand.key("ctrl+shift+z");
  (void)hand.press("ctrl+s");
  program->until("a question",
                 [](const State& s) { return s["dialog"] == "replace" && s["settled"] == true; });
  EXPECT_TRUE(hand.reads("later_marks.png is there already."));
  (void)hand.press("Escape");
  program->until("no dialog", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  // Into a session: on to that session's own path there is nothing to ask, and no copy can be made of it.
  const std::string session = folder.file("work.fettle");
  saveAs(hand, session);
  saveAs(hand, session);
  (void)hand.press("ctrl+e");
  program->until("where to", [](const State& s) { return s["dialog"] == "export" && s["settled"] == true; });
  hand.type(session);
  (void)hand.press("Return");
  const State told = program->until(
      "a message", [](const State& s) { return s["dialog"] == "message" && s["settled"] == true; });
  EXPECT_NE(told["message"].get<std::string>().find("everything is stored there"), std::string::npos);
  (void)hand.press("Return");
  program->until("no dialog", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  (void)quit(hand);
}

}  // namespace
}  // namespace fettle::tests
