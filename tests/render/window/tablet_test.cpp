#include "render/window/tablet.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/render/window/fake_x_server.h"

namespace fettle::render {
namespace {

using tests::FakeAxis;
using tests::FakeDevice;
using tests::FakeEvent;
using tests::FakeXServer;

constexpr std::uint32_t kWindow = 0x400007;
constexpr std::uint16_t kPress = 4, kRelease = 5, kMotion = 6;

// As `xinput list --long` prints it of a Wacom Intuos Pro M (TurboVNC's issue 154).
FakeDevice wacom(std::uint16_t id, const std::string& name) {
  return {id,
          name,
          {{"Abs X", 0.0, 54204.0, 200000},
           {"Abs Y", 0.0, 31750.0, 200000},
           {"Abs Pressure", 0.0, 65536.0, 1},
           {"Abs Tilt X", -64.0, 63.0, 57},
           {"Abs Tilt Y", -64.0, 63.0, 57},
           {"Abs Wheel", -900.0, 899.0, 1}}};
}
FakeDevice mouse() {
  return {4, "Virtual core XTEST pointer", {{"Rel X", -1.0, -1.0, 0}, {"Rel Y", -1.0, -1.0, 0}}};
}

// As `xinput test-xi2` printed it of a Wacom PTH-651 when its tip was pressed (linuxwacom/xf86-input-wacom, issue 304).
FakeEvent recordedPress(std::uint16_t device) {
  return {kPress, device, 1, {{0, 28385.0}, {1, 4290.0}, {2, 20457.0}, {3, 20.0}, {4, 26.0}, {5, -900.0}}};
}

std::optional<Pen> after(Tablet& tablet, FakeXServer& server, const FakeEvent& event) {
  server.send(event);
  return tablet.penOfPress();
}

TEST(Tablet, a_recorded_press_is_a_pen_with_its_pressure_and_tilt) {
  FakeXServer server({mouse(), wacom(8, "Wacom Intuos Pro M Pen stylus")});
  const auto tablet = Tablet::over(server.connect(), kWindow);
  ASSERT_NE(tablet, nullptr);
  EXPECT_TRUE(tablet->hasPens());
  EXPECT_FALSE(tablet->penOfPress()) << "its tip is not down";
  EXPECT_EQ(server.selected(kWindow), std::vector<std::uint16_t>{8}) << "of the pen alone";

  const std::optional<Pen> pressed = after(*tablet, server, recordedPress(8));
  ASSERT_TRUE(pressed);
  EXPECT_NEAR(pressed->pressure, 20457.0 / 65536.0, 1e-12);
  EXPECT_EQ(pressed->tilt_deg, glm::dvec2(20.0, 26.0));
  EXPECT_FALSE(pressed->eraser);

  // An event lists what changed: the rest stays.
  const std::optional<Pen> harder = after(*tablet, server, {kMotion, 8, 0, {{2, 65536.0}}});
  ASSERT_TRUE(harder);
  EXPECT_EQ(harder->pressure, 1.0);
  EXPECT_EQ(harder->tilt_deg, glm::dvec2(20.0, 26.0));
  EXPECT_FALSE(after(*tablet, server, {kRelease, 8, 1, {{2, 0.0}}}));
}

TEST(Tablet, its_other_end_is_the_eraser) {
  FakeXServer server({wacom(8, "Wacom Intuos Pro M Pen stylus"), wacom(9, "Wacom Intuos Pro M Pen eraser")});
  const auto tablet = Tablet::over(server.connect(), kWindow);
  ASSERT_NE(tablet, nullptr);
  const std::optional<Pen> pressed = after(*tablet, server, recordedPress(9));
  ASSERT_TRUE(pressed);
  EXPECT_TRUE(pressed->eraser);
}

TEST(Tablet, a_mouse_and_other_buttons_are_no_pen) {
  FakeXServer server({mouse(), wacom(8, "stylus")});
  const auto tablet = Tablet::over(server.connect(), kWindow);
  ASSERT_NE(tablet, nullptr);
  EXPECT_FALSE(after(*tablet, server, {kPress, 4, 1, {{0, 5.0}, {2, 9.0}}}));
  EXPECT_FALSE(after(*tablet, server, {kPress, 8, 2, {{2, 100.0}}})) << "the button at its side, in the air";
}

TEST(Tablet, a_pen_that_is_plugged_in_later_is_found) {
  FakeXServer server({mouse()});
  const auto tablet = Tablet::over(server.connect(), kWindow);
  ASSERT_NE(tablet, nullptr);
  EXPECT_FALSE(tablet->hasPens());
  EXPECT_FALSE(tablet->penOfPress()) << "without a pen no server is waited for";
  server.plugIn(wacom(11, "stylus"));
  while (!tablet->hasPens()) static_cast<void>(tablet->pen());
  EXPECT_TRUE(after(*tablet, server, recordedPress(11)));
}

// The kernel's digitizer of an ASUS pen: hundredths of a degree from 0 to 180, upright in the middle.
TEST(Tablet, tilt_in_finer_units_from_the_middle_of_a_positive_range) {
  FakeXServer server({{7,
                       "ELAN Stylus Pen (0)",
                       {{"Abs X", 0.0, 32767.0, 109},
                        {"Abs Y", 0.0, 32767.0, 174},
                        {"Abs Pressure", 0.0, 4096.0, 1},
                        {"Abs Tilt X", 0.0, 18000.0, 5730},
                        {"Abs Tilt Y", 0.0, 18000.0, 5730}}}});
  const auto tablet = Tablet::over(server.connect(), kWindow);
  ASSERT_NE(tablet, nullptr);
  const std::optional<Pen> pen =
      after(*tablet, server, {kPress, 7, 1, {{2, 1024.0}, {3, 9000.0}, {4, 6000.0}}});
  ASSERT_TRUE(pen);
  EXPECT_EQ(pen->pressure, 0.25);
  ASSERT_TRUE(pen->tilt_deg);
  EXPECT_EQ(pen->tilt_deg->x, 0.0);
  EXPECT_NEAR(pen->tilt_deg->y, -30.0, 0.01);
}

TEST(Tablet, without_tilt_there_is_none) {
  FakeXServer server(
      {{7, "pen", {{"Abs X", 0.0, 9.0, 1}, {"Abs Y", 0.0, 9.0, 1}, {"Abs Pressure", 0.0, 1024.0, 1}}}});
  const auto tablet = Tablet::over(server.connect(), kWindow);
  ASSERT_NE(tablet, nullptr);
  const std::optional<Pen> pen = after(*tablet, server, {kPress, 7, 1, {{2, 512.0}}});
  ASSERT_TRUE(pen);
  EXPECT_EQ(*pen, (Pen{0.5, std::nullopt, false}));
}

TEST(Tablet, values_out_of_range_stay_within_it) {
  FakeXServer server({wacom(8, "stylus")});
  const auto tablet = Tablet::over(server.connect(), kWindow);
  ASSERT_NE(tablet, nullptr);
  const std::optional<Pen> pen =
      after(*tablet, server, {kPress, 8, 1, {{2, 2.0e9}, {3, -2.0e9}, {4, 2.0e9}}});
  ASSERT_TRUE(pen);
  EXPECT_EQ(pen->pressure, 1.0);
  EXPECT_EQ(pen->tilt_deg, glm::dvec2(-90.0, 90.0));
}

// An event that says it lists more than it has: what it has is taken, and nothing behind it is read (under a sanitizer).
TEST(Tablet, an_event_that_lies_about_its_length_does_no_harm) {
  FakeXServer server({wacom(8, "stylus")});
  const auto tablet = Tablet::over(server.connect(), kWindow);
  ASSERT_NE(tablet, nullptr);
  for (const std::size_t at : {48U, 50U, 84U}) {  // buttons, words of which, which
    std::vector<std::uint8_t> wire = tests::wireOf(recordedPress(8));
    wire[at] = wire[at + 1] = 0xff;
    server.send(wire);
  }
  std::vector<std::uint8_t> empty = tests::wireOf(recordedPress(8));
  empty.resize(32);
  empty[4] = 0;
  server.send(empty);
  static_cast<void>(tablet->penOfPress());
  EXPECT_TRUE(after(*tablet, server, recordedPress(8))) << "and what comes afterwards is heard";
}

TEST(Tablet, without_the_extension_or_a_server_there_is_no_tablet) {
  FakeXServer none({}, FakeXServer::Input::kNone);
  EXPECT_EQ(Tablet::over(none.connect(), kWindow), nullptr);
  FakeXServer old({}, FakeXServer::Input::kVersion1);
  EXPECT_EQ(Tablet::over(old.connect(), kWindow), nullptr);
}

TEST(Tablet, a_server_that_dies_leaves_no_one_waiting) {
  FakeXServer server({wacom(8, "stylus")});
  const auto tablet = Tablet::over(server.connect(), kWindow);
  ASSERT_NE(tablet, nullptr);
  ASSERT_TRUE(after(*tablet, server, recordedPress(8)));
  server.die();
  static_cast<void>(tablet->penOfPress());
  static_cast<void>(tablet->pen());
}

}  // namespace
}  // namespace fettle::render
