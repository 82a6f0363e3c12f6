// Files of what was measured - sections, a report, fits - written from the window with the bytes of the commands.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

class ResultFiles : public WindowTest {
 protected:
  ResultFiles() : WindowTest(1100, 900) {}

  // Only this panel is open.
  void openPanel(const char* name, const char* theme = "dark") const {
    State panels;
    for (const char* each : {"Tool", "Filters", "Steps", "Change since the scan"}) panels[each] = false;
    panels[name] = true;
    std::ofstream(folder.path() / "fettle" / "window.json")
        << State{{"edge_lines", false}, {"panels", panels}, {"light_panels", theme == std::string("light")}};
  }
  static std::string bytes(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  static void command(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), FETTLE_PROGRAM);
    const Outcome outcome = runProcess(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
  static State dialogOf(User& user, const char* kind) {
    return user.program().until(kind,
                                [&](const State& s) { return s["dialog"] == kind && s["settled"] == true; });
  }
  // By an action's key to a path, until it is written.
  static State write(User& user, const std::string& key, const char* kind, const std::string& path) {
    (void)user.press(key);
    (void)dialogOf(user, kind);
    user.type(path);
    (void)user.press("Return");
    return written(user, path);
  }
  static State written(User& user, const std::string& path) {
    return user.program().until("written", [&](const State& s) {
      return s["dialog"] == "none" && s["writing"] == "" && s["settled"] == true &&
             s["status"].get<std::string>().find("written: " + path) != std::string::npos;
    });
  }
  // From above, along two lines.
  static void drawSections(User& user) {
    (void)user.key("7");
    user.at({220, 332});
    (void)user.key("q");
    user.at({560, 332});
    (void)user.key("shift+q");
    (void)user.click("step");
    (void)user.key("alt+q");
    user.at({300, 250});
    (void)user.key("q");
    user.at({420, 420});
    (void)user.key("shift+q");
    (void)user.program().until("two sections", [](const State& s) {
      return s["sections"] == 2 && s["taking_section"] == false && s["section_mm"].is_number() &&
             s["settled"] == true;
    });
  }
};

TEST_F(ResultFiles, sections_are_written_as_the_command_writes_them) {
  openPanel("Section");
  const std::string work = folder.file("work.fettle");
  {
    const auto program = start({scan});
    User user(display, *program, "export sections");
    (void)opened(*program);
    EXPECT_EQ(user.key("ctrl+shift+e")["dialog"], "none") << "there are none yet";
    EXPECT_NE(program->now()["notices"].dump().find("no section yet"), std::string::npos);
    drawSections(user);
    for (const char* ending : {"csv", "dxf", "svg", "png"}) {
      const State state =
          write(user, "ctrl+shift+e", "export sections", folder.file(std::string("window.") + ending));
      EXPECT_NE(state["notices"].dump().find(std::string("window.") + ending), std::string::npos)
          << "where it is";
      EXPECT_EQ(state["steps"], 0);
    }
    // A file that is there is asked about; the chosen one alone.
    (void)user.click("Export ...");
    (void)dialogOf(user, "export sections");
    user.type(folder.file("window.csv"));
    (void)user.click("the chosen section alone");
    (void)user.look("dialog");
    user.tap("Write");
    (void)dialogOf(user, "replace");
    (void)user.press("Escape");
    (void)dialogOf(user, "export sections");
    (void)user.press("Return");
    (void)dialogOf(user, "replace");
    const std::string all = bytes(folder.file("window.csv"));
    (void)user.press("r");
    (void)program->until("replaced", [&](const State& s) {
      return s["dialog"] == "none" && s["writing"] == "" && bytes(folder.file("window.csv")) != all;
    });
    const std::string one = bytes(folder.file("window.csv"));
    EXPECT_EQ(one.find("\n1,"), std::string::npos);
    EXPECT_LT(one.size(), all.size());
    std::ofstream(folder.file("window.csv")) << all;
    // A name without a format stays in the dialog, and the scan is never written over.
    (void)user.press("ctrl+shift+e");
    (void)dialogOf(user, "export sections");
    user.type(folder.file("window.xyz"));
    (void)user.press("Return");
    EXPECT_EQ(user.rest()["dialog"], "export sections");
    EXPECT_TRUE(user.reads("choose a format"));
    (void)user.key("Escape");
    // So does one in a folder that is none.
    (void)user.press("ctrl+shift+e");
    (void)dialogOf(user, "export sections");
    user.type(folder.file("nowhere/window.csv"));
    (void)user.press("Return");
    (void)program->until("no such folder", [](const State& s) {
      return s["dialog"] == "export sections" && s["settled"] == true &&
             s["texts"].dump().find("there is no such folder") != std::string::npos;
    });
    (void)user.key("Escape");
    saveAs(user, work);
    (void)quit(user);
  }
  command({"section", work, "--kept", "--csv", folder.file("command.csv"), "--dxf",
           folder.file("command.dxf"), "--plot", folder.file("command.svg")});
  command({"section", work, "--kept", "--plot", folder.file("command.png")});
  for (const char* ending : {"csv", "dxf", "svg", "png"}) {
    const std::string by_window = bytes(folder.file(std::string("window.") + ending));
    EXPECT_FALSE(by_window.empty()) << ending;
    EXPECT_EQ(by_window, bytes(folder.file(std::string("command.") + ending))) << ending;
  }
}

TEST_F(ResultFiles, a_report_has_the_bytes_of_the_command_for_the_same_session) {
  openPanel("Section", "light");
  command({"synth", scan, "--size", "96x96"});  // a page of a large one takes its time
  const std::string work = folder.file("work.fettle"), page = folder.file("window.html");
  {
    const auto program = start({scan});
    User user(display, *program, "export report");
    (void)opened(*program);
    // Without a step there is no session: the scan is all.
    (void)write(user, "alt+e", "export report", folder.file("scan.html"));
    drawSections(user);
    EXPECT_EQ(user.key("alt+r")["steps"], 1);
    saveAs(user, work);
    (void)user.press("alt+e");
    (void)dialogOf(user, "export report");
    user.type(page);
    (void)user.look("dialog");
    (void)user.press("Return");
    (void)written(user, page);
    (void)write(user, "alt+e", "export report", folder.file("window.pdf"));
    (void)quit(user);
  }
  command({"report", scan, folder.file("command_scan.html")});
  EXPECT_EQ(bytes(folder.file("scan.html")), bytes(folder.file("command_scan.html")));
  command({"report", work, folder.file("command.html")});
  const std::string by_window = bytes(page);
  EXPECT_NE(by_window.find("Kept section 2"), std::string::npos);
  EXPECT_EQ(by_window, bytes(folder.file("command.html")));
  command({"report", work, folder.file("command.pdf")});
  EXPECT_EQ(bytes(folder.file("window.pdf")), bytes(folder.file("command.pdf")));
}

TEST_F(ResultFiles, a_report_is_cancelled_and_leaves_no_file) {
  openPanel("Section");
  command({"synth", scan, "--size", "1500x1500"});
  const auto program = start({scan});
  User user(display, *program, "cancel report");
  (void)opened(*program);
  (void)user.press("alt+e");
  (void)dialogOf(user, "export report");
  user.type(folder.file("long.html"));
  (void)user.press("Return");
  (void)program->until("writing",
                       [](const State& s) { return s["writing"] == "report" && s["dialog"] == "none"; });
  user.tap("Cancel");
  const State ended = program->until("cancelled", [](const State& s) { return s["writing"] == ""; });
  EXPECT_EQ(ended["dialog"], "none");
  EXPECT_FALSE(std::filesystem::exists(folder.file("long.html")));
  (void)quit(user);
}

TEST_F(ResultFiles, hills_are_found_and_written_as_the_command_does) {
  openPanel("Features");
  const auto program = start({scan});
  User user(display, *program, "features");
  (void)opened(*program);
  (void)user.key("7");
  user.at({20, 890});
  const Screen before = user.look("scan");
  EXPECT_TRUE(program->now()["features"].is_null());
  const State found = user.key("ctrl+shift+h");
  ASSERT_TRUE(found["features"].is_object()) << found["notices"].dump();
  EXPECT_EQ(found["features"]["kind"], "hills");
  EXPECT_GT(found["features"]["count"].get<int>(), 0);
  EXPECT_EQ(found["steps"], 0);
  EXPECT_TRUE(user.reads(fmt::format("{} hills at least", found["features"]["count"].get<int>())));
  user.at({20, 890});
  const Screen coloured = user.changed("heights above saddles", before);
  // The bar is of what is drawn: nothing lies below its saddle.
  EXPECT_EQ(found["colours_are"], "hill height");
  EXPECT_EQ(found["colours"][0], 0.0);
  EXPECT_GT(found["colours"][1], 0.0);
  (void)write(user, "alt+w", "export features", folder.file("window.csv"));
  command({"features", scan, "--csv", folder.file("command.csv")});
  EXPECT_EQ(bytes(folder.file("window.csv")), bytes(folder.file("command.csv")));
  (void)user.click("hills");
  (void)user.click("dales");
  const State dales = user.click("Find");
  EXPECT_EQ(dales["features"]["kind"], "dales");
  EXPECT_EQ(dales["colours_are"], "dale depth");
  EXPECT_EQ(dales["colours"][1], 0.0);
  EXPECT_LT(dales["colours"][0], 0.0);
  user.at({20, 890});
  (void)user.changed("depths below saddles", coloured);
  (void)user.click("colours show heights above saddles");
  user.at({20, 890});
  (void)user.same("colours of the scan", before);
  EXPECT_TRUE(user.click("Remove")["features"].is_null());
}

TEST_F(ResultFiles, shapes_are_fitted_and_written_as_the_command_does) {
  openPanel("Fit");
  const auto program = start({scan});
  User user(display, *program, "fit");
  (void)opened(*program);
  (void)user.key("7");
  user.at({20, 890});
  const Screen before = user.look("scan");
  EXPECT_TRUE(program->now()["fits"].is_null());
  (void)user.click("the simplest");
  (void)user.click("plane");
  const State fitted = user.key("ctrl+shift+f");
  ASSERT_TRUE(fitted["fits"].is_object()) << fitted["notices"].dump();
  EXPECT_EQ(fitted["steps"], 0);
  EXPECT_TRUE(user.reads("region 1: plane"));
  EXPECT_TRUE(user.reads("tilt x"));
  user.at({20, 890});
  (void)user.changed("distances from the plane", before);
  const std::vector<std::string> endings = {"csv", "json", "step"};
  for (const std::string& ending : endings)
    (void)write(user, "alt+f", "export fits", folder.file("window." + ending));
  command({"fit", scan, "--shape", "plane", "--csv", folder.file("command.csv"), "--step",
           folder.file("command.step")});
  EXPECT_EQ(bytes(folder.file("window.csv")), bytes(folder.file("command.csv")));
  EXPECT_EQ(bytes(folder.file("window.step")), bytes(folder.file("command.step")));
  const Outcome json = runProcess({FETTLE_PROGRAM, "fit", scan, "--shape", "plane", "--json", "--quiet"});
  State by_command = State::parse(json.out);
  by_command.erase("warnings");
  EXPECT_EQ(State::parse(bytes(folder.file("window.json"))), by_command);
  // The colours are the surface's again without them.
  (void)user.click("colours show the distances from it");
  user.at({20, 890});
  (void)user.same("without distances", before);
  (void)user.key("alt+r");
  EXPECT_TRUE(user.reads("the field has changed since"));
  EXPECT_TRUE(user.click("Remove")["fits"].is_null());
  (void)quitWithoutSaving(user);
}

// What is marked is what is fitted to, without a word; marks are outlines over the distances, and the rest is said to have none.
TEST_F(ResultFiles, distances_from_a_fit_of_marks_lie_under_no_tint_but_while_marks_are_set) {
  openPanel("Fit");
  const auto program = start({scan});
  User user(display, *program, "fit of marks");
  (void)opened(*program);
  (void)user.key("7");
  (void)user.key("b");
  (void)user.drag(1, {240, 300}, {440, 440}, 6);
  EXPECT_EQ(user.key("Escape")["marks_tinted"], true);
  user.at({20, 890});
  const Screen marked = user.look("marked");
  (void)user.click("the simplest");
  (void)user.click("plane");
  EXPECT_TRUE(user.reads("marked, else all"));
  const State fitted = user.key("ctrl+shift+f");
  ASSERT_TRUE(fitted["fits"].is_object()) << fitted["notices"].dump();
  EXPECT_EQ(fitted["colours_are"], "distance");
  EXPECT_EQ(fitted["marks_tinted"], false);
  EXPECT_EQ(fitted["marks_outlined"], true);
  EXPECT_EQ(fitted["without_colour"], "not fitted");
  EXPECT_TRUE(user.reads("fitted to the marked samples"));
  EXPECT_EQ(fitted["marks"], true) << "the setting stays";
  EXPECT_TRUE(user.reads("errors are by the noise between samples"));
  EXPECT_TRUE(user.reads("\u00b1")) << "errors are written one way";
  EXPECT_FALSE(user.reads("+-"));
  EXPECT_FALSE(user.reads(" um"));
  // What is copied reads as on the screen; where it is pasted shows it.
  (void)user.click("Copy");
  (void)user.press("ctrl+o");
  program->until("the dialog",
                 [](const State& s) { return s["dialog"] == "open" && s["text_field"] == true; });
  (void)user.press("ctrl+v");
  const State pasted = program->until(
      "pasted", [](const State& s) { return s["dialog_path"].dump().find("\u00b1") != std::string::npos; });
  EXPECT_EQ(pasted["dialog_path"].dump().find("+-"), std::string::npos) << pasted["dialog_path"];
  EXPECT_EQ(pasted["dialog_path"].dump().find(" um"), std::string::npos) << pasted["dialog_path"];
  (void)user.press("Escape");
  program->until("no dialog", [](const State& s) { return s["dialog"] == "none" && s["settled"] == true; });
  user.at({20, 890});
  const Screen distances = user.changed("distances", marked);
  // Around the box alone: what is inside has the colours that it has without marks.
  (void)user.key("h");
  user.at({20, 890});
  const Screen unmarked = user.changed("distances without marks", distances, 100);
  EXPECT_LT(differing(distances, unmarked, user.surface()), 4 * (200 + 140) * 2);
  (void)user.key("h");
  user.at({20, 890});
  (void)user.same("distances with marks", distances);
  // A hand that marks sees what it marks.
  EXPECT_EQ(user.key("b")["marks_tinted"], true);
  EXPECT_EQ(user.key("Escape")["marks_tinted"], false);
  user.at({20, 890});
  (void)user.same("distances again", distances);
  (void)user.click("colours show the distances from it");
  EXPECT_EQ(program->now()["marks_tinted"], true);
  user.at({20, 890});
  (void)user.same("marked again", marked);
  (void)quitWithoutSaving(user);
}

}  // namespace
}  // namespace fettle::tests
