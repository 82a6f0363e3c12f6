// Places where a line by hand is worth most: searched for by a key, gone to one after the other, hidden.
#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

TEST_F(WindowTest, places_of_most_worth_are_drawn_gone_to_skipped_and_hidden) {
  std::ofstream(folder.path() / "fettle" / "window.json")
      << State{{"edge_lines", true}, {"panels", {{"Edge lines", true}}}};
  // Steps about as high as the noise.
  const Outcome made =
      runProcess({FETTLE_PROGRAM, "synth", scan, "--part", "steps", "--noise", "3", "--size", "320x320"});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto program = start({scan});
  User user(display, *program, "places");
  (void)opened(*program);
  user.at({20, 790});
  (void)user.key("7");
  const State all = program->now();
  const Screen before = user.look("before");
  (void)user.key("z");
  (void)program->until("the first place", [](const State& s) {
    return s["looking_for_places"] == false && s["place"] == 1 && s["settled"] == true;
  });
  State now = program->now();
  const int places = now["places"];
  ASSERT_GE(places, 2);
  EXPECT_GT(now["view"][2], all["view"][2]) << "nearer";
  EXPECT_EQ(now["view"][0], all["view"][0]) << "not turned";
  user.at({20, 790});
  const Screen first = user.changed("at the first", before);
  EXPECT_TRUE(user.reads("place 1 of"));
  (void)user.key("z");
  (void)program->until("the second place",
                       [](const State& s) { return s["place"] == 2 && s["places_skipped"] == 1; });
  now = program->now();
  EXPECT_EQ(now["places"], places);
  user.at({20, 790});
  (void)user.changed("at the second", first);
  // To the end: then none is present, and none is left.
  for (int i = 2; i <= places; ++i) (void)user.key("z");
  (void)program->until("none left", [&](const State& s) { return s["places_skipped"] == places; });
  EXPECT_TRUE(program->now()["place"].is_null());
  (void)user.key("shift+z");
  (void)program->until("hidden", [](const State& s) { return s["places"] == 0; });
  EXPECT_EQ(program->now()["steps"], 0) << "looking changes nothing";
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

}  // namespace
}  // namespace fettle::tests
