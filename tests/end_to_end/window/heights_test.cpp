// Holes and lines as steps, previewed beside the scan.
#include <algorithm>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "engine/measure/levelled_lines.h"
#include "engine/measure/line_offsets.h"
#include "tests/end_to_end/window/window_fixture.h"
#include "tests/end_to_end/window/work_panels.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

// As the panel does it; `form`: what stays.
engine::Version levelledRows(const engine::Version& field, std::optional<int> form) {
  engine::JobControl job;
  const auto offsets = engine::findLineOffsets(field, {.form_degree = form}, job);
  EXPECT_TRUE(offsets);
  return *engine::levelledLines(field, *offsets, engine::allTiles(field.grid()), job);
}

TEST_F(WindowTest, holes_are_filled_and_lines_levelled_as_steps) {
  openPanels(folder, {"Holes and lines"});
  const Outcome made =
      runProcess({FETTLE_PROGRAM, "synth", scan, "--size", "300x200", "--dropouts", "0.002"});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::string work = folder.file("work.fettle"), filled = folder.file("filled.tif");
  const auto program = start({scan});
  User user(display, *program, "heights");
  (void)opened(*program);
  const State after = user.click("Fill holes");
  EXPECT_EQ(after["steps"], 1) << after["notices"].dump();
  EXPECT_NE(after["heights_found"].get<std::string>().find("holes filled"), std::string::npos);
  EXPECT_EQ(user.key("alt+r")["steps"], 2);
  (void)user.key("ctrl+z");
  const State undone = user.key("ctrl+z");
  EXPECT_EQ(undone["steps"], 0);
  EXPECT_EQ(undone["heights_found"], "") << "nothing is filled any more";
  (void)user.key("ctrl+shift+z");
  saveAs(user, work);
  user.at({20, 790});
  (void)user.look("filled");
  (void)quit(user);
  // A scan that was just opened has the small holes filled, as the panel says; the others are counted.
  const engine::Grid grid = load(scan).grid();
  const double extent_mm = 20.0 * std::max(grid.spacingXMm(), grid.spacingYMm());
  const State by_command = jsonOf({"fill", scan, filled, "--max-extent", fmt::format("{} mm", extent_mm)});
  const State in_session = jsonOf({"info", work});
  EXPECT_EQ(in_session["no_data"], by_command["no_data"]);
  EXPECT_EQ(in_session["filled"], by_command["filled"]);
  const State replayed = jsonOf({"replay", work, folder.file("again.tif")});
  EXPECT_EQ(jsonOf({"compare", folder.file("again.tif"), filled})["max_abs"], 0.0);
}

TEST_F(WindowTest, filled_holes_and_levelled_lines_are_previewed_beside_the_scan) {
  openPanels(folder, {"Holes and lines"});
  const Outcome made =
      runProcess({FETTLE_PROGRAM, "synth", scan, "--size", "300x200", "--dropouts", "0.002"});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::string saved = folder.file("levelled.tif");
  const auto program = start({scan});
  User user(display, *program, "heights");
  (void)opened(*program);
  user.at({20, 790});
  const Screen alone = user.look("scan");
  const State shown = user.click("Preview");
  EXPECT_EQ(shown["heights_preview"], "Fill holes: least curvature") << shown["notices"].dump();
  EXPECT_EQ(shown["steps"], 0);
  EXPECT_NE(shown["heights_found"].get<std::string>().find("holes filled"), std::string::npos);
  EXPECT_TRUE(user.reads("Drop preview"));
  user.at({20, 790});
  (void)user.changed("filled beside the scan", alone);
  const State filled = user.click("Fill holes");
  EXPECT_EQ(filled["steps"], 1);
  EXPECT_TRUE(filled["heights_preview"].is_null());
  const State undone = user.key("ctrl+z");
  EXPECT_EQ(undone["steps"], 0);
  EXPECT_EQ(undone["heights_found"], "");
  EXPECT_EQ(user.key("ctrl+r")["heights_preview"], "Level rows: median, form stays");
  // The preview follows the field.
  (void)user.click("stays");
  user.tap("goes, too");
  (void)program->until("without its form",
                       [](const State& s) { return s["heights_preview"] == "Level rows: median"; });
  user.at({20, 790});
  (void)user.look("levelled beside the scan");
  EXPECT_TRUE(user.key("Escape")["heights_preview"].is_null());
  (void)user.key("ctrl+r");
  EXPECT_TRUE(user.key("ctrl+r")["heights_preview"].is_null());
  (void)user.key("ctrl+r");
  const State levelled = user.key("Return");
  EXPECT_EQ(levelled["steps"], 1);
  EXPECT_TRUE(levelled["heights_preview"].is_null());
  // By a key the panel of removed samples comes, too; what holes gave stands with the holes.
  const auto hasPanel = [](const State& s, const char* name) {
    return std::ranges::find(s["panels"], name) != s["panels"].end();
  };
  EXPECT_FALSE(hasPanel(program->now(), "Remove samples"));
  EXPECT_TRUE(hasPanel(user.key("ctrl+x"), "Remove samples"));
  (void)user.key("ctrl+x");
  (void)user.key("ctrl+h");
  const State texts = program->now()["texts"];
  const auto topOf = [&](const std::string& words) {
    for (const State& t : texts)
      if (t["text"].get<std::string>().find(words) != std::string::npos) return t["at"][1].get<int>();
    ADD_FAILURE() << words << " is not there: " << texts.dump();
    return 0;
  };
  EXPECT_GT(topOf("holes filled"), topOf("only holes up to"));
  EXPECT_TRUE(user.key("Escape")["heights_preview"].is_null());
  saveAs(user, saved);
  (void)quit(user);
  EXPECT_EQ(compare(levelledRows(load(scan), std::nullopt), load(saved)).changed, 0);
}

// Of a large field an approximation comes first, which says how far it is off; the step is the exact one.
TEST_F(WindowTest, levelled_lines_of_a_large_field_are_approximated_first) {
  openPanels(folder, {"Holes and lines"});
  const std::string large = folder.file("large.tif"), saved = folder.file("levelled.tif");
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", large, "--size", "4096x4096", "--seed", "5"});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto program = start({large});
  User user(display, *program, "large heights");
  (void)opened(*program);
  (void)user.press("ctrl+r");
  const State first = program->until("an approximation", [](const State& s) {
    return s["heights_so_far"].get<std::string>().starts_with("approximate, off by about");
  });
  EXPECT_EQ(first["computing_heights"], true);
  (void)user.look("approximate, if soon enough");
  const State full = user.rest("all of it");
  EXPECT_EQ(full["heights_preview"], "Level rows: median, form stays");
  EXPECT_EQ(full["heights_so_far"], "");
  (void)user.look("all of it");
  EXPECT_EQ(user.key("Return")["steps"], 1);
  saveAs(user, saved);
  (void)quit(user);
  EXPECT_EQ(compare(levelledRows(load(large), engine::LineOptions::kUsualFormDegree), load(saved)).changed,
            0);
}

}  // namespace
}  // namespace fettle::tests
