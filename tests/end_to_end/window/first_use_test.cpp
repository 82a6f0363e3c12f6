// Wrong turns that a person took who saw the window for the first time.
#include <algorithm>
#include <filesystem>
#include <functional>

#include <fmt/format.h>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

bool hasWords(const State& s, const std::string& what) {
  return std::any_of(s["texts"].begin(), s["texts"].end(), [&](const State& text) {
    return text["text"].get<std::string>().find(what) != std::string::npos;
  });
}

bool asksUnsaved(const State& s) {
  return s["dialog"] == "unsaved" && s["settled"] == true;
}

class FirstUseTest : public WindowTest {
 protected:
  void hold(const std::string& key) const { display.hands({"keydown", key}); }
  void letGo(const std::string& key) const { display.hands({"keyup", key}); }
};

TEST_F(FirstUseTest, hidden_marks_are_seen_again_when_one_marks_and_in_the_next_scan) {
  {
    const auto program = start({scan});
    User user(display, *program, "hidden marks");
    (void)opened(*program);
    (void)user.key("7");
    EXPECT_EQ(user.key("h")["marks"], false);
    // A tool chosen hides nothing and shows nothing; its stroke does.
    EXPECT_EQ(user.key("m")["marks"], false);
    EXPECT_EQ(user.stroke({240, 360}, {340, 360}, 4)["marks"], true);
    (void)user.key("Escape");
    // Nor is a change that comes without a hand on the surface made unseen.
    EXPECT_EQ(user.key("h")["marks"], false);
    (void)user.key("ctrl+i");
    program->until("inverted marks are seen",
                   [](const State& s) { return s["marks"] == true && s["settled"] == true; });
    EXPECT_EQ(user.key("h")["marks"], false);
    (void)user.press("ctrl+q");
    program->until("a question", asksUnsaved);
    (void)user.press("Delete");
    EXPECT_EQ(program->wait(), 0) << program->err();
  }
  const auto program = start({scan});
  User user(display, *program, "next start");
  EXPECT_EQ(opened(*program)["marks"], true) << "hidden for that scan alone";
  quit(user);
}

TEST_F(FirstUseTest, the_question_names_the_export_and_is_not_answered_by_a_key_of_the_view) {
  const auto program = start({scan});
  User user(display, *program, "question");
  (void)opened(*program);
  (void)user.key("7");
  (void)user.key("m");
  (void)user.stroke({240, 360}, {340, 360}, 4);
  (void)user.key("Escape");
  (void)user.press("ctrl+q");
  const State before = program->until("a question", asksUnsaved);
  EXPECT_TRUE(hasWords(before, "Save session ..."));
  EXPECT_FALSE(hasWords(before, "exported"));
  (void)user.key("Escape");
  const std::string out = folder.file("out.tif");
  (void)user.press("ctrl+e");
  program->until("where to", [](const State& s) { return s["dialog"] == "export" && s["settled"] == true; });
  user.type(out);
  (void)user.press("Return");
  program->until("written", [&](const State& s) { return s["status"] == "written: " + out; });
  (void)user.rest();
  (void)user.press("ctrl+q");
  const State after = program->until("the question again", asksUnsaved);
  EXPECT_TRUE(hasWords(after, "It was exported to " + out)) << after["texts"].dump();
  EXPECT_TRUE(hasWords(after, "as it is now"));
  (void)user.look("after an export");
  // D shows changes in the view; here it does nothing.
  (void)user.press("d");
  EXPECT_EQ(user.rest()["dialog"], "unsaved");
  (void)user.key("Escape");
  (void)user.key("m");
  (void)user.stroke({240, 420}, {340, 420}, 4);
  (void)user.key("Escape");
  (void)user.press("ctrl+q");
  const State changed = program->until("the question once more", asksUnsaved);
  EXPECT_TRUE(hasWords(changed, "and changed since"));
  // A dialog never appears with the button that discards under the cursor.
  User::Place discard{};
  for (const State& text : changed["texts"])
    if (text["text"].get<std::string>().starts_with("Discard"))
      discard = {text["at"][0].get<int>() + text["at"][2].get<int>() / 2,
                 text["at"][1].get<int>() + text["at"][3].get<int>() / 2};
  ASSERT_GT(discard.x, 0);
  (void)user.key("Escape");
  user.at(discard);
  (void)user.press("ctrl+q");
  const State aside = program->until("the question, aside", asksUnsaved);
  for (const State& text : aside["texts"])
    if (text["text"].get<std::string>().starts_with("Discard")) {
      EXPECT_GT(std::abs(text["at"][1].get<int>() + text["at"][3].get<int>() / 2 - discard.y), 15);
    }
  (void)user.press("Delete");
  EXPECT_EQ(program->wait(), 0) << program->err();
  EXPECT_EQ(program->report()["unsaved_changes"], true);
  expectSilence(*program);
}

