// Where accuracy is chosen: what each choice costs and gives away is measured on the scan that is open, when
// the list is opened, and the choice is felt and seen.
#include <csignal>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

// Entries of an open list whose figures end like this: " N", " ms".
int figuresIn(const State& s, const std::string& unit) {
  int found = 0;
  for (const State& t : s["texts"]) {
    const auto text = t["text"].get<std::string>();
    found += text.size() > unit.size() + 1 && text.ends_with(" " + unit);
  }
  return found;
}

bool reads(const State& s, const std::string& text) {
  return s["texts"].dump().find(text) != std::string::npos;
}

TEST_F(WindowTest, levels_of_contact_and_detail_are_chosen_by_what_they_cost_on_this_scan) {
  const auto program = start({scan});
  User user(display, *program, "choices");
  const State opened_with = opened(*program);
  EXPECT_EQ(opened_with["contact_level"], "certified");
  EXPECT_EQ(opened_with["measured"], (State{false, false})) << "nothing is measured before it is asked for";
  for (const char* header : {"Tool", "Filters", "Steps"}) (void)user.click(header);
  (void)user.click("Haptics");
  user.tap("certified, 6 cells");
  program->until("figures of contact", [](const State& s) { return s["measured"][0] == true; });
  // Twelve choices, each with a distance.
  program->until("figures in the list", [](const State& s) { return figuresIn(s, "\u00b5m") >= 12; });
  (void)user.look("contact list");
  user.tap("paper");
  program->until("paper", [](const State& s) { return s["contact_level"] == "paper"; });
  program->until("what it costs, and the list closed", [](const State& s) {
    return reads(s, "error of the contact point") && !reads(s, "ball, radius 2 cells");
  });
  (void)user.look("contact chosen");
  user.tap("paper");
  program->until("the list again", [](const State& s) { return reads(s, "ball, radius 2 cells"); });
  user.tap("ball, radius 2 cells");
  program->until("a ball", [](const State& s) { return s["contact_level"] == "ball"; });

  (void)user.click("Haptics");
  (void)user.click("Display");
  user.tap("64 k vertices");
  program->until("figures of detail", [](const State& s) { return s["measured"][1] == true; });
  program->until("figures in the list", [](const State& s) { return figuresIn(s, "ms") >= 5; });
  (void)user.look("detail list");
  user.tap("16 k vertices");
  program->until("fewer vertices",
                 [](const State& s) { return s["vertices"] == 16384 && s["settled"] == true; });
  program->until("what it costs", [](const State& s) { return reads(s, "of 255") && !reads(s, "256 k"); });
  (void)user.look("detail chosen");
  EXPECT_EQ(program->now()["notices"], State::array());
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

}  // namespace
}  // namespace fettle::tests
