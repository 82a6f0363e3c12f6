// Force in the window: a device armed and disarmed by keys and by mouse, the panel that shows it, its rate,
// and the effects of the scene.
#include <cmath>
#include <csignal>
#include <fstream>

#include "render/plan/panel_colours.h"
#include "tests/end_to_end/window/window_fixture.h"

namespace fettle::tests {
namespace {

using State = User::State;

constexpr double kPi = 3.14159265358979;

bool givesForce(const State& s) {
  return s["safety"] == "active" && s["touching"] == true;
}

class HapticsTest : public WindowTest {
 protected:
  // High enough for what the panel Haptics shows of the loop.
  HapticsTest() : WindowTest(1100, 1000) {}
  // A simulated hand that lands on the plate (8 mm) and lifts again, every two seconds: who is armed late
  // feels nothing until it has come out.
  std::unique_ptr<ViewProgram> startHand() {
    const std::string strokes = folder.file("strokes.csv");
    std::ofstream out(strokes);
    out << "t,x,y,z,tool\n";
    for (int i = 0; i < 12000; ++i) {
      const double t = 0.01 * i;
      out << t << ',' << 60.0 + 10.0 * std::sin(2.0 * t) << ",51," << 9.0 + 1.4 * std::cos(kPi * t)
          << ",feel\n";
    }
    out.close();
    auto program = start({scan, "--device", "hand:" + strokes});
    program->until("the hand",
                   [](const State& s) { return s.value("device", "") != "" && s["connected"] == true; });
    return program;
  }
  // Through two landings of the hand there is no force, and nothing arms.
  static void staysWithoutForce(ViewProgram& program) {
    program.until("no force", [](const State& s) { return s["safety"] == "uncalibrated"; });
    int landings = 0;
    bool touched = true;
    std::string otherwise;
    program.until("two landings", [&](const State& s) {
      if (s["safety"] != "uncalibrated") otherwise = s["safety"];
      const bool touches = s["touching"];
      landings += touches && !touched;
      touched = touches;
      return landings == 2;
    });
    EXPECT_EQ(otherwise, "");
  }
  // Pixels of a colour in the panels, once there are more than `least`; the hand moves all the time, so that nothing rests.
  int inPanels(User& user, const std::string& what, render::PanelColour colour, int least) {
    const std::uint32_t code = render::panelColour(colour, render::Theme::kDark);
    const int red = code & 0xFFU, green = code >> 8U & 0xFFU, blue = code >> 16U & 0xFFU;
    const State now = user.program().now();
    const int left = now["picture"][0].get<int>() + now["picture"][2].get<int>();
    const auto count = [&](const Screen& seen) {
      int found = 0;
      for (int y = 0; y < seen.height; ++y)
        for (int x = left; x < seen.width; ++x) {
          const std::uint8_t* p = seen.at(x, y);
          found += std::abs(p[0] - red) < 12 && std::abs(p[1] - green) < 12 && std::abs(p[2] - blue) < 12;
        }
      return found;
    };
    int found = 0;
    user.program().until(what, [&](const State&) { return (found = count(display.screen())) > least; });
    (void)user.glance(what);
    return found;
  }
};

TEST_F(HapticsTest, disarming_by_key_lasts_until_armed_and_no_dialog_stands_in_its_way) {
  const auto program = startHand();
  User user(display, *program, "keys");
  program->until("force", givesForce);
  (void)user.press("shift+a");
  staysWithoutForce(*program);
  (void)user.press("a");
  program->until("force again", givesForce);
  // A list of keys is open, whose search has the keyboard.
  (void)user.press("F1");
  program->until("a dialog",
                 [](const State& s) { return s["dialog"] == "shortcuts" && s["text_field"] == true; });
  (void)user.press("Pause");
  program->until("no force", [](const State& s) { return s["safety"] == "uncalibrated"; });
  (void)user.press("Escape");
  program->until("no dialog", [](const State& s) { return s["dialog"] == "none"; });
  (void)user.press("a");
  program->until("force again", givesForce);
  // A path is being typed: a capital A belongs to it, Pause does not.
  (void)user.press("ctrl+o");
  program->until("a dialog", [](const State& s) { return s["dialog"] == "open" && s["text_field"] == true; });
  (void)user.press("shift+a");
  EXPECT_EQ(program->until("force while typing", givesForce)["dialog"], "open");
  (void)user.press("Pause");
  staysWithoutForce(*program);
  EXPECT_EQ(program->now()["dialog"], "open");
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

TEST_F(HapticsTest, the_panel_shows_the_device_arms_it_and_sets_its_rate) {
  const auto program = startHand();
  User user(display, *program, "panel");
  program->until("force", givesForce);
  for (const char* header : {"Tool", "Filters", "Steps", "Change since the scan"}) (void)user.click(header);
  (void)user.click("Haptics");
  for (const char* text : {"simulated hand", "connected", "force, 0 to", "per second", "0.5 ms"})
    EXPECT_TRUE(user.reads(text)) << text;
  // The force as a line, late ticks as bars.
  EXPECT_GT(inPanels(user, "force", render::PanelColour::kCurve, 60), 60);
  EXPECT_GT(inPanels(user, "lateness", render::PanelColour::kProgress, 60), 60);

  user.tap("Disarm");
  staysWithoutForce(*program);
  EXPECT_TRUE(user.reads("uncalibrated"));
  // Who disarmed stays disarmed at another rate.
  user.tap("1 kHz");
  program->until("rates",
                 [](const State& s) { return s["texts"].dump().find("\"3 kHz\"") != std::string::npos; });
  user.tap("3 kHz");
  program->until("another rate",
                 [](const State& s) { return s["rate_hz"] == 3000 && s["connected"] == true; });
  staysWithoutForce(*program);
  user.tap("Arm");
  program->until("force", givesForce);
  EXPECT_TRUE(user.reads("of 3000 per second"));
  // And who is armed is so again: the loop begins without force.
  user.tap("3 kHz");
  program->until("rates",
                 [](const State& s) { return s["texts"].dump().find("\"1 kHz\"") != std::string::npos; });
  user.tap("1 kHz");
  program->until("the first rate",
                 [](const State& s) { return s["rate_hz"] == 1000 && s["safety"] != "active"; });
  program->until("force", givesForce);
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

TEST_F(HapticsTest, a_stiffness_typed_that_the_hand_does_not_hold_is_refused_in_words) {
  const auto program = startHand();
  User user(display, *program, "stiffness");
  program->until("force", givesForce);
  for (const char* header : {"Tool", "Filters", "Steps", "Change since the scan"}) (void)user.click(header);
  (void)user.click("Haptics");
  EXPECT_EQ(program->now()["stiffness_n_per_mm"], 1.0);
  EXPECT_TRUE(user.readsScrolled("6 N/mm at most")) << "next to the field";
  const State refused = user.enter("stiffness", "99999");
  EXPECT_EQ(refused["stiffness_n_per_mm"], 1.0) << "what was there stays";
  ASSERT_EQ(refused["notices"].size(), 1U) << refused["notices"];
  const std::string said = refused["notices"][0];
  EXPECT_NE(said.find("more than the simulated hand holds at 1000 Hz"), std::string::npos) << said;
  EXPECT_NE(said.find("99999 N/mm"), std::string::npos) << said;
  EXPECT_TRUE(user.reads("simulated hand holds at 1000 Hz: at most")) << program->now()["texts"].dump();
  user.tap("Understood");
  program->until("the panels without it", [](const State& s) {
    return s["notices"].empty() && s["texts"].dump().find("Understood") == std::string::npos;
  });
  const State taken = user.enter("stiffness", "6");
  EXPECT_EQ(taken["stiffness_n_per_mm"], 6.0);
  EXPECT_EQ(taken["notices"], State::array());
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

// A force device that need not be plugged in, with a scene of the user that is stable on it in a corner of the scan only.
TEST_F(HapticsTest, a_scene_that_reaches_a_corner_is_said_to_and_fitted_by_the_button_beside_it) {
  const std::string scene = folder.file("stiff.toml");
  std::ofstream(scene) << "[force]\nstiffness_n_per_mm = 20\n[brush]\nradius_samples = 4\n";
  const auto program = start({scan, "--device", "woodenhaptics", "--scene", scene});
  const State before = program->until(
      "the scan", [](const State& s) { return s.value("device", "") != "" && s["settled"] == true; });
  EXPECT_EQ(before["stiffness_n_per_mm"], 20.0);
  EXPECT_NE(before["notices"].dump().find("the hand reaches 10 of"), std::string::npos) << before["notices"];
  User user(display, *program, "fit");
  for (const char* header : {"Tool", "Filters", "Steps", "Change since the scan"}) (void)user.click(header);
  (void)user.click("Haptics");
  (void)user.click("Fit to the scan");
  const State fitted = program->until(
      "the fit", [](const State& s) { return s["stiffness_n_per_mm"] != 20.0 && s["settled"] == true; });
  EXPECT_LT(fitted["stiffness_n_per_mm"], 1.5);
  EXPECT_NE(fitted["status"].get<std::string>().find("the scene is fitted to the scan"), std::string::npos);
  program->until("no more to say", [](const State& s) {
    return s["texts"].dump().find("Fit to the scan") == std::string::npos;
  });
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

TEST_F(HapticsTest, effects_are_ticked_off_and_on_again) {
  const auto program = start({scan});
  User user(display, *program, "effects");
  const State opened_with = opened(*program);
  const auto has = [](const State& s, const char* effect) {
    for (const State& e : s["effects"])
      if (e == effect) return true;
    return false;
  };
  ASSERT_TRUE(has(opened_with, "smoothing"));
  ASSERT_FALSE(has(opened_with, "friction"));
  (void)user.key("7");
  for (const char* header : {"Tool", "Filters", "Steps", "Change since the scan"}) (void)user.click(header);
  (void)user.click("Haptics");
  EXPECT_TRUE(has(user.click("friction"), "friction"));
  EXPECT_TRUE(has(user.click("edge snap"), "edge_snap"));
  EXPECT_FALSE(has(user.click("friction"), "friction"));
  // Without its effect the tool does nothing; ticked again it does.
  EXPECT_FALSE(has(user.click("smoothing"), "smoothing"));
  (void)user.key("s");
  EXPECT_EQ(user.stroke({240, 332}, {340, 332}, 3)["steps"], 0);
  EXPECT_TRUE(has(user.click("smoothing"), "smoothing"));
  EXPECT_EQ(user.stroke({240, 332}, {340, 332}, 3)["steps"], 1);
  EXPECT_EQ(program->now()["notices"], State::array());
  (void)user.look("smoothed");
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
}

}  // namespace
}  // namespace fettle::tests
