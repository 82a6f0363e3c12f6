// Rows of the panels stay where they are while something is computed, shown and dropped, and while notices come and go.
#include <csignal>
#include <fstream>
#include <map>
#include <set>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

// High enough for the panels of the test at once.
class SteadyRows : public WindowTest {
 protected:
  explicit SteadyRows(int height = 1300) : WindowTest(1300, height) {}

  [[nodiscard]] std::string settingsFile() const {
    return (folder.path() / "fettle" / "window.json").string();
  }
  // These panels open, and those closed that are open at first.
  void writePanels(const std::set<std::string>& open) const {
    State panels;
    for (const char* each : {"Tool", "Filters", "Steps", "Change since the scan"}) panels[each] = false;
    for (const std::string& each : open) panels[each] = true;
    std::ofstream(settingsFile()) << State{{"panels", panels}};
  }
};

// Where these texts are. The first of a name that occurs several times.
std::map<std::string, State> placesOf(const State& state, const std::set<std::string>& names) {
  std::map<std::string, State> places;
  for (const State& text : state["texts"])
    if (names.contains(text["text"].get<std::string>())) places.emplace(text["text"], text["at"]);
  return places;
}

TEST_F(SteadyRows, no_row_moves_while_a_preview_begins_is_computed_shown_and_dropped) {
  const std::string large = folder.file("large.tif");
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "synth", large, "--size", "1200x1200", "--seed", "5"}).status, 0);
  const auto program = start({large});
  User user(display, *program, "steady");
  (void)opened(*program);
  for (int i = 0; i < 3; ++i) (void)user.key("n");
  (void)user.enter("window", "61");
  EXPECT_EQ(user.enter("passes", "1000")["filter"], "Bilateral 61 x 61, 1000 passes");
  user.at({20, 1290});
  const std::set<std::string> rows{
      "radius",        "Clear marks", "filter",     "Preview", "Add preview",
      "Apply",         "split line",  "keep marks", "Undo",    "Change since the scan",
      "Sq before, now"};
  const auto before = placesOf(user.rest(), rows);
  EXPECT_EQ(before.size(), rows.size());
  // Minutes of work, which is dropped.
  (void)user.press("p");
  const State computed = program->until("computing, with a first picture", [](const State& s) {
    return s["filtering"] == true && s["texts"].dump().find("\"Cancel\"") != std::string::npos &&
           s["texts"].dump().find("from means of") != std::string::npos;
  });
  EXPECT_EQ(placesOf(computed, rows), before);
  user.tap("Cancel");
  user.at({20, 1290});
  EXPECT_EQ(placesOf(user.rest("cancelled"), rows), before);
  // One that is shown.
  (void)user.enter("window", "3");
  (void)user.enter("passes", "1");
  user.at({20, 1290});
  const State shown = user.key("p");
  EXPECT_EQ(shown["variants"].size(), 1U);
  EXPECT_EQ(placesOf(shown, rows), before);
  (void)user.look("shown");
  const State both = user.key("v");
  EXPECT_EQ(both["variants"].size(), 2U);
  EXPECT_EQ(placesOf(both, rows), before);
  (void)user.key("shift+v");
  const State dropped = user.key("shift+v");
  EXPECT_EQ(dropped["variants"], State::array());
  EXPECT_EQ(placesOf(dropped, rows), before);
  // A step more moves nothing either, nor the tool with which it is made.
  EXPECT_EQ(placesOf(user.key("m"), rows), before);
  EXPECT_EQ(placesOf(user.key("ctrl+i"), rows), before);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

