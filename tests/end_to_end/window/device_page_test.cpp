// The page of the device, by keys: reach, rest, directions, motion and clutch, through the driver and a replacement of the maker's library.
#include <csignal>
#include <fstream>
#include <iterator>

#include <nlohmann/json.hpp>

#include "tests/end_to_end/window/window_fixture.h"
#include "tests/haptic/devices/fake_vendor/shared_page.h"

namespace fettle::tests {
namespace {

using State = User::State;

class DevicePage : public WindowTest {
 protected:
  std::unique_ptr<ViewProgram> startOmega() {
    const std::string page = folder.file("page");
    page_ = fake::SharedPage::map(page.c_str());
    page_->wrist = true;
    auto program = start({scan, "--device", "forcedimension"}, {{"FETTLE_LIBDHD", FETTLE_FAKE_DHD},
                                                                {"FAKE_VENDOR_PAGE", page},
                                                                {"FAKE_VENDOR_LOG", folder.file("broken")}});
    program->until("the device",
                   [](const State& s) { return s.contains("device") && s["connected"] == true; });
    return program;
  }
  // The hand moves there; returns when the page has seen it.
  State handTo(ViewProgram& program, double right_mm, double away_mm, double up_mm) {
    page_->right_mm = right_mm;
    page_->away_mm = away_mm;
    page_->up_mm = up_mm;
    return program.until("the hand", [&](const State& s) {
      return std::abs(s["device_mm"][0].get<double>() - right_mm) < 1e-3 &&
             std::abs(s["device_mm"][1].get<double>() - away_mm) < 1e-3 &&
             std::abs(s["device_mm"][2].get<double>() - up_mm) < 1e-3;
    });
  }
  State push(User& user, const std::string& key, double right_mm, double away_mm, double up_mm,
             const char* way) {
    ViewProgram& program = user.program();
    (void)handTo(program, 0.0, 0.0, 30.0);
    (void)user.press(key);
    program.until("asked", [](const State& s) { return s["device_check"]["running"] == true; });
    (void)handTo(program, right_mm, away_mm, 30.0 + up_mm);
    return program.until(way, [&](const State& s) { return s["device_check"].contains(way); });
  }
  void endWithoutABrokenRule(ViewProgram& program) {
    program.signal(SIGTERM);
    EXPECT_EQ(program.wait(), 0) << program.err();
    expectSilence(program);
    std::ifstream log(folder.file("broken"));
    EXPECT_TRUE(log.is_open());
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(log), {}), "");
  }

  fake::SharedPage* page_ = nullptr;
};

