// Drawing under load: what adapts to the time that frames take.
#include <chrono>
#include <set>
#include <thread>

#include "tests/end_to_end/window/frame_gate.h"
#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using namespace std::chrono_literals;
using State = User::State;

constexpr auto kHeldUp = 60ms;  // a frame, at least

class LoadTest : public WindowTest {
 protected:
  LoadTest() : WindowTest(Frames::kThroughVulkan) {}

  // Turns the view by hand, each frame being held up; what the frames said of their sharpness.
  std::set<std::string> turnSlowly(User& user) {
    ViewProgram& program = user.program();
    user.at({300, 400});
    user.down(2);
    program.each([](const State&) {});
    std::set<std::string> seen;
    const auto look = [&](const State& s) { seen.insert(s["sharpness"]); };
    EXPECT_TRUE(gate_.hold());
    for (int i = 1; i <= 12; ++i) {
      display.hands({"mousemove", std::to_string(300 + 10 * i), "400"});
      std::this_thread::sleep_for(kHeldUp);
      EXPECT_TRUE(gate_.step());
      program.each(look);
    }
    gate_.release();
    user.up(2);
    program.each(look);
    return seen;
  }

  // Shows contour lines and hides them by a key, each frame being held up; what the frames said of their sharpness.
  std::set<std::string> pressSlowly(User& user) {
    ViewProgram& program = user.program();
    program.each([](const State&) {});
    std::set<std::string> seen;
    const auto look = [&](const State& s) { seen.insert(s["sharpness"]); };
    EXPECT_TRUE(gate_.hold());
    for (int i = 0; i < 12; ++i) {
      display.hands({"key", "c"});
      std::this_thread::sleep_for(kHeldUp);
      EXPECT_TRUE(gate_.step());
      program.each(look);
    }
    gate_.release();
    return seen;
  }

  // Moves the stylus over the part, each frame being held up; whether drawing left something out.
  bool moveSlowly(User& user) {
    ViewProgram& program = user.program();
    program.each([](const State&) {});
    bool spares = false;
    EXPECT_TRUE(gate_.hold());
    for (int i = 1; i <= 12; ++i) {
      display.hands({"mousemove", std::to_string(300 + 5 * i), "400"});
      std::this_thread::sleep_for(kHeldUp);
      EXPECT_TRUE(gate_.step());
      program.each([&](const State& s) { spares = spares || s["spares"] == true; });
    }
    gate_.release();
    return spares;
  }

  FrameGate gate_{folder.file("gate")};
};

TEST_F(LoadTest, the_pens_shadow_is_left_out_while_frames_take_long_and_drawn_when_it_rests) {
  const auto program = start({scan}, gate_.environment());
  User user(display, *program, "shadow");
  (void)opened(*program);
  constexpr Part kInShadow{355, 430, 60, 35};  // of a pen at {330, 400}
  (void)user.rest();
  const Screen bare = user.look("no pen");
  const auto shadow = [&](const Screen& screen) { return differing(bare, screen, kInShadow) > 200; };
  (void)user.key("s");
  user.at({330, 400});
  (void)user.rest();
  EXPECT_TRUE(shadow(user.look("quick frames")));
  EXPECT_TRUE(moveSlowly(user));
  user.at({330, 400});
  EXPECT_EQ(user.rest()["spares"], true) << "else this shows nothing";
  EXPECT_TRUE(shadow(user.look("at rest after slow frames")));
  (void)quit(user);
}

TEST_F(LoadTest, the_view_is_drawn_with_fewer_pixels_while_frames_take_long_and_sharp_at_rest) {
  const auto program = start({scan}, gate_.environment());
  User user(display, *program, "load");
  (void)opened(*program);
  EXPECT_EQ(program->now()["sharpness"], "full");
  const std::set<std::string> seen = turnSlowly(user);
  EXPECT_TRUE(seen.contains("half"));
  EXPECT_TRUE(seen.contains("quarter"));
  EXPECT_EQ(user.rest()["sharpness"], "full");
  (void)quit(user);
}

TEST_F(LoadTest, keys_show_with_fewer_pixels_while_frames_take_long_and_sharply_at_rest) {
  const auto program = start({scan}, gate_.environment());
  User user(display, *program, "keys under load");
  (void)opened(*program);
  user.at({300, 400});
  EXPECT_EQ(user.rest("before")["sharpness"], "full");
  const Screen before = user.look("before");
  EXPECT_TRUE(pressSlowly(user).contains("half"));
  EXPECT_EQ(user.rest("after the keys")["sharpness"], "full");
  (void)user.same("as before", before);
  quit(user);
}

TEST_F(LoadTest, drawing_that_does_not_adapt_stays_half_as_sharp) {
  const auto program = start({scan, "--steady"}, gate_.environment());
  User user(display, *program, "steady");
  (void)opened(*program);
  const std::set<std::string> seen = turnSlowly(user);
  EXPECT_TRUE(seen.contains("half"));
  EXPECT_FALSE(seen.contains("quarter"));
  (void)quit(user);
}

}  // namespace
}  // namespace fettle::tests
