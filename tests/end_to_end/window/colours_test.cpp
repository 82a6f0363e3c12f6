// The range of the colours: found so that a small change is seen beside a large one, dragged on the histogram, typed,
// chosen by a share; a tolerance and the interval of contour lines.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "engine/field/builder.h"
#include "engine/formats/formats.h"
#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

class ColoursTest : public WindowTest {
 protected:
  void SetUp() override {
    WindowTest::SetUp();
    State panels{{"Colours", true}};
    for (const char* closed : {"Tool", "Filters", "Steps", "Change since the scan"}) panels[closed] = false;
    std::ofstream(folder.path() / "fettle" / "window.json")
        << State{{"edge_lines", false}, {"panels", panels}};
  }
  // Waits until the histogram is there and the window rests.
  static State counted(ViewProgram& program) {
    return program.until("the histogram", [](const State& s) {
      return s["settled"] == true && s["colour_handles"].is_array();
    });
  }
};

TEST_F(ColoursTest, handles_are_dragged_ends_are_typed_and_a_rule_leads_back) {
  const auto program = start({scan});
  User user(display, *program, "colours");
  (void)opened(*program);
  const State first = counted(*program);
  EXPECT_EQ(first["colour_rule"], "automatic");
  const double low = first["colours"][0], high = first["colours"][1];
  const State handles = first["colour_handles"];
  const int low_x = handles[0], high_x = handles[1], y = handles[2];
  ASSERT_GT(high_x - low_x, 60);
  user.at({20, 790});  // where the cursor lies in no picture
  const Screen before = user.look("automatic");
  // Half the way to the other end.
  const int middle = (low_x + high_x) / 2;
  const State dragged = user.drag(1, {high_x, y}, {middle, y}, 4);
  EXPECT_EQ(dragged["colour_rule"], "typed");
  EXPECT_EQ(dragged["colours"][0], low);
  // A pixel of the histogram is so much.
  const double per_px = (high - low) / (high_x - low_x);
  EXPECT_NEAR(dragged["colours"][1], 0.5 * (low + high), 2.0 * per_px);
  const Screen narrow = user.changed("dragged", before, 2000);
  const State lower = user.drag(1, {low_x, y}, {low_x + 20, y}, 4);
  EXPECT_NEAR(lower["colours"][0], low + 20.0 * per_px, 2.0 * per_px);
  EXPECT_EQ(lower["colours"][1], dragged["colours"][1]);
  // Upside down the same samples keep their place in the range.
  const State over = user.key("i");
  EXPECT_EQ(over["colours"][0], -lower["colours"][1].get<double>());
  (void)user.key("i");
  const State typed = user.enter("highest", "7.5");
  EXPECT_NEAR(typed["colours"][1], 7.5, 1e-9);
  (void)user.click("by hand");
  const State back = user.click("usual");
  EXPECT_EQ(back["colour_rule"], "automatic");
  EXPECT_EQ(back["colours"], first["colours"]);
  (void)user.same("automatic again", before);
  // Lines at an interval.
  (void)user.key("c");
  EXPECT_GT(user.rest()["contour_step"], 0.0);
  EXPECT_EQ(user.enter("a line every", "0.75")["contour_step"], 0.75);
  (void)user.changed("contour lines", before, 200);
  (void)quit(user);
}

// Names of fields are their panel's own: the filter's range is a text, that of colours a list.
TEST_F(ColoursTest, a_range_is_typed_beside_the_range_of_colours) {
  const auto program = start({scan});
  User user(display, *program, "ranges");
  (void)opened(*program);
  for (int i = 0; i < 3; ++i) (void)user.key("n");
  (void)user.click("Filters");
  ASSERT_TRUE(user.readsScrolled("range sigma"));
  const State typed = user.enter("range sigma", "12,5 um");
  EXPECT_EQ(typed["colour_rule"], "automatic");
  EXPECT_FALSE(user.reads("not understood"));
  (void)quit(user);
}