TEST_F(FirstUseTest, what_was_before_says_so_on_the_picture) {
  const auto program = start({scan});
  User user(display, *program, "before");
  (void)opened(*program);
  EXPECT_FALSE(hasWords(program->now(), "before: the scan as it was"));
  hold("BackSpace");
  program->until("before", [](const State& s) { return hasWords(s, "before: the scan as it was"); });
  (void)user.look("before");
  letGo("BackSpace");
  program->until("now", [](const State& s) { return s["shows_before"] == false; });
  quit(user);
}

TEST_F(FirstUseTest, a_filter_of_marks_alone_says_that_nothing_is_marked) {
  const auto program = start({scan});
  User user(display, *program, "only marks");
  (void)opened(*program);
  (void)user.key("o");
  (void)user.key("p");
  program->until("the preview",
                 [](const State& s) { return !s["variants"].empty() && s["settled"] == true; });
  EXPECT_TRUE(hasWords(program->now(), "nothing is marked")) << program->now()["texts"];
  (void)user.look("nothing is marked");
  quit(user);
}

TEST_F(FirstUseTest, the_list_of_keys_begins_with_how_to_clean_a_scan_and_is_searched) {
  const auto program = start({});
  User user(display, *program, "keys");
  program->until("an empty window", [](const State& s) { return hasWords(s, "Drop a scan here"); });
  (void)user.press("F1");
  const auto listed = [](const State& s) { return s["dialog"] == "shortcuts" && s["settled"] == true; };
  const State all = program->until("the list", listed);
  EXPECT_TRUE(hasWords(all, "How to clean a scan"));
  EXPECT_TRUE(hasWords(all, "6. Ctrl+E exports the part"));
  EXPECT_TRUE(hasWords(all, "Screen readers cannot read this window"));
  EXPECT_EQ(all["text_field"], true) << "the search has the keyboard";
  (void)user.look("the list");
  user.write("contour");
  const State found = program->until("what was sought", [](const State& s) {
    return s["settled"] == true && hasWords(s, "Contour lines") && !hasWords(s, "Open a scan, ") &&
           !hasWords(s, "Export");
  });
  EXPECT_FALSE(hasWords(found, "How to clean a scan"));
  (void)user.look("found");
  // What is in a panel and has no key, formats of files, several of what is there as one.
  for (const auto& [word, where] : {std::pair{"roughness", "Measure: "},
                                    {"theme", "Display: "},
                                    {"stl", "Compare: "},
                                    {"units", "Read this scan with another unit"}}) {
    (void)user.press("ctrl+a");
    user.write(word);
    program->until(word,
                   [&where = where](const State& s) { return s["settled"] == true && hasWords(s, where); });
    EXPECT_FALSE(hasWords(program->now(), "Nothing is found")) << word;
  }
  (void)user.look("found in panels");
  (void)user.press("Escape");
  program->until("closed", [](const State& s) { return s["dialog"] == "none"; });
  quit(user);
}