TEST_F(DevicePage, measures_a_device_by_keys_and_uses_it_so_again_when_it_is_opened_again) {
  {
    const auto program = startOmega();
    (void)opened(*program);
    User user(display, *program, "device page");
    (void)user.press("a");
    program->until("an armed device",
                   [](const State& s) { return s["safety"] == "active" || s["safety"] == "ramping"; });
    (void)user.press("ctrl+shift+d");
    program->until("the page, without force",
                   [](const State& s) { return s["dialog"] == "device" && s["safety"] == "uncalibrated"; });

    (void)user.press("r");
    program->until("a reach", [](const State& s) { return s["device_check"].contains("reach_mm"); });
    for (const double side : {-1.0, 1.0}) {
      const double box[3] = {side < 0 ? -40.0 : 60.0, side < 0 ? -50.0 : 55.0, side < 0 ? -30.0 : 45.0};
      (void)handTo(*program, box[0], box[1], box[2]);
      program->until("the reach", [&](const State& s) {
        const auto& reach = s["device_check"]["reach_mm"][side < 0 ? 0 : 1];
        return reach == State({box[0], box[1], box[2]});
      });
    }
    (void)user.look("reach");
    (void)user.press("r");
    program->until("its end", [](const State& s) { return s["device_check"]["running"] == false; });

    EXPECT_EQ(push(user, "1", 30.0, 2.0, -3.0, "right")["device_check"]["right"], "+x");
    EXPECT_EQ(push(user, "2", 0.0, 25.0, 0.0, "away")["device_check"]["away"], "+y");
    // Down where up is asked for is reported.
    EXPECT_EQ(push(user, "3", 0.0, 0.0, -25.0, "up")["device_check"]["up"], "-z");

    (void)user.press("t");
    const State rested =
        program->until("the rest", [](const State& s) { return s["device_check"].contains("rest"); });
    EXPECT_EQ(rested["device_check"]["rest"], State({0.0, 0.0, 0}));

    (void)user.press("minus");
    (void)user.press("minus");
    for (int i = 0; i < 3; ++i) (void)user.press("c");
    (void)user.look("all measured");
    (void)user.press("Return");
    const State saved = program->until("it is used", [](const State& s) {
      return s["dialog"] == "none" && s["device_check"]["reach_used"] == true && s["connected"] == true;
    });
    EXPECT_NEAR(saved["device_check"]["motion"].get<double>(), 0.8, 1e-9);
    EXPECT_EQ(saved["device_check"]["clutch_buttons"], 0);
    EXPECT_NE(saved["safety"], "active");
    endWithoutABrokenRule(*program);
  }
  std::ifstream file(folder.file("fettle/window.json"));
  const nlohmann::json settings = nlohmann::json::parse(file);
  const nlohmann::json& kept = settings.at("devices").at("omega.3, 10406");
  EXPECT_EQ(kept["low_mm"], nlohmann::json({-40.0, -50.0, -30.0}));
  EXPECT_EQ(kept["high_mm"], nlohmann::json({60.0, 55.0, 45.0}));

  page_->right_mm = 10.0;  // the middle of what was reached, and so of the scan
  page_->away_mm = 2.5;
  const auto again = startOmega();
  (void)opened(*again);
  const State now = again->until("the hand in the middle", [](const State& s) {
    return std::abs(s["device_mm"][0].get<double>() - 10.0) < 1e-3 && s["stylus_at"][0] == 159;
  });
  EXPECT_EQ(now["stylus_at"], State({159, 159}));
  EXPECT_NEAR(now["device_check"]["motion"].get<double>(), 0.8, 1e-9);
  EXPECT_EQ(now["device_check"]["clutch_buttons"], 0);
  EXPECT_EQ(now["device_check"]["reach_used"], true);
  // A page that is left changes nothing.
  User user(display, *again, "device page again");
  (void)user.press("ctrl+shift+d");
  again->until("the page", [](const State& s) { return s["dialog"] == "device"; });
  (void)user.press("m");
  (void)user.press("Escape");
  const State left = again->until("no page", [](const State& s) { return s["dialog"] == "none"; });
  EXPECT_EQ(left["device_check"]["reach_used"], true);
  endWithoutABrokenRule(*again);
}

TEST_F(DevicePage, the_stylus_in_the_picture_is_held_as_the_hand_holds_it) {
  const auto program = startOmega();
  (void)opened(*program);
  page_->up_mm = 5.0;
  constexpr double kTurned = 0.02;  // the workspace follows the view to half a degree
  const auto axis = [&](double right, double away) {
    return program->until("the axis", [&](const State& s) {
      return s.contains("stylus_axis") && std::abs(s["stylus_axis"][0].get<double>() - right) < kTurned &&
             std::abs(s["stylus_axis"][1].get<double>() - away) < kTurned;
    });
  };
  User user(display, *program, "stylus");
  // The view says which way is away (StylusState): turned to front, desk and field agree.
  (void)user.key("1");
  (void)axis(0.0, -1.0);
  const Screen towards = user.look("towards the person");
  page_->turn_rad = 0.5 * 3.14159265358979;
  (void)axis(1.0, 0.0);
  (void)user.changed("to the right", towards);
  endWithoutABrokenRule(*program);
}

