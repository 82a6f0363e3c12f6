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
  SteadyRows() : WindowTest(1300, 1300) {}
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

TEST_F(SteadyRows, no_row_moves_while_forms_and_heights_are_previewed) {
  const auto program = start({scan});
  User user(display, *program, "steady others");
  (void)opened(*program);
  for (const char* header : {"Tool", "Filters", "Steps", "Change since the scan"}) (void)user.click(header);
  for (const char* header : {"Holes and lines", "Form", "Edges", "Measure"}) (void)user.click(header);
  user.at({20, 1290});
  const std::set<std::string> rows{"Fill holes", "Level lines",   "form",  "Fit",         "Take out",
                                   "Put back",   "Suggest edges", "scale", "Measure now", "Haptics"};
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
  const std::set<std::string> rows{"radius", "sigma", "max change", "passes", "Preview", "Apply", "Undo"};
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
  const State before_length = program->now();
  const State same = typed("max change", "15 parsecs", "not understood: 15 parsecs", "max change");
  EXPECT_EQ(same["max_change"], before_length["max_change"]);
  (void)user.look("not understood");
  // Taken, and nothing is said any more.
  EXPECT_EQ(user.enter("max change", "12,5 um")["max_change"], 0.0125);
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