TEST_F(FirstUseTest, what_the_list_of_keys_has_found_is_done_by_enter_or_a_click) {
  const auto program = start({scan, "--ui-scale", "1.5"});
  User user(display, *program, "found");
  const State before = opened(*program);
  EXPECT_EQ(before["contours"], false);
  const auto listed = [](const State& s) { return s["dialog"] == "shortcuts" && s["settled"] == true; };
  const auto seek = [&](const std::string& word, const std::string& there) {
    (void)user.press("F1");
    program->until("the list", listed);
    user.write(word);
    return program->until(word, [&](const State& s) { return listed(s) && hasWords(s, there); });
  };
  const auto after = [&](const std::string& what, const std::function<bool(const State&)>& is) {
    return program->until(what, [&](const State& s) { return s["dialog"] == "none" && is(s); });
  };
  (void)seek("contour l", "Contour lines");
  (void)user.press("Return");
  (void)after("contours", [](const State& s) { return s["contours"] == true; });
  // Nothing is found: the search goes on.
  (void)seek("qqxx", "Nothing is found");
  (void)user.press("Return");
  EXPECT_EQ(user.rest()["dialog"], "shortcuts");
  EXPECT_EQ(program->now()["text_field"], true);
  (void)user.press("Escape");
  (void)after("closed", [](const State&) { return true; });
  (void)seek("colour map", "Next colour map");
  (void)user.look("a line to click");
  user.tap("Next colour map");
  (void)after("another map", [&](const State& s) { return s["colour_map"] != before["colour_map"]; });
  // A panel, also where all are hidden.
  (void)user.key("Tab");
  (void)seek("stitch", "Join: ");
  (void)user.press("Return");
  const State panel = after("its panel", [](const State& s) { return hasWords(s, "Join"); });
  EXPECT_NE(std::ranges::find(panel["panels"], State("Join")), panel["panels"].end()) << panel["panels"];
  // A filter, which is in its panel then.
  (void)seek("gaussian", "Gaussian: ");
  (void)user.press("Return");
  (void)after("the filter",
              [](const State& s) { return s["filter"].dump().find("aussian") != std::string::npos; });
  quit(user);
}

TEST_F(FirstUseTest, a_name_typed_narrows_the_list_of_files_and_is_completed) {
  namespace fs = std::filesystem;
  const fs::path scans = folder.path() / "scans";
  fs::create_directories(scans);
  for (const char* name : {"tray_one.tif", "tray_two.tif", "plate.tif"}) fs::copy_file(scan, scans / name);
  const auto program = start({(scans / "plate.tif").string()});
  User user(display, *program, "narrow");
  (void)opened(*program);
  (void)user.press("ctrl+o");
  const auto opens = [](const State& s) { return s["dialog"] == "open" && s["settled"] == true; };
  program->until("the dialog", opens);
  user.type("tray_t");
  const State narrowed =
      program->until("one file", [&](const State& s) { return opens(s) && !hasWords(s, "tray_one.tif"); });
  EXPECT_TRUE(hasWords(narrowed, "tray_two.tif"));
  (void)user.look("narrowed");
  (void)user.press("Tab");
  const State completed = program->until(
      "completed", [&](const State& s) { return opens(s) && s["dialog_path"] == "tray_two.tif"; });
  program->until("its picture", [&](const State& s) { return opens(s) && hasWords(s, "samples"); });
  (void)user.look("completed");
  (void)user.press("Return");
  program->until("the scan", [&](const State& s) {
    return s["path"] == (scans / "tray_two.tif").string() && s["settled"] == true;
  });
  // What is written next is offered where the last was written.
  fs::create_directories(folder.path() / "out");
  (void)user.press("ctrl+e");
  program->until("where to", [](const State& s) { return s["dialog"] == "export" && s["settled"] == true; });
  user.type(folder.file("out/first.tif"));
  (void)user.press("Return");
  program->until("written",
                 [&](const State& s) { return s["status"] == "written: " + folder.file("out/first.tif"); });
  (void)user.rest();
  (void)user.press("ctrl+shift+s");
  const State next = program->until(
      "where to save", [](const State& s) { return s["dialog"] == "save as" && s["settled"] == true; });
  EXPECT_EQ(next["dialog_path"], folder.file("out/tray_two.fettle"));
  (void)user.press("Escape");
  quit(user);
}

}  // namespace
}  // namespace fettle::tests
