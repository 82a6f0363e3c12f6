// Hands in a scripted headset (tests/xr_runtime): a controller as the tip, the field held by two, the window's frame pointed
// at. The runtime composes what each eye sees, so that it can be looked at.
#include <fstream>
#include <string>

#include <fmt/format.h>

#include "tests/end_to_end/window/xr_room.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

class XrHands : public XrRoomTest {};

TEST_F(XrHands, a_controller_is_the_tip_and_a_stroke_of_it_is_a_step) {
  const auto program = startIn();
  User user(display, *program, "xr tip");
  EXPECT_EQ(program->now()["device"], "mouse and controllers");
  (void)user.key("s");
  ASSERT_EQ(program->now()["tool"], "smooth");
  stage.act(over("right", 0.0, 0.95));
  const int before = keep();
  EXPECT_TRUE(program->now()["room"]["tip"].is_null()) << "a hand that pressed nothing";
  // Pressed over the field, then down on it.
  stage.act(set("right trigger", 1) + over("right", 0.0, 0.95, kTableZ_m, 2) +
            over("right", 0.0, 0.755, kTableZ_m, 30));
  tipIs(*program, "right");
  (void)program->until("contact", [](const State& s) { return s["touching"] == true; });
  const int touching = keep();
  EXPECT_GT(strongest("right", 0), 0.1) << stage.log();
  EXPECT_EQ(stage.count("haptics left"), 0);
  for (const char* eye : {"left", "right"})
    EXPECT_GT(pixelsApart(seen(before, eye), seen(touching, eye)), 150)
        << "the tip is seen by the eye at the " << eye;
  // Aside, and up.
  stage.act(over("right", 0.0, 0.755) + over("right", 0.12, 0.755, kTableZ_m, 20) +
            over("right", 0.12, 0.755, kTableZ_m, 22) + over("right", 0.12, 0.95, kTableZ_m, 30) +
            set("right trigger", 0, 32));
  const State stroked = program->until("a step", [](const State& s) { return s["steps"] == 1; });
  EXPECT_EQ(stroked["room"]["tip"], "right") << "it stays the tip";
  (void)program->until("off", [](const State& s) { return s["touching"] == false; });
  expectStops("right");
  // The window shows it as of any device.
  (void)user.look("a stroke of the controller");
  EXPECT_EQ(user.key("ctrl+z")["steps"], 0);
  EXPECT_EQ(user.key("ctrl+shift+z")["steps"], 1);
  const std::string session = folder.file("stroke.fettle");
  saveAs(user, session);
  const State report = quit(user);
  EXPECT_EQ(report["steps"], 1);
  stage.expectSilence();
  EXPECT_EQ(stage.count("session ended"), 1);
  const Differences d = compare(load(session), load(scan));
  EXPECT_GT(d.changed, 20);
  EXPECT_GT(d.last_column - d.first_column, 30) << "from the middle to the right";
  const std::string again = folder.file("again.tif");
  const Outcome replayed = runProcess({FETTLE_PROGRAM, "replay", session, again});
  ASSERT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_EQ(compare(load(again), load(session)).changed, 0);
}

TEST_F(XrHands, the_tip_is_lifted_and_its_vibration_stopped_when_the_focus_is_lost) {
  const auto program = startIn();
  User user(display, *program, "xr focus");
  (void)user.key("s");
  stage.act(over("left", 0.0, 0.95) + set("left trigger", 1, 2) + over("left", 0.0, 0.755, kTableZ_m, 20));
  tipIs(*program, "left");
  (void)program->until("contact", [](const State& s) { return s["touching"] == true; });
  (void)keep();
  EXPECT_GT(strongest("left", 0), 0.1) << stage.log();
  stage.act("+1 hide\n");
  tipIs(*program, State());
  (void)program->until("the stroke is a step", [](const State& s) { return s["steps"] == 1; });
  expectStops("left");
  const std::size_t hidden = stage.log().size();
  stage.act("+1 show\n");
  tipIs(*program, "left");
  (void)keep();
  EXPECT_GT(strongest("left", hidden), 0.1) << "it is the tip again";
  // The trigger was held meanwhile: that is no second press.
  stage.act(over("left", 0.1, 0.755, kTableZ_m, 10) + over("left", 0.1, 0.95, kTableZ_m, 20) +
            set("left trigger", 0, 22));
  (void)program->until("off", [](const State& s) { return s["touching"] == false; });
  (void)keep(24);
  EXPECT_EQ(program->now()["steps"], 1);
  (void)quitWithoutSaving(user);
  EXPECT_NE(lastWord("left").find("stopped"), std::string::npos) << "at the end: " << lastWord("left");
  stage.expectSilence();
}