// Filters have different fields: what is pressed stays under the pointer.
TEST_F(SteadyRows, buttons_stay_whatever_fields_a_filter_has) {
  writePanels({"Filters"});
  const auto program = start({scan});
  User user(display, *program, "steady buttons");
  (void)opened(*program);
  user.at({20, 1290});
  const std::set<std::string> buttons{"Preview", "Add preview", "Apply", "Suggest"};
  const auto before = placesOf(user.rest(), buttons);
  EXPECT_EQ(before.size(), buttons.size());
  std::set<std::string> filters;
  for (int i = 0; i < 14; ++i) {
    const State next = user.key("n");
    filters.insert(next["filter"].get<std::string>());
    EXPECT_EQ(placesOf(next, buttons), before) << next["filter"];
  }
  EXPECT_EQ(filters.size(), 14U);
  (void)user.look("filters");
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

// Four panels below each other.
class SteadyForms : public SteadyRows {
 protected:
  SteadyForms() : SteadyRows(1420) {}
};

TEST_F(SteadyForms, no_row_moves_while_forms_and_heights_are_previewed) {
  const auto program = start({scan});
  User user(display, *program, "steady others");
  (void)opened(*program);
  for (const char* header : {"Tool", "Filters", "Steps", "Change since the scan"}) (void)user.click(header);
  for (const char* header : {"Holes and lines", "Form", "Edges", "Measure"}) (void)user.click(header);
  user.at({20, 1290});
  const std::set<std::string> rows{"Fill holes", "Level lines",   "form",  "Fit",         "Take out",
                                   "Put back",   "Suggest edges", "scale", "Measure now", "Section"};
  const auto before = placesOf(user.rest(), rows);
  EXPECT_EQ(before.size(), rows.size());
  EXPECT_EQ(placesOf(user.key("ctrl+shift+l"), rows), before);
  EXPECT_EQ(placesOf(user.key("ctrl+shift+l"), rows), before);
  EXPECT_EQ(placesOf(user.key("shift+l"), rows), before);
  (void)user.look("form out");
  EXPECT_EQ(placesOf(user.key("ctrl+l"), rows), before);
  EXPECT_EQ(placesOf(user.key("ctrl+r"), rows), before);
  (void)user.look("levelled");
  EXPECT_EQ(placesOf(user.key("ctrl+r"), rows), before);
  const State suggested = user.key("e");
  EXPECT_GT(suggested["suggested"], 0);
  EXPECT_EQ(placesOf(suggested, rows), before);
  EXPECT_EQ(placesOf(user.key("Escape"), rows), before);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

// The table of all parameters and what is below it.
class SteadyFigures : public SteadyRows {
 protected:
  SteadyFigures() : SteadyRows(1580) {}
};

// By a click on the button the table takes its place; nothing moves when the figures come, grow old or are measured again.
TEST_F(SteadyFigures, no_row_moves_while_parameters_are_measured) {
  const std::string large = folder.file("large.tif");
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "synth", large, "--size", "1000x1000", "--seed", "5"}).status, 0);
  writePanels({"Measure"});
  const auto program = start({large});
  User user(display, *program, "steady measure");
  (void)opened(*program);
  const std::set<std::string> rows{"Measure now", "Sq", "Spc", "Section", "Transform"};
  user.tap("Measure now");
  const State computed = program->until("being measured", [](const State& s) {
    return s["measuring"] == true && s["texts"].dump().find("\"Cancel\"") != std::string::npos &&
           s["texts"].dump().find("\"Spc\"") != std::string::npos;
  });
  const auto before = placesOf(computed, rows);
  EXPECT_EQ(before.size(), rows.size());
  user.at({20, 1540});
  const State measured = user.rest("measured");
  EXPECT_EQ(measured["measuring"], false);
  EXPECT_FALSE(measured["parameters"].empty());
  EXPECT_EQ(placesOf(measured, rows), before);
  (void)user.look("measured");
  (void)user.key("alt+r");
  const State old = program->until(
      "old", [](const State& s) { return s["parameters_outdated"] == true && s["settled"] == true; });
  EXPECT_EQ(placesOf(old, rows), before);
  (void)user.click("Measure now");
  user.at({20, 1540});
  const State both = user.rest();
  EXPECT_EQ(both["parameters"]["Sq"].size(), 2U);
  EXPECT_EQ(placesOf(both, rows), before);
  (void)user.look("before and after");
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

