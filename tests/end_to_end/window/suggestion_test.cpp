// A filter suggested in the window: the same as by the command, with reasons and times, taken into the fields by a click.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

class SuggestionTest : public WindowTest {
 protected:
  SuggestionTest() : WindowTest(1300, 1000) {}

  // What the command lists for the scan: the suggested filter first.
  [[nodiscard]] State listedByCommand(const std::string& tolerance) const {
    const Outcome out =
        runProcess({FETTLE_PROGRAM, "filter", scan, "--suggest", "--tolerance", tolerance, "--json"});
    EXPECT_EQ(out.status, 0) << out.err;
    const State report = State::parse(out.out, nullptr, false);
    EXPECT_TRUE(report.is_object()) << out.out;
    return report;
  }
  static State tried(ViewProgram& program) {
    return program.until("filters listed", [](const State& s) {
      return s["trying_filters"] == false && !s["listed_filters"].empty() && s["settled"] == true;
    });
  }
  // The first line of a name on the panels, as it is written.
  static std::string firstLine(ViewProgram& program, const std::string& name) {
    std::string first;
    program.until(name, [&](const State& s) {
      for (const State& text : s["texts"])
        if (const std::string line = text["text"]; line.size() > 3 && name.starts_with(line)) first = line;
      return !first.empty() && s["settled"] == true;
    });
    return first;
  }
};

TEST_F(SuggestionTest, is_that_of_the_command_and_is_taken_previewed_applied_and_undone) {
  const State report = listedByCommand("10um");
  const auto program = start({scan});
  User user(display, *program, "suggestion");
  (void)opened(*program);
  (void)user.click("Suggested filters");
  (void)user.enter("allowed error", "10 um");
  (void)user.look("before");
  user.tap("Try filters");
  program->until("being tried", [](const State& s) {
    return s["trying_filters"] == true && s["texts"].dump().find("trying filters") != std::string::npos;
  });
  const State found = tried(*program);
  user.at({20, 990});
  (void)user.look("listed");
  // The command's pick is first; all that it lists is here for the same reasons.
  const State& listed = found["listed_filters"];
  EXPECT_EQ(listed[0]["method"], report["pick"]["method"]);
  int by_command = 0;
  for (const State& c : report["candidates"]) {
    if (c["why"].is_null()) continue;
    ++by_command;
    const bool here = std::any_of(listed.begin(), listed.end(),
                                  [&](const State& each) { return each["method"] == c["method"]; });
    EXPECT_TRUE(here) << c.dump();
  }
  EXPECT_EQ(std::ssize(listed), by_command);
  for (const char* each : {"leaves", "takes about"}) EXPECT_TRUE(user.reads(each)) << each;

  const State chosen = user.click(firstLine(*program, listed[0]["name"]));
  EXPECT_EQ(chosen["filter"], listed[0]["filter"]);
  EXPECT_EQ(chosen["variants"], State::array({listed[0]["filter"]}));
  EXPECT_EQ(chosen["listed_are_outdated"], false) << "a preview changes nothing";
  (void)user.look("previewed");
  const State applied = user.click("Apply");
  EXPECT_EQ(applied["filters_applied"], 1);
  EXPECT_EQ(applied["steps"], 1);
  EXPECT_EQ(applied["listed_are_outdated"], true);
  EXPECT_TRUE(user.readsScrolled("Try filters"));
  EXPECT_TRUE(user.reads("the scan has changed"));
  (void)user.look("outdated");
  const State undone = user.key("ctrl+z");
  EXPECT_EQ(undone["steps"], 0);
  EXPECT_EQ(undone["listed_are_outdated"], false);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

TEST_F(SuggestionTest, begins_by_key_ends_by_cancel_and_goes_with_its_scan) {
  const std::string plane = folder.file("plane.asc");
  std::ofstream out(plane);
  out << "ncols 96\nnrows 64\nxllcenter 0\nyllcenter 0\ncellsize 1\n";
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 96; ++c) out << 100 + c << (c == 95 ? '\n' : ' ');
  out.close();
  const auto program = start({scan});
  User user(display, *program, "suggestion by key");
  (void)opened(*program);
  (void)user.press("ctrl+f");
  program->until("being tried", [](const State& s) {
    return s["trying_filters"] == true && s["texts"].dump().find("\"Cancel\"") != std::string::npos;
  });
  (void)user.look("trying");
  user.tap("Cancel");
  const State ended = user.rest("cancelled");
  EXPECT_EQ(ended["trying_filters"], false);
  EXPECT_EQ(ended["listed_filters"], State::array());
  EXPECT_EQ(ended["notices"], State::array());
  (void)user.press("ctrl+f");
  program->until("being tried", [](const State& s) { return s["trying_filters"] == true; });
  EXPECT_EQ(user.key("Escape")["trying_filters"], false) << "Esc ends it, too";
  // From the button beside the filters, and kept by an edit that is undone.
  user.tap("Suggest");
  EXPECT_FALSE(tried(*program)["listed_filters"].empty());
  EXPECT_EQ(user.key("ctrl+i")["listed_are_outdated"], true);
  EXPECT_EQ(user.key("ctrl+z")["listed_are_outdated"], false);
  // Of another scan it says nothing.
  EXPECT_EQ(other.drop(other.windowOf("fettle"), {plane}), "");
  program->until("a question or the plane", [&](const State& s) {
    return (s["path"] == plane || s["dialog"] == "import") && s["settled"] == true;
  });
  if (program->now()["dialog"] == "import") (void)user.press("Return");
  const State other_scan =
      program->until("the plane", [&](const State& s) { return s["path"] == plane && s["settled"] == true; });
  EXPECT_EQ(other_scan["listed_filters"], State::array());
  (void)user.press("ctrl+f");
  const State none =
      program->until("nothing", [](const State& s) { return s["no_filter"] != "" && s["settled"] == true; });
  EXPECT_EQ(none["listed_filters"], State::array());
  EXPECT_TRUE(user.readsScrolled("Try filters"));
  EXPECT_TRUE(user.reads("Nothing helps"));
  (void)user.look("nothing");
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

TEST_F(SuggestionTest, an_entry_is_taken_by_keyboard_alone) {
  const std::filesystem::path settings = folder.path() / "fettle";
  std::filesystem::create_directories(settings);
  std::ofstream(settings / "window.json") << State{{"panels", {{"Tool", false}, {"Filters", true}}}};
  const auto program = start({scan});
  User user(display, *program, "suggestion by keyboard");
  (void)opened(*program);
  (void)user.press("ctrl+f");
  (void)tried(*program);
  EXPECT_EQ(program->now()["variants"], State::array());
  (void)user.key("F6");
  // Tool, Edges, Edge lines, Suggested filters, its two fields, its button, then the list.
  for (int i = 0; i < 7; ++i) (void)user.key("Down");
  (void)user.look("pointed at");
  const State taken = user.key("space");
  EXPECT_EQ(taken["variants"].size(), 1U);
  EXPECT_EQ(taken["variants"][0], taken["filter"]);
  (void)user.look("taken");
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

}  // namespace
}  // namespace fettle::tests