TEST_F(ColoursTest, a_small_change_is_seen_beside_an_edge_that_moved_and_a_tolerance_hides_it) {
  const auto program = start({scan});
  User user(display, *program, "change");
  (void)opened(*program);
  (void)user.key("shift+j");  // the axes have colours of their own
  (void)counted(*program);
  // Over ribs and plain alike.
  (void)user.key("s");
  (void)user.stroke({250, 330}, {480, 400}, 10);
  user.at({20, 790});
  const Screen without = user.look("heights");
  EXPECT_EQ(user.key("d")["deviation"], true);
  const State found = counted(*program);
  const double automatic = found["colours"][1];
  const Screen seen = user.changed("changes", without, 500);
  // All of what changed: far more.
  (void)user.click("usual");
  const State all = user.click("all");
  EXPECT_EQ(all["colour_rule"], "all");
  EXPECT_GT(all["colours"][1], 3.0 * automatic);
  const Screen pale = user.changed("all changes", seen);
  (void)user.click("all");
  const State half = user.click("a share");
  EXPECT_EQ(half["colour_rule"], "share");
  EXPECT_LT(half["colours"][1], all["colours"][1]);
  EXPECT_LT(user.enter("share", "50")["colours"][1], automatic);
  (void)user.until("half of the changes",
                   [&](const Screen& now) { return differing(now, pale, user.surface()) > 30; });
  (void)user.key("Escape");  // the stylus has colours of its own
  // A tolerance beyond the range: nothing differs from white but the light.
  const State within = user.enter("as zero up to", "100000");
  EXPECT_GT(within["tolerance"], 0.0);
  const auto coloured = [part = user.surface()](const Screen& screen) {
    int count = 0;
    for (int y = part.y; y < part.y + part.height; ++y)
      for (int x = part.x; x < part.x + part.width; ++x) {
        const std::uint8_t* p = screen.at(x, y);
        count += std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}) > 40;
      }
    return count;
  };
  const int before = coloured(seen);
  EXPECT_GT(before, 100);
  (void)user.until("all within the tolerance", [&](const Screen& now) { return coloured(now) < before / 4; });
  (void)quitWithoutSaving(user);
  // The share is kept for the next start, what was typed is not.
  const auto again = start({scan});
  User next(display, *again, "next");
  (void)opened(*again);
  const State kept = next.rest();
  EXPECT_EQ(kept["deviation"], true) << "as it was left";
  EXPECT_EQ(kept["colour_rule"], "share");
  EXPECT_EQ(kept["tolerance"], 0.0);
  (void)quit(next);
}

TEST_F(ColoursTest, what_has_a_sign_keeps_the_map_with_a_middle) {
  const auto program = start({scan});
  User user(display, *program, "signed");
  (void)opened(*program);
  (void)user.key("s");
  (void)user.stroke({250, 330}, {480, 400}, 10);
  (void)user.key("Escape");
  EXPECT_EQ(user.key("k")["map"], 1) << "heights in another map";
  user.at({20, 790});
  const State change = user.key("d");
  constexpr int kDiverging = 4;
  EXPECT_EQ(change["colour_map"], kDiverging);
  EXPECT_EQ(change["colours"][0], -change["colours"][1].get<double>());
  EXPECT_EQ(change["colours_are"], "deviation");
  const Screen seen = user.look("change");
  EXPECT_TRUE(user.reads("diverging, white at zero"));
  const State next = user.key("k");
  EXPECT_EQ(next["colour_map"], kDiverging);
  EXPECT_EQ(next["map"], 1) << "that of heights is chosen while they are seen";
  EXPECT_NE(next["status"].get<std::string>().find("white at zero"), std::string::npos);
  (void)user.same("the same map", seen);
  EXPECT_EQ(user.key("d")["colour_map"], 1);
  (void)quitWithoutSaving(user);
}

// Outliers that are gone would leave half of the colours to nothing.
TEST_F(ColoursTest, the_range_follows_a_step_that_moves_the_extremes) {
  // A tenth of the scan lies far below the rest: more than single spikes, which never count.
  const std::string pit = folder.file("pit.tif");
  const engine::Version field = load(scan);
  std::vector<float> z;
  for (std::int32_t r = 0; r < field.grid().height; ++r)
    for (std::int32_t c = 0; c < field.grid().width; ++c)
      z.push_back(c < field.grid().width / 10 ? -40.0F : field.reader().heightAt(c, r));
  engine::JobControl job;
  ASSERT_TRUE(engine::exportField(engine::makeField(field.grid(), z, {}), pit, {}, job));
  const auto program = start({pit});
  User user(display, *program, "extremes");
  (void)opened(*program);
  const State first = counted(*program);
  EXPECT_EQ(first["colour_rule"], "automatic");
  EXPECT_LT(first["colours"][0].get<double>(), -39.0);
  (void)user.click("Colours");
  (void)user.click("Remove samples");
  user.at({20, 790});
  const Screen before = user.look("with the pit");
  (void)user.enter("lower than", "-20 mm");
  const State after = user.click("Remove");
  EXPECT_EQ(after["steps"], 1) << after["notices"].dump();
  EXPECT_GT(after["colours"][0].get<double>(), -20.0) << "it follows";
  EXPECT_EQ(after["view"], first["view"]);
  user.at({20, 790});
  const Screen gone = user.changed("without it", before, 2000);
  EXPECT_EQ(user.key("ctrl+z")["colours"], first["colours"]);
  user.at({20, 790});
  (void)user.same("with the pit again", before);
  EXPECT_EQ(user.key("ctrl+shift+z")["colours"], after["colours"]);
  user.at({20, 790});
  (void)user.same("without it again", gone);
  // A brush leaves them, whatever it does to the extremes; and what a person set stays.
  (void)user.key("s");
  (void)user.stroke({300, 330}, {400, 380}, 6);
  (void)user.key("Escape");
  EXPECT_EQ(program->now()["steps"], 2);
  EXPECT_EQ(program->now()["colours"], after["colours"]);
  (void)user.click("Remove samples");
  (void)user.click("Colours");
  const State typed = user.enter("highest", "7.5");
  EXPECT_EQ(typed["colour_rule"], "typed");
  (void)user.key("ctrl+z");
  EXPECT_EQ(user.key("ctrl+z")["colours"], typed["colours"]);
  (void)quit(user);
}

}  // namespace
}  // namespace fettle::tests