// Its panel is folded: what is said of it is said where one looks, whatever of the window is seen.
TEST_F(DevicePage, an_unplugged_device_is_said_with_and_without_panels) {
  const auto program = startOmega();
  (void)opened(*program);
  User user(display, *program, "unplugged");
  const auto says = [](const State& s, const std::string& what) {
    return s["texts"].dump().find(what) != std::string::npos;
  };
  const auto plug = [&](bool in) {
    page_->plugged = in;
    program->until("the plug", [&](const State& s) { return s["connected"] == in; });
  };
  ASSERT_FALSE(says(program->now(), "plugged"));
  (void)user.press("F11");
  program->until("full screen",
                 [](const State& s) { return s["full_screen"] == true && s["settled"] == true; });
  plug(false);
  program->until("words without panels", [&](const State& s) {
    return says(s, "the device was unplugged") && says(s, ": not plugged in");
  });
  (void)user.look("full screen");
  plug(true);
  program->until("no word any more", [&](const State& s) { return !says(s, ": not plugged in"); });
  // Again, while that is said: nothing more.
  plug(false);
  plug(true);
  EXPECT_EQ(user.rest()["notices"].size(), 1U);
  user.tap("Understood");
  program->until("taken away",
                 [&](const State& s) { return s["notices"].empty() && !says(s, "Understood"); });
  (void)user.press("F11");
  program->until("panels", [](const State& s) { return s["full_screen"] == false && s["settled"] == true; });
  (void)user.press("Tab");
  program->until("no panels", [](const State& s) { return s["picture"][2] == s["frame"][0]; });
  // Armed, it is a fault.
  (void)user.press("a");
  program->until("an armed device",
                 [](const State& s) { return s["safety"] == "active" || s["safety"] == "ramping"; });
  plug(false);
  const State fault = program->until("the fault", [&](const State& s) { return says(s, "fault, "); });
  EXPECT_EQ(fault["notices"].size(), 1U) << fault["notices"];
  (void)user.look("no panels");
  (void)user.press("Tab");
  program->until("the same under the panels",
                 [&](const State& s) { return s["picture"][2] < s["frame"][0] && says(s, "fault, "); });
  endWithoutABrokenRule(*program);
}

// The mouse, a device of a maker, and the mouse again, in one start of the program.
TEST_F(DevicePage, another_device_is_chosen_in_the_panel_and_gives_no_force_until_it_is_armed) {
  const std::string page = folder.file("page");
  page_ = fake::SharedPage::map(page.c_str());
  const auto program = start({scan}, {{"FETTLE_LIBDHD", FETTLE_FAKE_DHD},
                                      {"FAKE_VENDOR_PAGE", page},
                                      {"FAKE_VENDOR_LOG", folder.file("broken")}});
  const std::string mouse = opened(*program)["device"];
  User user(display, *program, "devices");
  for (const char* header : {"Tool", "Filters", "Steps", "Change since the scan"}) (void)user.click(header);
  (void)user.click("Haptics");
  const auto choose = [&](const std::string& now, const std::string& wanted) {
    (void)user.click(now);
    std::string title;
    program->until("devices", [&](const State& s) {
      for (const State& text : s["texts"])
        if (text["text"].get<std::string>().find(wanted) == 0) title = text["text"];
      return !title.empty() && s["settled"] == true;
    });
    (void)user.look("list");
    user.tap(title);
  };
  choose(mouse + ", no force", "omega");
  const State omega = program->until("the other device", [&](const State& s) {
    return s["device"] != mouse && s["connected"] == true && s["settled"] == true;
  });
  EXPECT_EQ(omega["safety"], "uncalibrated") << "nobody has armed it";
  EXPECT_NE(omega["status"].get<std::string>().find("the device is the"), std::string::npos)
      << omega["status"];
  (void)user.look("another device");
  (void)user.press("a");
  program->until("armed", [](const State& s) { return s["safety"] == "active" || s["safety"] == "ramping"; });
  choose(omega["device"], "mouse as a stylus");
  program->until("the mouse", [&](const State& s) { return s["device"] == mouse && s["settled"] == true; });
  (void)user.key("7");
  (void)user.key("s");
  EXPECT_EQ(user.stroke({240, 332}, {340, 332}, 3)["steps"], 1) << "and it works as before";
  endWithoutABrokenRule(*program);
}

TEST_F(DevicePage, a_mouse_has_nothing_to_measure) {
  const auto program = start({scan});
  (void)opened(*program);
  User user(display, *program, "mouse page");
  EXPECT_EQ(user.key("ctrl+shift+d")["dialog"], "device");
  EXPECT_TRUE(user.reads("there is nothing to measure"));
  (void)user.press("Return");
  (void)user.press("Escape");
  (void)quit(user);
}

}  // namespace
}  // namespace fettle::tests
