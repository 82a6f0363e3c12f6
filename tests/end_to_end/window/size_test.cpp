// Sizes of the window, of its text, and no size at all.
#include <csignal>

#include <fmt/format.h>

#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = Hand::State;

class SizeTest : public WindowTest {
 protected:
  SizeTest() : WindowTest(1400, 1000) {}

  void resize(std::uint32_t window, int width, int height) const {
    display.hands({"windowsize", std::to_string(window), std::to_string(width), std::to_string(height)});
  }
  static State sized(ViewProgram& program, int width, int height) {
    return program.until(fmt::format("{} x {}", width, height), [&](const State& s) {
      return s["frame"] == State{width, height} && s["settled"] == true;
    });
  }
};

TEST_F(SizeTest, a_window_changes_its_size_at_any_time) {
  const auto program = start({scan, "--size", "1100x800"});
  Hand hand(display, *program, "size");
  (void)opened(*program);
  (void)hand.key("7");
  const std::uint32_t window = other.windowOf("fettle");
  const Screen before = hand.look("as opened");
  for (const auto& [width, height] :
       {std::pair{1400, 1000}, {640, 480}, {480, 320}, {200, 120}, {1, 1}, {1400, 200}}) {
    resize(window, width, height);
    (void)sized(*program, width, height);
    (void)hand.look(fmt::format("{}x{}", width, height));
  }
  resize(window, 1100, 800);
  (void)sized(*program, 1100, 800);
  (void)hand.same("the first size again", before);

  // Minimised: nothing is drawn; afterwards everything is there.
  other.minimise(window);
  program->until("minimised", [](const State& s) { return s["minimised"] == true; });
  other.restore(window);
  program->until("restored", [](const State& s) { return s["minimised"] == false && s["settled"] == true; });
  (void)hand.same("restored", before);

  // A storm of sizes while a stroke runs.
  (void)hand.key("m");
  hand.at({240, 360});
  hand.down(1);
  for (int i = 0; i < 40; ++i) {
    resize(window, 700 + 10 * (i % 7), 600 + 10 * (i % 5));
    display.hands({"mousemove", std::to_string(240 + 2 * i), "360"});
  }
  resize(window, 1100, 800);
  (void)program->until("the size after the storm", [](const State& s) {
    return s["frame"] == State{1100, 800};
  });
  hand.at({330, 360});
  hand.up(1);
  EXPECT_EQ(hand.rest()["steps"], 1);
  (void)hand.key("Escape");
  hand.at({20, 790});
  (void)hand.changed("marked in a storm", before);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0);
  expectSilence(*program);
}

TEST_F(SizeTest, text_and_panels_grow_with_the_display) {
  for (const auto& [dpi, scale] : {std::pair{96, 1.0}, {120, 1.25}, {144, 1.5}, {192, 2.0}}) {
    other.setResources(fmt::format("Xft.dpi:\t{}\n", dpi));
    const auto program = start({scan, "--size", fmt::format("{}x{}", int(1300 / scale), int(960 / scale))});
    Hand hand(display, *program, fmt::format("dpi{}", dpi));
    const State shown = opened(*program);
    EXPECT_NEAR(shown["scale"].get<double>(), scale, 0.01);
    const Screen seen = hand.look("opened");
    (void)seen;
    for (const State& text : shown["texts"]) EXPECT_EQ(text["cut"], false) << dpi << " dpi: " << text.dump();
    program->signal(SIGTERM);
    EXPECT_EQ(program->wait(), 0);
    expectSilence(*program);
  }
}

}  // namespace
}  // namespace fettle::tests
