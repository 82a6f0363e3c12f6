// A scripted headset (tests/xr_runtime) and what goes wrong beside it: a runtime that does not answer, a graphics device that is
// lost, a dialog that comes, a window that is minimised, an end at any time.
#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/end_to_end/window/frame_gate.h"
#include "tests/end_to_end/window/xr_room.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

class XrTrouble : public XrRoomTest {
 protected:
  XrTrouble() : XrRoomTest(Frames::kThroughVulkan) {}

  static constexpr const char* kStands = "the headset makes no frames";

  // The program with the layer that takes the window's device away, and what it is to do.
  std::unique_ptr<ViewProgram> startWithLosses() const {
    return startIn({}, {{"VK_ADD_LAYER_PATH", FETTLE_LAYER_FOLDER},
                        {"VK_INSTANCE_LAYERS", "VK_LAYER_FETTLE_lose_device"},
                        {"FETTLE_LOSE_DEVICE", orders_path}});
  }
  void order(const std::string& lines) const {
    std::ofstream(orders_path + ".all") << lines;
    std::filesystem::rename(orders_path + ".all", orders_path);
  }
  // The window has no device from here on, until giveBack().
  void takeAway() const {
    order("lose present\ngone\n");
    for (int tries = 0; bytesOf(orders_path) != "gone\n" && tries < 2000; ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_EQ(bytesOf(orders_path), "gone\n");
  }
  void giveBack(ViewProgram& program) const {
    order("");
    (void)program.until("the device works again", [](const State& s) { return s["device_losses"] > 0; });
  }
  static State press(ViewProgram& program, const XrStage& stage) {
    const int before = program.now()["buttons"];
    stage.act(set("right trigger", 1));
    return program.until("a press", [&](const State& s) { return s["buttons"] == before + 1; });
  }

  std::string orders_path = folder.file("orders.txt");
};

TEST_F(XrTrouble, a_runtime_that_does_not_answer_lets_go_and_leaves_the_window_to_the_mouse) {
  const auto program = startIn();
  User user(display, *program, "xr no answer");
  pointAt(*program, middleOf(*program, "Smooth"));
  const int held = press(*program, stage)["buttons"];
  stage.act("+1 hang\n");
  (void)program->until("it stands and lets go",
                       [&](const State& s) { return s["headset"] == "stands" && s["buttons"] == held + 1; });
  EXPECT_TRUE(user.reads(kStands));
  (void)user.look("while it stands");
  EXPECT_EQ(user.click("Smooth")["tool"], "smooth");
  const int buttons = user.stroke({330, 400}, {380, 400}, 3)["buttons"];
  EXPECT_EQ(program->now()["steps"], 1);
  EXPECT_EQ(program->now()["headset"], "stands");
  stage.act("answer\n");
  (void)program->until("it goes on", [](const State& s) { return s["headset"] == "shown"; });
  EXPECT_FALSE(user.reads(kStands));
  // The trigger was held meanwhile: that is no second press.
  (void)keep(10);
  (void)user.rest();
  EXPECT_EQ(program->now()["buttons"], buttons);
  stage.act(set("right trigger", 0) + set("right trigger", 1, 4));
  (void)program->until("a new press", [&](const State& s) { return s["buttons"] == buttons + 1; });
  (void)quitWithoutSaving(user);
  stage.expectSilence();
}

TEST_F(XrTrouble, a_stroke_of_a_controller_ends_where_its_runtime_does_not_answer) {
  const auto program = startIn();
  User user(display, *program, "xr stroke without an answer");
  (void)user.key("s");
  stage.act(over("right", 0.0, 0.95) + set("right trigger", 1, 2) + over("right", 0.0, 0.755, kTableZ_m, 20));
  (void)program->until("contact", [](const State& s) { return s["touching"] == true; });
  stage.act("+1 hang\n");
  (void)program->until("the stroke is a step", [](const State& s) {
    return s["steps"] == 1 && s["touching"] == false && s["headset"] == "stands";
  });
  stage.act("answer\n");
  (void)program->until("it goes on", [](const State& s) { return s["headset"] == "shown"; });
  (void)keep(10);
  EXPECT_EQ(program->now()["steps"], 1);
  (void)quitWithoutSaving(user);
  stage.expectSilence();
}

TEST_F(XrTrouble, hands_that_hold_the_field_let_go_of_it_where_frames_stay_away) {
  const auto program = startIn();
  User user(display, *program, "xr held without an answer");
  stage.act(over("left", -0.1, 0.95) + over("right", 0.1, 0.95) + set("left squeeze", 1, 3) +
            set("right squeeze", 1, 3) + over("left", -0.1, 0.95, kTableZ_m, 5) +
            over("right", 0.1, 0.95, kTableZ_m, 5) + over("left", -0.15, 0.95, kTableZ_m, 15) +
            over("right", 0.15, 0.95, kTableZ_m, 15));
  const double giant = program->now()["room"]["mm"];
  const State held = program->until("larger by a half", [&](const State& s) {
    return std::abs(s["room"]["mm"].get<double>() / giant - 1.5) < 0.01;
  });
  stage.act("+1 hang\n");
  (void)program->until("it stands", [](const State& s) { return s["headset"] == "stands"; });
  // Elsewhere when the frames come again: nothing jumps there.
  stage.act(over("left", -0.3, 0.95) + over("right", 0.3, 0.95) + "answer\n");
  (void)program->until("it goes on", [](const State& s) { return s["headset"] == "shown"; });
  (void)keep(10);
  EXPECT_EQ(program->now()["room"]["mm"], held["room"]["mm"]);
  (void)quit(user);
  stage.expectSilence();
}

TEST_F(XrTrouble, a_runtime_that_never_answers_does_not_keep_the_program) {
  const auto program = startIn();
  User user(display, *program, "xr never answers");
  (void)user.key("s");
  (void)user.stroke({330, 400}, {380, 400}, 3);
  const std::string session = folder.file("kept.fettle");
  saveAs(user, session);
  stage.act("+1 hang\n");
  (void)program->until("it stands", [](const State& s) { return s["headset"] == "stands"; });
  const State report = quit(user);
  EXPECT_NE(report["warnings"].dump().find("did not answer"), std::string::npos) << report["warnings"];
  EXPECT_EQ(report["steps"], 1);
  EXPECT_EQ(stage.count("instance destroyed"), 0) << "it is left as it is";
  EXPECT_GT(compare(load(session), load(scan)).changed, 0);
  stage.expectSilence();
}

TEST_F(XrTrouble, a_hand_lets_go_of_a_panel_while_the_windows_device_is_renewed) {
  const auto program = startWithLosses();
  User user(display, *program, "xr let go in a loss");
  pointAt(*program, middleOf(*program, "Smooth"));
  const int held = press(*program, stage)["buttons"];
  takeAway();
  stage.act(set("right trigger", 0));
  (void)keep();
  giveBack(*program);
  (void)program->until("let go",
                       [&](const State& s) { return s["buttons"] == held + 1 && s["settled"] == true; });
  EXPECT_EQ(user.click("Mark")["tool"], "mark") << "the mouse has the window";
  EXPECT_EQ(program->now()["headset"], "shown");
  (void)quit(user);
  stage.expectSilence();
}

TEST_F(XrTrouble, a_headset_lost_while_the_windows_device_is_renewed_lets_go) {
  const auto program = startWithLosses();
  User user(display, *program, "xr two losses");
  pointAt(*program, middleOf(*program, "Smooth"));
  const int held = press(*program, stage)["buttons"];
  takeAway();
  stage.act("+1 lose\n");
  for (int tries = 0; stage.count("instance destroyed") == 0 && tries < 2000; ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  giveBack(*program);
  (void)program->until("over, and let go", [&](const State& s) {
    return s["headset"] == "over" && s["buttons"] == held + 1 && s["settled"] == true;
  });
  EXPECT_TRUE(user.reads("the headset was unplugged"));
  EXPECT_EQ(user.click("Mark")["tool"], "mark");
  EXPECT_EQ(user.stroke({330, 400}, {380, 400}, 3)["steps"], 1);
  (void)quitWithoutSaving(user);
  stage.expectSilence();
  stage.expectLeftInOrder(XrStage::Session::kLost);
}

TEST_F(XrTrouble, a_stroke_of_a_controller_goes_on_while_the_windows_device_is_renewed) {
  const auto program = startWithLosses();
  User user(display, *program, "xr stroke in a loss");
  (void)user.key("s");
  stage.act(over("right", 0.0, 0.95) + set("right trigger", 1, 2) + over("right", 0.0, 0.755, kTableZ_m, 20));
  (void)program->until("contact", [](const State& s) { return s["touching"] == true; });
  takeAway();
  stage.act(over("right", 0.12, 0.755, kTableZ_m, 12) + set("right trigger", 0, 14));
  (void)keep(16);
  giveBack(*program);
  (void)program->until("a step", [](const State& s) { return s["steps"] == 1 && s["settled"] == true; });
  const std::string session = folder.file("through.fettle");
  saveAs(user, session);
  (void)quit(user);
  stage.expectSilence();
  const Differences d = compare(load(session), load(scan));
  EXPECT_GT(d.last_column - d.first_column, 20) << "all of it";
}

TEST_F(XrTrouble, presses_that_wait_while_a_dialog_opens_do_nothing_in_it) {
  FrameGate gate(folder.file("gate"));
  const auto program = startIn({}, gate.environment());
  User user(display, *program, "xr presses before a dialog");
  (void)user.key("F1");
  const User::Place closes = middleOf(*program, "Close (Esc)");
  (void)user.key("Escape");
  pointAt(*program, closes);
  const int before = program->now()["buttons"];
  ASSERT_TRUE(gate.hold());
  // Two clicks and the key, all of them in the frame after the one that waits.
  display.hands({"key", "F1"});
  stage.act(set("right trigger", 1) + set("right trigger", 0, 3) + set("right trigger", 1, 5) +
            set("right trigger", 0, 7));
  (void)keep(10);
  gate.release();
  (void)program->until(
      "the dialog", [&](const State& s) { return s["dialog"] == "shortcuts" && s["buttons"] == before + 4; });
  (void)user.rest();
  EXPECT_EQ(program->now()["dialog"], "shortcuts") << "pressed before it could be seen";
  // Pressed now, it closes.
  stage.act(set("right trigger", 1) + set("right trigger", 0, 3));
  (void)program->until("closed", [](const State& s) { return s["dialog"] == "none"; });
  (void)quit(user);
  stage.expectSilence();
}

TEST_F(XrTrouble, all_goes_on_in_the_room_while_the_window_is_minimised) {
  const auto program = startIn();
  User user(display, *program, "xr minimised");
  (void)user.key("s");
  const User::Place mark = middleOf(*program, "Mark");
  const std::uint32_t window = other.windowOf("fettle");
  other.minimise(window);
  (void)program->until("minimised", [](const State& s) { return s["minimised"] == true; });
  stage.act(over("right", 0.0, 0.95) + set("right trigger", 1, 2) + over("right", 0.0, 0.755, kTableZ_m, 20) +
            over("right", 0.1, 0.755, kTableZ_m, 32) + set("right trigger", 0, 34));
  (void)program->until("a step", [](const State& s) { return s["steps"] == 1; });
  // Its frame goes on as well, and is worked on.
  pointAt(*program, mark);
  const int before = keep();
  stage.act(set("right trigger", 1) + set("right trigger", 0, 4));
  (void)program->until("the tool",
                       [](const State& s) { return s["tool"] == "mark" && s["settled"] == true; });
  const int after = keep(10);
  EXPECT_GT(pixelsApart(seen(before, "quad0"), seen(after, "quad0")), 100);
  EXPECT_TRUE(program->now()["minimised"]);
  other.restore(window);
  (void)program->until("restored",
                       [](const State& s) { return s["minimised"] == false && s["settled"] == true; });
  (void)user.look("restored");
  EXPECT_EQ(user.click("Smooth")["tool"], "smooth");
  (void)quitWithoutSaving(user);
  stage.expectSilence();
}

TEST_F(XrTrouble, ended_in_a_stroke_it_keeps_the_work_and_leaves_the_runtime_in_order) {
  const auto program = startIn();
  User user(display, *program, "xr ended");
  (void)user.key("s");
  stage.act(over("right", 0.0, 0.95) + set("right trigger", 1, 2) + over("right", 0.0, 0.755, kTableZ_m, 20));
  (void)program->until("contact", [](const State& s) { return s["touching"] == true; });
  (void)keep();
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(), 0) << program->err();
  expectSilence(*program);
  EXPECT_NE(program->report()["warnings"].dump().find("unsaved work is stored"), std::string::npos)
      << program->report()["warnings"];
  EXPECT_NE(lastWord("right").find("stopped"), std::string::npos) << lastWord("right");
  stage.expectSilence();
  stage.expectLeftInOrder(XrStage::Session::kEnded);
}

}  // namespace
}  // namespace fettle::tests