TEST_F(SteadyRows, no_row_moves_while_a_section_is_taken_changes_and_is_measured) {
  writePanels({"Section"});
  const auto program = start({scan});
  User user(display, *program, "steady section");
  (void)opened(*program);
  user.tap("Along the middle row");
  const std::set<std::string> rows{"between the cursors:", "roughness", "Transform", "Compare", "Haptics"};
  const State first = program->until("a section", [](const State& s) {
    return s["sections"] == 1 && s["texts"].dump().find("\"roughness\"") != std::string::npos;
  });
  const auto before = placesOf(first, rows);
  EXPECT_EQ(before.size(), rows.size());
  user.at({20, 1290});
  const auto taken = [&](bool differs) {
    return program->until("taken", [&](const State& s) {
      return s["section_mm"].is_number() && s["section_before"] == differs && s["taking_section"] == false &&
             s["settled"] == true;
    });
  };
  EXPECT_EQ(placesOf(taken(false), rows), before);
  (void)user.look("a section");
  // With the scan's beside it, and alone again.
  (void)user.press("alt+r");
  EXPECT_EQ(placesOf(taken(true), rows), before);
  (void)user.look("with the scan's");
  (void)user.press("ctrl+z");
  EXPECT_EQ(placesOf(taken(false), rows), before);
  // A cut-off has its place beside the tick.
  const std::set<std::string> ticks{"from x", "mean across", "between the cursors:", "angle", "roughness"};
  const auto unticked = placesOf(user.rest(), ticks);
  EXPECT_EQ(unticked.size(), ticks.size());
  (void)user.click("roughness");
  (void)user.click("angle");
  user.at({20, 1290});
  const State all = program->until("figures", [](const State& s) {
    return s["section_figures"].contains("angle") && s["settled"] == true;
  });
  EXPECT_EQ(placesOf(all, ticks), unticked);
  (void)user.look("all");
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

// Strokes draw edge lines, and undo takes them back, while the hand is at the buttons of the steps.
TEST_F(SteadyRows, no_row_moves_when_edge_lines_come_and_go) {
  std::ofstream(settingsFile()) << State{{"edge_lines", true}, {"panels", {{"Edge lines", true}}}};
  const auto program = start({scan});
  User user(display, *program, "steady lines");
  (void)opened(*program);
  (void)user.key("7");
  user.at({20, 1290});
  const std::set<std::string> rows{"Remove all", "filter", "Preview", "Undo", "Redo"};
  const auto before = placesOf(user.rest(), rows);
  EXPECT_EQ(before.size(), rows.size());
  const auto lines = [&](int number) {
    return program->until("lines", [&](const State& s) {
      return s["lines"] == number && s["marking"] == false && s["settled"] == true;
    });
  };
  (void)user.key("m");
  const State at = program->now()["picture"];
  const int left = at[0].get<int>() + at[2].get<int>() / 5, high = at[1].get<int>() + at[3].get<int>() / 3;
  (void)user.stroke({left, high}, {left + 1, high + 300}, 30);
  user.at({20, 1290});
  (void)lines(1);
  (void)user.key("Escape");
  EXPECT_EQ(placesOf(user.rest(), rows), before);
  (void)user.look("a line");
  EXPECT_EQ(placesOf((user.tap("Undo"), lines(0)), rows), before);
  EXPECT_EQ(placesOf((user.tap("Redo"), lines(1)), rows), before);
  (void)user.press("ctrl+z");
  EXPECT_EQ(placesOf(lines(0), rows), before);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

// Figures of the change come into rows that are there before them.
TEST_F(SteadyRows, no_row_moves_when_the_change_is_first_measured) {
  const std::string large = folder.file("large.tif");
  ASSERT_EQ(runProcess({FETTLE_PROGRAM, "synth", large, "--size", "3000x3000", "--seed", "5"}).status, 0);
  writePanels({"Change since the scan"});
  const auto program = start({large});
  User user(display, *program, "steady change");
  const std::set<std::string> rows{"largest", "unchanged", "Measure", "Section"};
  const State first = program->until("nothing measured yet", [](const State& s) {
    return s.contains("texts") && s["texts"].dump().find("measuring ...") != std::string::npos;
  });
  const auto before = placesOf(first, rows);
  EXPECT_EQ(before.size(), rows.size());
  user.at({20, 1290});
  const State known = program->until("measured", [](const State& s) {
    return s["settled"] == true && s["texts"].dump().find("nothing has changed") != std::string::npos;
  });
  EXPECT_EQ(placesOf(known, rows), before);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

TEST_F(SteadyRows, notices_come_and_go_under_the_rows) {
  // Without a word about its unit or its spacing.
  const std::string plain = folder.file("plain.txt");
  {
    std::ofstream file(plain);
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 40; ++x) file << (x * y) % 7 << ' ';
      file << '\n';
    }
  }
  const auto program = start({plain});
  User user(display, *program, "notices");
  (void)opened(*program);
  user.at({20, 1290});
  const std::set<std::string> rows{"radius", "Preview", "Undo", "Change since the scan"};
  const State said = user.rest();
  EXPECT_FALSE(said["notices"].empty());
  const auto before = placesOf(said, rows);
  EXPECT_EQ(before.size(), rows.size());
  (void)user.look("with notices");
  const State gone = user.click("Understood");
  EXPECT_TRUE(gone["notices"].empty());
  EXPECT_EQ(placesOf(gone, rows), before);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  // By key, too.
  const auto again = start({plain, "--theme", "light"});
  User other_user(display, *again, "notices again");
  EXPECT_FALSE(opened(*again)["notices"].empty());
  (void)other_user.look("light");
  EXPECT_TRUE(other_user.key("alt+n")["notices"].empty());
  again->signal(SIGTERM);
  EXPECT_EQ(again->wait(), 0) << again->err();
}

TEST_F(SteadyRows, what_is_said_of_a_number_that_was_typed_moves_no_row) {
  const auto program = start({scan});
  User user(display, *program, "steady numbers");
  (void)opened(*program);
  for (int i = 0; i < 3; ++i) (void)user.key("n");
  EXPECT_TRUE(user.key("x")["max_change"].is_number());
  user.at({20, 1290});
  const std::set<std::string> rows{"radius", "sigma", "keep within", "passes", "Preview", "Apply", "Undo"};
  const auto before = placesOf(user.rest(), rows);
  EXPECT_EQ(before.size(), rows.size());
  const auto typed = [&](const char* field, const char* what, const char* said, const char* reads) {
    const State now = user.enter(field, what);
    EXPECT_TRUE(user.reads(said)) << what << ": " << now["texts"];
    EXPECT_TRUE(user.reads(reads)) << what << ": " << now["texts"];
    EXPECT_EQ(placesOf(now, rows), before) << what;
    return now;
  };
  (void)typed("sigma", "2000", "at its largest", "1000.00 samples");
  (void)user.look("largest");
  (void)typed("sigma", "-3", "at its smallest", "0: ");
  (void)typed("passes", "99999", "at its largest", "1000");
  (void)typed("sigma", "twelve", "not understood: twelve", "0: ");
  (void)typed("range sigma", "15 parsecs", "not understood: 15 parsecs", "range sigma");
  (void)user.look("not understood");
  // Taken, and nothing is said any more.
  (void)user.enter("range sigma", "12,5 um");
  EXPECT_FALSE(user.reads("not understood"));
  EXPECT_FALSE(user.reads("at its"));
  // By Tab, with the next field entered, it stays until a click.
  ASSERT_TRUE(user.typeIn("sigma", "2000"));
  (void)user.press("Tab");
  program->until("said", [](const State& s) {
    return s["texts"].dump().find("\"at its largest\"") != std::string::npos;
  });
  user.at({20, 1290});
  user.down(1);
  user.up(1);
  program->until("not said any more", [](const State& s) {
    return s["texts"].dump().find("\"at its largest\"") == std::string::npos;
  });
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

}  // namespace
}  // namespace fettle::tests