TEST_F(XrHands, a_stroke_of_the_mouse_takes_the_tip_and_a_trigger_takes_it_back) {
  const auto program = startIn();
  User user(display, *program, "xr mouse");
  (void)user.key("s");
  stage.act(over("right", 0.0, 0.95) + set("right trigger", 1, 2) + set("right trigger", 0, 6));
  tipIs(*program, "right");
  // A hand that presses keeps the tip: it lets go first.
  (void)program->until("released", [](const State& s) { return s["device_buttons"] == 0; });
  (void)user.drag(1, {330, 400}, {380, 400}, 3);
  EXPECT_EQ(tipIs(*program, State())["steps"], 1);
  stage.act(set("right trigger", 1) + set("right trigger", 0, 6));
  tipIs(*program, "right");
  (void)quitWithoutSaving(user);
  stage.expectSilence();
}

TEST_F(XrHands, a_stroke_stays_with_its_hand_whatever_the_other_presses) {
  const auto program = startIn();
  User user(display, *program, "xr two triggers");
  (void)user.key("s");
  stage.act(over("right", 0.05, 0.95) + over("left", -0.15, 0.755) + set("right trigger", 1, 3) +
            over("right", 0.05, 0.755, kTableZ_m, 12));
  tipIs(*program, "right");
  (void)program->until("contact", [](const State& s) { return s["touching"] == true; });
  stage.act(set("left trigger", 1) + set("right trigger", 0, 12) + set("left trigger", 0, 18));
  const State stroked = program->until("a step", [](const State& s) { return s["steps"] == 1; });
  EXPECT_EQ(stroked["room"]["tip"], "right");
  (void)keep(20);
  EXPECT_EQ(program->now()["steps"], 1);
  EXPECT_EQ(program->now()["room"]["tip"], "right");
  const std::string session = folder.file("two.fettle");
  saveAs(user, session);
  (void)quit(user);
  stage.expectSilence();
  // All of it under the right hand: 0.2 m of 0.6 m lie between them.
  const Differences d = compare(load(session), load(scan));
  EXPECT_GT(d.changed, 0);
  EXPECT_LT(d.last_column - d.first_column, 30);
}

TEST_F(XrHands, a_trigger_held_while_a_scan_is_opened_again_draws_nothing_on_it) {
  const auto program = startIn();
  User user(display, *program, "xr another field");
  (void)user.key("s");
  stage.act(over("right", 0.0, 0.95) + set("right trigger", 1, 2));
  tipIs(*program, "right");
  (void)user.key("ctrl+1");
  // No hand leads on it: it would have to press.
  tipIs(*program, State());
  (void)user.key("s");
  stage.act(over("right", 0.0, 0.755, kTableZ_m, 10) + over("right", 0.1, 0.755, kTableZ_m, 20) +
            over("right", 0.1, 0.95, kTableZ_m, 26) + set("right trigger", 0, 28));
  (void)keep(32);
  EXPECT_EQ(program->now()["steps"], 0);
  EXPECT_TRUE(program->now()["room"]["tip"].is_null());
  stage.act(set("right trigger", 1, 2) + over("right", 0.1, 0.95, kTableZ_m, 4) +
            over("right", 0.1, 0.755, kTableZ_m, 12));
  (void)program->until("contact", [](const State& s) { return s["touching"] == true; });
  stage.act(set("right trigger", 0, 4));
  (void)program->until("a step", [](const State& s) { return s["steps"] == 1; });
  (void)quitWithoutSaving(user);
  stage.expectSilence();
}

