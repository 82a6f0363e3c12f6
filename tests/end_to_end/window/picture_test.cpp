// The picture itself, pixel by pixel: what it shows of an inverted field, and how near several of them come
// to rest.
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

using State = User::State;

// Colours within a part, counted coarsely: 32 steps of a channel.
int coloursIn(const Screen& screen, const Part& part) {
  std::vector<int> codes;
  for (int y = part.y; y < part.y + part.height; ++y)
    for (int x = part.x; x < part.x + part.width; ++x) {
      const std::uint8_t* p = screen.at(x, y);
      codes.push_back(p[0] >> 3 << 10 | p[1] >> 3 << 5 | p[2] >> 3);
    }
  std::sort(codes.begin(), codes.end());
  return static_cast<int>(std::unique(codes.begin(), codes.end()) - codes.begin());
}

// Correlation of the lightness of two screens within a part: -1 .. 1; 0 where one of them has one colour.
double correlation(const Screen& a, const Screen& b, const Part& part) {
  double n = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (int y = part.y; y < part.y + part.height; ++y)
    for (int x = part.x; x < part.x + part.width; ++x, ++n) {
      const auto light = [&](const Screen& s) {
        const std::uint8_t* p = s.at(x, y);
        return 0.2 * p[0] + 0.7 * p[1] + 0.1 * p[2];
      };
      const double u = light(a), v = light(b);
      sa += u, sb += v, saa += u * u, sbb += v * v, sab += u * v;
    }
  const double spread = (saa - sa * sa / n) * (sbb - sb * sb / n);
  return spread > 1e-9 ? (sab - sa * sb / n) / std::sqrt(spread) : 0.0;
}

TEST_F(WindowTest, edges_become_smooth_at_rest_and_a_stroke_goes_on_at_once) {
  const auto program = start({scan}, {}, AtRest::kSmooth);
  User user(display, *program, "smooth");
  (void)opened(*program);
  user.at({20, 790});  // where it lies in no picture
  const auto smooth = [](ViewProgram& of, const std::string& what) {
    return of.until(what, [](const State& s) { return s["smooth"] == true && s["settled"] == true; });
  };
  (void)smooth(*program, "smooth");
  const Screen first = user.look("four rays");
  (void)user.key("7");
  (void)smooth(*program, "smooth from above");
  const Screen above = user.look("four rays from above");
  (void)user.key("1");
  (void)smooth(*program, "smooth from the side");
  (void)user.key("7");
  (void)smooth(*program, "smooth from above again");
  EXPECT_EQ(differing(above, user.look("four rays from above again"), user.surface()), 0);

  (void)user.key("s");
  EXPECT_EQ(user.stroke({240, 332}, {340, 332}, 4)["steps"], 1);
  (void)smooth(*program, "smooth after a stroke");
  (void)user.press("ctrl+z");
  user.at({20, 790});
  (void)program->until("the stroke is undone", [](const State& s) { return s["smooth"] == false; });
  (void)smooth(*program, "smooth after it was undone");
  EXPECT_EQ(quit(user)["validation_messages"], State::array());

  // Without it one ray decides a pixel's colour, most of all along edges.
  const auto plain = start({scan});
  User another(display, *plain, "plain");
  (void)opened(*plain);
  another.at({20, 790});
  const Screen one = another.look("one ray");
  EXPECT_GT(differing(first, one, another.surface()), 500);
  EXPECT_EQ(plain->now()["smooth"], false);
  EXPECT_EQ(quit(another)["validation_messages"], State::array());
}

TEST_F(WindowTest, an_inverted_field_shows_its_relief_and_so_does_the_field_turned_back) {
  const auto program = start({scan});
  User user(display, *program, "invert");
  (void)opened(*program);
  user.at({20, 790});  // where it lies in no picture
  const State above = user.key("7");
  const double low = above["colours"][0], high = above["colours"][1];
  ASSERT_LT(low, high);
  const Screen upright = user.look("upright");
  const Part surface = user.surface();
  // The field's middle: no ground next to it, no plinth.
  const Part middle{surface.x + surface.width / 4, surface.y + surface.height / 4, surface.width / 2,
                    surface.height / 2};
  // Right of the surface stands the colour bar.
  const State area = above["picture"];
  const Part bar{area[0].get<int>() + area[2].get<int>() - 120, surface.y, 116, surface.height};
  const int many = coloursIn(upright, middle);
  EXPECT_GT(many, 100);

  const auto turned = [&](const char* what, const Screen& before) {
    const State inverted = user.key("i");
    EXPECT_EQ(inverted["inverted"], true);
    EXPECT_EQ(inverted["colours"], (State{-high, -low})) << what;
    const Screen now = user.changed(what, before, 2000);
    EXPECT_GT(coloursIn(now, middle), many / 2) << what;
    // What was high and light is low and dark.
    EXPECT_LT(correlation(before, now, middle), -0.5) << what;
    EXPECT_GT(differing(before, now, bar), 20) << what << ": the numbers of the bar";
    return now;
  };
  const auto back = [&](const char* what) {
    const State again = user.key("i");
    EXPECT_EQ(again["inverted"], false);
    EXPECT_EQ(again["colours"], (State{low, high})) << what;
    const Screen now = user.same(what, upright);
    EXPECT_EQ(differing(now, upright, bar), 0) << what;
  };
  const Screen inverted = turned("upside down", upright);
  back("right side up");
  (void)turned("upside down again", upright);
  // The deviation map reads all ranges again.
  EXPECT_EQ(user.key("d")["deviation"], true);
  (void)user.changed("deviation upside down", inverted, 300);
  EXPECT_EQ(user.key("d")["deviation"], false);
  (void)user.same("without deviation", inverted);
  back("right side up after it");
  const State report = quit(user);
  EXPECT_EQ(report["unsaved_changes"], false);
}

// Large enough that the colours of four panels come from every sample.
class WideWindowTest : public WindowTest {
 protected:
  WideWindowTest() : WindowTest(1600, 960) {}
};

TEST_F(WideWindowTest, four_pictures_side_by_side_come_to_rest_as_near_as_one) {
  // Of a million samples, four states are more than the device holds as a whole.
  const std::string large = folder.file("large.tif");
  const Outcome made = runProcess({FETTLE_PROGRAM, "synth", large, "--size", "1000x1000", "--seed", "5"});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto program = start({large});
  User user(display, *program, "four");
  const State one = opened(*program);
  ASSERT_EQ(one["bounds_px"].size(), 1U);
  const double bound = one["bounds_px"][0];
  EXPECT_LE(bound, 3.0);
  user.at({20, 950});
  (void)user.key("n");
  EXPECT_EQ(user.key("p")["variants"].size(), 1U);
  (void)user.key("shift+p");
  for (const std::size_t variants : {2U, 3U}) {
    (void)user.key("n");
    EXPECT_EQ(user.click("Add preview")["variants"].size(), variants);
  }
  user.at({20, 950});
  const State rest = user.rest();
  ASSERT_EQ(rest["bounds_px"].size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    // Each is smaller on the screen than the one was.
    EXPECT_LE(rest["bounds_px"][i], bound) << i;
    // Else it says why: the vertices that one takes as well, never that the device holds too little.
    EXPECT_EQ(rest["limits"][i], rest["bounds_px"][i] > 1.0 ? "vertices" : "none") << i;
  }
  const Screen four = user.look("four");
  // And they stay so: no frame of theirs is coarse again.
  (void)user.key("Tab");
  (void)user.key("Tab");
  (void)user.same("four again", four);
  (void)quit(user);
}

}  // namespace
}  // namespace fettle::tests
