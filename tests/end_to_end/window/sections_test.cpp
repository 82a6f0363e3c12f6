// Sections of the panel Section: as of the command, kept with the session, dragged.
#include <string>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/end_to_end/window/work_panels.h"

namespace fettle::tests {
namespace {

using State = User::State;

TEST_F(WindowTest, sections_are_measured_as_by_the_command_and_kept_with_the_session) {
  openPanels(folder, {"Section"});
  const std::string work = folder.file("work.fettle");
  State figures;
  {
    const auto program = start({scan});
    User user(display, *program, "sections");
    (void)opened(*program);
    (void)user.key("7");
    user.at({220, 332});
    (void)user.key("q");
    user.at({560, 332});
    (void)user.key("shift+q");
    (void)user.click("step");
    (void)user.click("roughness");
    const State one = settledWith(*program, "figures", [](const State& s) {
      return s["taking_section"] == false && s["section_figures"].contains("roughness");
    });
    EXPECT_EQ(one["sections"], 1);
    EXPECT_TRUE(one["section_figures"].contains("cursors"));
    EXPECT_TRUE(user.reads("between the cursors:"));
    (void)user.key("alt+q");
    user.at({300, 250});
    (void)user.key("q");
    user.at({420, 420});
    (void)user.key("shift+q");
    const State two = settledWith(*program, "another", [](const State& s) {
      return s["sections"] == 2 && s["section"] == 2 && s["section_mm"].is_number() &&
             s["taking_section"] == false;
    });
    EXPECT_FALSE(two["section_figures"].contains("roughness")) << "each has its own";
    user.at({20, 790});
    (void)user.look("two sections");
    (void)user.key("ctrl+shift+q");
    figures = settledWith(*program, "the first again", [](const State& s) {
      return s["section"] == 1 && s["taking_section"] == false && s["section_figures"].contains("roughness");
    })["section_figures"];
    saveAs(user, work);
    (void)quit(user);
  }
  const State kept = jsonOf({"section", work, "--kept"});
  ASSERT_EQ(kept["sections"].size(), 2U) << kept.dump();
  for (const auto& [key, value] : figures.items()) EXPECT_EQ(kept["sections"][0][key], value) << key;
  const auto program = start({work});
  User user(display, *program, "sections again");
  (void)opened(*program);
  const State again = settledWith(*program, "kept sections", [](const State& s) {
    return s["sections"] == 2 && s["taking_section"] == false && s["section_figures"].contains("roughness");
  });
  EXPECT_EQ(again["section_figures"], figures);
  (void)user.click("Remove");
  EXPECT_EQ(settledWith(*program, "one", [](const State& s) { return s["sections"] == 1; })["section"], 1);
  (void)quit(user);
  EXPECT_EQ(jsonOf({"section", work, "--kept"})["sections"].size(), 1U);
}

TEST_F(WindowTest, a_section_is_dragged_by_its_ends_or_as_a_whole) {
  openPanels(folder, {"Section"});
  const auto program = start({scan});
  User user(display, *program, "a dragged section");
  (void)opened(*program);
  (void)user.key("7");
  user.at({220, 332});
  (void)user.key("q");
  user.at({560, 332});
  (void)user.key("shift+q");
  const auto length = [&](const char* what) {
    const State now = settledWith(*program, what, [](const State& s) {
      return s["taking_section"] == false && s["section_mm"].is_number();
    });
    return now["section_mm"].get<double>();
  };
  const double first = length("a section");
  const State view = program->now()["view"];
  user.at({20, 790});
  const Screen before = user.look("a section");

  // An end goes where it is put, from its middle to half of the line; nothing else moves.
  (void)user.drag(1, {560, 332}, {390, 332}, 6);
  EXPECT_NEAR(length("half of it"), 0.5 * first, 0.01 * first);
  EXPECT_EQ(program->now()["view"], view);
  user.at({20, 790});
  (void)user.changed("half of a section", before);
  (void)user.drag(1, {390, 332}, {560, 332}, 6);
  EXPECT_NEAR(length("all of it again"), first, 0.005 * first);

  // Not out of the field, where nothing could take hold of it again.
  (void)user.drag(1, {560, 332}, {760, 332}, 6);
  user.at({20, 790});
  (void)length("up to the border");
  EXPECT_TRUE(user.reads("99.69 mm")) << "the field's last column, 319 times 0.3125 mm";
  (void)user.drag(1, {672, 332}, {560, 332}, 6);
  EXPECT_NEAR(length("back from the border"), first, 0.01 * first);

  // Escape puts it back, with the button still down.
  const double again = length("before Escape");
  user.at({560, 332});
  user.down(1);
  user.at({300, 300});
  EXPECT_LT(length("shorter"), 0.5 * again);
  (void)user.key("Escape");
  EXPECT_EQ(length("put back"), again);
  user.up(1);

  // Beside its ends a line does not hold the view; Ctrl+Shift takes hold of all of it.
  (void)user.drag(1, {330, 332}, {380, 372}, 6);
  EXPECT_NE(program->now()["view"], view);
  EXPECT_EQ(length("the view turned"), again);
  (void)user.key("7");
  (void)user.drag(1, {390, 332}, {390, 392}, 6, "ctrl+shift");
  EXPECT_NEAR(length("moved"), again, 1e-6 * again);

  // A click on another section chooses it.
  (void)user.key("alt+q");
  user.at({300, 500});
  (void)user.key("q");
  user.at({500, 500});
  (void)user.key("shift+q");
  (void)length("another");
  EXPECT_EQ(program->now()["section"], 2);
  user.at({350, 392});
  user.down(1);
  user.up(1);
  EXPECT_EQ(settledWith(*program, "the first", [](const State& s) { return s["section"] == 1; })["sections"],
            2);
  EXPECT_NEAR(length("the first's length"), again, 1e-6 * again);

  // With a tool a press at an end is the tool's.
  (void)user.key("m");
  (void)user.stroke({560, 392}, {540, 420}, 6);
  EXPECT_NEAR(length("not dragged"), again, 1e-6 * again);
  (void)quitWithoutSaving(user);
}

}  // namespace
}  // namespace fettle::tests