TEST_F(XrHands, a_question_in_the_window_stops_the_tool_of_a_controller) {
  const auto program = startIn();
  User user(display, *program, "xr question");
  (void)user.key("s");
  (void)user.key("F1");
  ASSERT_EQ(program->now()["dialog"], "shortcuts");
  stage.act(over("right", 0.0, 0.95) + set("right trigger", 1, 3) + over("right", 0.0, 0.755, kTableZ_m, 12) +
            over("right", 0.1, 0.755, kTableZ_m, 24));
  (void)keep(26);
  (void)user.key("Escape");
  ASSERT_EQ(program->now()["dialog"], "none");
  stage.act(over("right", 0.1, 0.755) + over("right", 0.0, 0.755, kTableZ_m, 10) +
            set("right trigger", 0, 12));
  (void)keep(14);
  EXPECT_EQ(program->now()["steps"], 0) << "pressed while it was asked";
  stage.act(set("right trigger", 1) + over("right", 0.0, 0.755) + over("right", 0.1, 0.755, kTableZ_m, 12) +
            set("right trigger", 0, 14));
  (void)program->until("a step", [](const State& s) { return s["steps"] == 1; });
  (void)quitWithoutSaving(user);
  stage.expectSilence();
}

TEST_F(XrHands, a_headset_lost_while_a_panel_is_held_lets_go_of_it) {
  const auto program = startIn();
  User user(display, *program, "xr lost on a panel");
  pointAt(*program, middleOf(*program, "Smooth"));
  const int buttons = program->now()["buttons"];
  stage.act(set("right trigger", 1));
  (void)program->until("held", [&](const State& s) { return s["buttons"] == buttons + 1; });
  stage.act("+1 lose\n");
  (void)program->until("let go",
                       [&](const State& s) { return s["headset"] == "over" && s["buttons"] == buttons + 2; });
  (void)user.rest();
  // The mouse has the window.
  EXPECT_EQ(user.click("Smooth")["tool"], "smooth");
  EXPECT_EQ(user.stroke({330, 400}, {380, 400}, 3)["steps"], 1);
  (void)quitWithoutSaving(user);
  stage.expectSilence();
}

TEST_F(XrHands, a_headset_lost_in_a_stroke_on_the_frame_ends_the_stroke) {
  const auto program = startIn();
  User user(display, *program, "xr lost on the picture");
  EXPECT_EQ(user.click("Smooth")["tool"], "smooth");
  stage.act("+1 head 0 1.45 -0.05 0 -12\n" + at("right", 330, 400));
  (void)program->until("it points", [](const State& s) { return s["room"]["points"] == true; });
  stage.act(set("right trigger", 1) + at("right", 330, 400, 2) + at("right", 380, 400, 12));
  (void)program->until("a stroke", [](const State& s) { return s["touching"] == true; });
  stage.act("+1 lose\n");
  (void)program->until("its end", [](const State& s) { return s["headset"] == "over" && s["steps"] == 1; });
  (void)user.rest();
  EXPECT_EQ(user.click("Mark")["tool"], "mark");
  EXPECT_EQ(program->now()["steps"], 1);
  (void)quitWithoutSaving(user);
  stage.expectSilence();
}

TEST_F(XrHands, the_mouse_clicks_where_it_is_while_a_hand_points_elsewhere) {
  const auto program = startIn();
  User user(display, *program, "xr mouse beside a hand");
  stage.act("+1 head 0 1.45 -0.05 0 -12\n" + at("right", 600, 400));
  (void)program->until("it points", [](const State& s) { return s["room"]["points"] == true; });
  EXPECT_EQ(user.click("Smooth")["tool"], "smooth");
  EXPECT_EQ(program->now()["room"]["points"], true);
  EXPECT_EQ(program->now()["steps"], 0);
  (void)quit(user);
  stage.expectSilence();
}

TEST_F(XrHands, another_device_stays_the_tip) {
  const std::string strokes = folder.file("hand.csv");
  std::ofstream(strokes) << "t,x,y,z,tool\n0,5,5,100,feel\n1,5,5,100,feel\n";
  const auto program = startIn({"--device", "replay:" + strokes});
  User user(display, *program, "xr other device");
  stage.act(over("right", 0.0, 0.95) + set("right trigger", 1, 2) + over("right", 0.0, 0.755, kTableZ_m, 20));
  (void)keep(24);  // it is down by then
  EXPECT_TRUE(program->now()["room"]["tip"].is_null());
  EXPECT_EQ(stage.count("haptics"), 0) << stage.log();
  (void)quit(user);
  stage.expectSilence();
}

TEST_F(XrHands, two_hands_move_and_scale_the_field_and_a_button_gives_its_true_size) {
  const auto program = startIn();
  User user(display, *program, "xr two hands");
  const double giant = program->now()["room"]["mm"];
  EXPECT_FALSE(program->now()["room"]["true_size"]);
  stage.act(over("left", -0.1, 0.95) + over("right", 0.1, 0.95) + set("left squeeze", 1, 3) +
            set("right squeeze", 1, 3) + over("left", -0.1, 0.95, kTableZ_m, 5) +
            over("right", 0.1, 0.95, kTableZ_m, 5) + over("left", -0.2, 0.95, kTableZ_m, 25) +
            over("right", 0.2, 0.95, kTableZ_m, 25));
  (void)program->until("twice as large", [&](const State& s) {
    return std::abs(s["room"]["mm"].get<double>() / giant - 2.0) < 0.01;
  });
  const int large = keep();
  // Let go: nothing follows the hands.
  stage.act(set("left squeeze", 0) + set("right squeeze", 0) + over("left", -0.2, 0.95, kTableZ_m, 2) +
            over("left", -0.4, 0.95, kTableZ_m, 10));
  EXPECT_GT(keep(14), large);
  EXPECT_NEAR(program->now()["room"]["mm"].get<double>() / giant, 2.0, 0.01);
  EXPECT_TRUE(program->now()["room"]["tip"].is_null());
  stage.act(set("right button", 1) + set("right button", 0, 4));
  (void)program->until("true size", [](const State& s) { return s["room"]["true_size"] == true; });
  EXPECT_NEAR(program->now()["room"]["mm"].get<double>(), 1e-3, 1e-12);
  const int small = keep();
  for (const char* eye : {"left", "right"})
    EXPECT_GT(pixelsApart(seen(large, eye), seen(small, eye)), 480 * 500 / 20) << eye;
  stage.act(set("left button", 1) + set("left button", 0, 4));
  (void)program->until("a giant's", [&](const State& s) { return s["room"]["mm"] == giant; });
  (void)quit(user);
  stage.expectSilence();
}

TEST_F(XrHands, the_window_is_pointed_at_in_the_room_clicked_and_scrolled) {
  const auto program = startIn();
  User user(display, *program, "xr screen");
  // Up to the screen.
  stage.act("+1 head 0 1.45 -0.05 0 -12\n");
  const int before = keep();
  // Its own frame hangs there, as it is on the desktop.
  const User::Place button = middleOf(*program, "Smooth");
  pointAt(*program, button);
  const int pointing = keep();
  // Ray and spot are layers over the screen's, and each eye sees them.
  EXPECT_EQ(stage.count(fmt::format("frame {} projection quad\n", before)), 1) << stage.log();
  EXPECT_EQ(stage.count(fmt::format("frame {} projection quad quad quad\n", pointing)), 1) << stage.log();
  for (const char* eye : {"left", "right"}) {
    EXPECT_GT(pixelsApart(seen(before, eye), seen(before, eye, ".seen")), 480 * 500 / 12) << "the screen";
    EXPECT_GT(pixelsApart(seen(before, eye, ".seen"), seen(pointing, eye, ".seen")), 100) << "ray and spot";
  }
  const render::Image frame = seen(pointing, "quad0");
  EXPECT_EQ(frame.width, 1100);
  EXPECT_EQ(frame.height, 800);

  stage.act(set("right trigger", 1) + set("right trigger", 0, 5));
  const State chosen = program->until("the tool", [](const State& s) { return s["tool"] == "smooth"; });
  EXPECT_TRUE(chosen["room"]["tip"].is_null()) << "a click is no stroke";
  (void)user.rest();
  EXPECT_EQ(program->now()["steps"], 0);

  // The panels scroll under the ray.
  const auto shows = [&] { return program->now()["texts"].dump(); };
  const std::string top = shows();
  stage.act(set("right scroll", -1) + set("right scroll", 0, 40));
  (void)program->until("scrolled", [&](const State& s) { return s["texts"].dump() != top; });
  EXPECT_GT(program->now()["wheels"], 0);

  // Away from the screen it is the tip.
  stage.act(over("right", 0.0, 0.95, kTableZ_m, 50) + set("right trigger", 1, 55) +
            set("right trigger", 0, 60));
  tipIs(*program, "right");
  EXPECT_EQ(program->now()["room"]["points"], false);
  // And back at the screen it is not.
  stage.act(at("right", button.x, button.y));
  tipIs(*program, State());
  (void)program->until("it points", [](const State& s) { return s["room"]["points"] == true; });
  (void)quit(user);
  stage.expectSilence();
}

}  // namespace
}  // namespace fettle::tests
