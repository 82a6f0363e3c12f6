// Devices without hardware behind them: mouse, replay, SpaceMouse's pure part, workspace, known limits.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/devices/enumerate.h"
#include "haptic/devices/hid/hid_port.h"
#include "haptic/devices/hid/space_mouse.h"
#include "haptic/devices/known_devices.h"
#include "haptic/devices/virtual/mouse_stylus.h"
#include "haptic/devices/virtual/replay_device.h"
#include "haptic/devices/workspace.h"
#include "tests/support/markdown_table.h"
#include "tests/support/temp_folder.h"

namespace fettle::haptic {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(SpaceMouseCodec, BothFormsAreDistinguishedByLength) {
  SpaceMouseState s;
  EXPECT_TRUE(takeSpaceMouse(std::array<std::uint8_t, 7>{1, 0x5E, 0x01, 0xA2, 0xFE, 10, 0}, s));
  EXPECT_TRUE(takeSpaceMouse(std::array<std::uint8_t, 7>{2, 1, 0, 2, 0, 0xFD, 0xFF}, s));
  EXPECT_EQ(s.axes, (std::array<std::int16_t, 6>{350, -350, 10, 1, 2, -3}));
  EXPECT_TRUE(takeSpaceMouse(std::array<std::uint8_t, 13>{1, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0}, s));
  EXPECT_EQ(s.axes, (std::array<std::int16_t, 6>{1, 2, 3, 4, 5, 6}));
}

TEST(SpaceMouseCodec, ButtonsAreABitMaskFromByteOneAndLeaveTheAxes) {
  SpaceMouseState s;
  s.axes = {1, 2, 3, 4, 5, 6};
  EXPECT_TRUE(takeSpaceMouse(std::array<std::uint8_t, 3>{3, 2, 0}, s));
  EXPECT_EQ(s.buttons, kSecondaryButton);
  EXPECT_TRUE(takeSpaceMouse(std::array<std::uint8_t, 5>{3, 1, 0, 0, 0x80}, s));
  EXPECT_EQ(s.buttons, 0x80000001U);
  // A longer report: 32 buttons, and bytes that are none.
  EXPECT_TRUE(takeSpaceMouse(std::array<std::uint8_t, 7>{3, 4, 0, 0, 0, 0xFF, 0xFF}, s));
  EXPECT_EQ(s.buttons, 4U);
  EXPECT_EQ(s.axes[5], 6);
}

TEST(SpaceMouseCodec, OtherReportsAndLengthsChangeNothing) {
  std::mt19937 random(5);
  for (int i = 0; i < 100000; ++i) {
    std::vector<std::uint8_t> report(random() % 20);
    for (auto& b : report) b = static_cast<std::uint8_t>(random());
    if (!report.empty() && i % 2 == 0) report[0] %= 5;
    SpaceMouseState s;
    s.axes.fill(42);
    s.buttons = 42;
    if (!takeSpaceMouse(report, s)) {
      EXPECT_EQ(s.axes[0] + s.axes[5], 84);
      EXPECT_EQ(s.buttons, 42U);
    }
    for (const std::int16_t a : s.axes) EXPECT_LE(std::abs(a), 350);
  }
}

TEST(SpaceMouse, RateIsOddMonotonicAndZeroAtRest) {
  const RateControl control;
  EXPECT_EQ(rateOf(0, control), 0.0);
  EXPECT_EQ(rateOf(14, control), 0.0);  // 4 % of 350
  EXPECT_DOUBLE_EQ(rateOf(350, control), 1.0);
  for (std::int16_t d = 1; d <= 350; ++d) {
    EXPECT_GE(rateOf(d, control), rateOf(static_cast<std::int16_t>(d - 1), control));
    EXPECT_EQ(rateOf(static_cast<std::int16_t>(-d), control), -rateOf(d, control));
  }
}

TEST(ReportDescriptor, WoodenHapticsDescriptorsStateTheirSizes) {
  for (const std::uint8_t n : {std::uint8_t{8}, std::uint8_t{14}}) {
    const std::vector<std::uint8_t> d{0x06, 0xAB, 0xFF, 0x0A, 0x00, 0x02, 0xA1, 0x01, 0x75, 0x08,
                                      0x15, 0x00, 0x26, 0xFF, 0x00, 0x95, n,    0x09, 0x01, 0x81,
                                      0x02, 0x95, n,    0x09, 0x02, 0x91, 0x02, 0xC0};
    const ReportSizes s = reportSizes(d);
    EXPECT_EQ(s.input_bytes, n);
    EXPECT_EQ(s.output_bytes, n);
    EXPECT_FALSE(s.numbered);
  }
}

TEST(ReportDescriptor, NumberedReportsCountTheLongestWithItsId) {
  // Report 1: 3 x 16 bit, report 2: 6 x 16 bit input; report 4: 5 bit output.
  const std::vector<std::uint8_t> d{0x85, 1,    0x75, 16,   0x95, 3,    0x81, 2,    0x85, 2,    0x95,
                                    6,    0x81, 2,    0x85, 4,    0x75, 1,    0x95, 5,    0x91, 2};
  const ReportSizes s = reportSizes(d);
  EXPECT_EQ(s.input_bytes, 13U);
  EXPECT_EQ(s.output_bytes, 2U);
  EXPECT_TRUE(s.numbered);
}

TEST(ReportDescriptor, AnyBytesGiveSomeSizeWithinBounds) {
  std::mt19937 random(6);
  for (int i = 0; i < 100000; ++i) {
    std::vector<std::uint8_t> d(random() % 64);
    for (auto& b : d) b = static_cast<std::uint8_t>(random());
    EXPECT_LE(reportSizes(d).input_bytes, 65537U);
  }
}

HidInterface interfaceOf(std::uint16_t vendor, std::uint16_t product) {
  HidInterface i;
  i.path = "/dev/hidraw9";
  i.vendor = vendor;
  i.product = product;
  return i;
}

TEST(HidKind, GenericIdNeedsTheUsageAndTheSizesWhereTheyAreKnown) {
  HidInterface i = interfaceOf(0x1234, 0x0006);
  EXPECT_EQ(hidKind(i), HidKind::kWoodenHaptics);  // nothing known against it
  i.usage_page = 0xFFAB;
  i.usage = 0x0200;
  i.input_bytes = 14;
  EXPECT_EQ(hidKind(i), HidKind::kWoodenHaptics);
  i.input_bytes = 64;
  EXPECT_EQ(hidKind(i), HidKind::kNone);
  i.input_bytes = 8;
  i.usage_page = 0xFF00;
  EXPECT_EQ(hidKind(i), HidKind::kNone);
}

TEST(HidKind, SpaceMiceAreKnownByIdAndTheirKeyboardInterfaceIsNotTaken) {
  EXPECT_EQ(hidKind(interfaceOf(0x046d, 0xc626)), HidKind::kSpaceMouse);
  EXPECT_EQ(hidKind(interfaceOf(0x256f, 0xc635)), HidKind::kSpaceMouse);
  EXPECT_EQ(hidKind(interfaceOf(0x046d, 0xc635)), HidKind::kNone);
  HidInterface keyboard = interfaceOf(0x256f, 0xc633);
  keyboard.usage_page = 1;
  keyboard.usage = 6;
  EXPECT_EQ(hidKind(keyboard), HidKind::kNone);
}

// A loop that reads the mouse once a millisecond.
class MouseLoop {
 public:
  DeviceInput tick() {
    const DeviceInput input = mouse.readAt(++ms_ * kMs);
    EXPECT_EQ(input.tool.has_value(), input.buttons != 0)
        << "a tool is named during strokes and not between them";
    return input;
  }
  DeviceInput ticks(int n) {
    for (int i = 1; i < n; ++i) static_cast<void>(tick());
    return tick();
  }
  // The inputs of a stroke: from the first with the button to the last.
  std::vector<DeviceInput> stroke(int most = 1000) {
    std::vector<DeviceInput> inputs;
    for (int i = 0; i < most; ++i) {
      const DeviceInput input = tick();
      if (input.buttons != 0)
        inputs.push_back(input);
      else if (!inputs.empty())
        break;
    }
    return inputs;
  }
  MouseStylus mouse;

 private:
  std::int64_t ms_ = 0;
};

TEST(MouseStylus, TipHoversAndFollowsWithItsTimeConstant) {
  MouseStylus mouse;
  EXPECT_EQ(mouse.readAt(0).link, LinkState::kDisconnected);
  mouse.setCursor({10.0, 20.0, 5.0});
  DeviceInput in = mouse.readAt(1 * kMs);
  EXPECT_EQ(in.link, LinkState::kConnected);
  EXPECT_EQ(in.position_mm, (glm::dvec3{10.0, 20.0, 6.0}));
  mouse.setCursor({10.0, 30.0, 4.0});
  in = mouse.readAt(21 * kMs);
  // One time constant: 1 - 1/e of the way.
  EXPECT_NEAR(in.position_mm.y, 20.0 + 10.0 * (1.0 - std::exp(-1.0)), 1e-12);
  EXPECT_NEAR(in.position_mm.z, 6.0 - (1.0 - std::exp(-1.0)), 1e-12);
  EXPECT_EQ(in.buttons, 0U);
  EXPECT_EQ(in.sequence, 2U);
}

TEST(MouseStylus, AStrokeBeginsWhereTheButtonWasPressedAndEndsWhereItWasLetGo) {
  MouseLoop loop;
  loop.mouse.setCursor({0.0, 0.0, 0.0});
  EXPECT_EQ(loop.ticks(100).position_mm, (glm::dvec3{0.0, 0.0, 1.0}));
  // The cursor leaps across the field, and the button is down at once.
  loop.mouse.setCursor({300.0, 40.0, 2.0});
  loop.mouse.press(Tool::kMark);
  loop.mouse.setCursor({305.0, 40.0, 2.0});
  loop.mouse.setCursor({310.0, 40.0, 2.0});
  loop.mouse.release();
  // First nowhere: no way from where it was to where it comes down, so no contact on it.
  const DeviceInput lifted = loop.tick();
  EXPECT_TRUE(std::isnan(lifted.position_mm.x));
  EXPECT_EQ(lifted.buttons, 0U);
  EXPECT_EQ(lifted.link, LinkState::kConnected);
  EXPECT_TRUE(loop.mouse.busy());
  const std::vector<DeviceInput> stroke = loop.stroke();
  ASSERT_FALSE(stroke.empty());
  EXPECT_NEAR(stroke.front().position_mm.z, 2.0 + 1.0 - 1.3 * -std::expm1(-1.0 / 3.0), 1e-12);
  bool down = false;
  for (const DeviceInput& input : stroke) {
    EXPECT_EQ(input.tool, Tool::kMark);
    EXPECT_GE(input.position_mm.x, 300.0);
    EXPECT_LE(input.position_mm.x, 310.0);
    // It does not move on before it is down: the stroke's beginning is on the surface.
    EXPECT_TRUE(input.position_mm.x == 300.0 || input.position_mm.z < 2.0 - 0.2) << input.position_mm.z;
    down = down || input.position_mm.z < 2.0 - 0.2;
  }
  EXPECT_TRUE(down);
  EXPECT_NEAR(stroke.back().position_mm.x, 310.0, 0.05);
  const DeviceInput after = loop.ticks(500);
  EXPECT_FALSE(loop.mouse.busy());
  EXPECT_EQ(after.buttons, 0U);
  EXPECT_FALSE(after.tool.has_value());
  EXPECT_NEAR(after.position_mm.z, 3.0, 1e-9);
}

TEST(MouseStylus, AHandIsFollowedWhenTheTipIsWhereItPoints) {
  MouseLoop loop;
  loop.mouse.setCursor({0.0, 0.0, 0.0});
  (void)loop.tick();
  EXPECT_FALSE(loop.mouse.busy()) << "the tip appears at the cursor";
  loop.mouse.setCursor({10.0, 0.0, 0.0});
  (void)loop.tick();
  EXPECT_TRUE(loop.mouse.busy()) << "on its way";
  EXPECT_NEAR(loop.ticks(200).position_mm.x, 10.0, 0.05);
  EXPECT_FALSE(loop.mouse.busy());
  loop.mouse.setCursor({0.0, 0.0, 0.0});
  loop.mouse.leave();
  (void)loop.tick();
  EXPECT_FALSE(loop.mouse.busy()) << "over no surface there is no place to come to";
}

TEST(MouseStylus, APressBetweenTwoTicksIsAStroke) {
  MouseLoop loop;
  loop.mouse.setCursor({1.0, 2.0, 3.0});
  static_cast<void>(loop.tick());
  for (int i = 0; i < 3; ++i) {
    loop.mouse.press(Tool::kSmooth);
    loop.mouse.release();
  }
  for (int i = 0; i < 3; ++i) {
    const std::vector<DeviceInput> stroke = loop.stroke();
    ASSERT_FALSE(stroke.empty()) << i;
    EXPECT_LT(stroke.back().position_mm.z, 3.0 - 0.2) << i;
  }
  EXPECT_TRUE(loop.stroke().empty());
}

TEST(MouseStylus, APenPressesAsDeepAsTheHandAndLeansAsItDoes) {
  MouseLoop loop;
  loop.mouse.setCursor({0.0, 0.0, 0.0});
  static_cast<void>(loop.tick());
  EXPECT_FALSE(loop.ticks(10).orientation);
  const glm::dvec3 to_hand = glm::normalize(glm::dvec3(0.3, -0.4, 1.0));
  loop.mouse.hold(PenHold{0.5, to_hand});
  loop.mouse.press(Tool::kSmooth);
  DeviceInput input = loop.ticks(300);
  EXPECT_NEAR(input.position_mm.z, -0.15, 1e-6) << "half of 0.3 mm";
  ASSERT_TRUE(input.orientation);
  EXPECT_NEAR(glm::distance(*input.orientation * glm::dvec3(0.0, 0.0, 1.0), to_hand), 0.0, 1e-12);
  loop.mouse.hold(PenHold{1.0, glm::dvec3(0.0, 0.0, -1.0)});
  input = loop.ticks(300);
  EXPECT_NEAR(input.position_mm.z, -0.3, 1e-6);
  EXPECT_NEAR((*input.orientation * glm::dvec3(0.0, 0.0, 1.0)).z, -1.0, 1e-12) << "upside down, too";
  loop.mouse.wheel(-2.0);
  EXPECT_NEAR(loop.mouse.pressMm(), 0.4, 1e-12) << "the wheel sets the whole depth";
  loop.mouse.hold(PenHold{0.25, std::nullopt});
  input = loop.ticks(300);
  EXPECT_NEAR(input.position_mm.z, -0.1, 1e-6);
  EXPECT_FALSE(input.orientation);
  // Nothing of what a driver may say is believed.
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const PenHold& wrong : {PenHold{kNan, glm::dvec3(kNan)}, PenHold{7.0, glm::dvec3(0.0)}}) {
    loop.mouse.hold(wrong);
    input = loop.ticks(300);
    EXPECT_NEAR(input.position_mm.z, -0.4, 1e-6);
    EXPECT_FALSE(input.orientation);
  }
  loop.mouse.hold(std::nullopt);
  EXPECT_NEAR(loop.ticks(300).position_mm.z, -0.4, 1e-6) << "a mouse has no pressure";
  loop.mouse.release();
  EXPECT_NEAR(loop.ticks(500).position_mm.z, 1.0, 1e-6);
}

TEST(MouseStylus, OffTheSurfaceTheTipLiftsAndTheStrokeGoesOn) {
  MouseLoop loop;
  loop.mouse.setCursor({0.0, 0.0, 0.0});
  static_cast<void>(loop.tick());
  loop.mouse.press(Tool::kSmooth);
  EXPECT_NEAR(loop.ticks(200).position_mm.z, -0.3, 1e-3);
  loop.mouse.leave();
  DeviceInput in = loop.ticks(200);
  EXPECT_NEAR(in.position_mm.z, 1.0, 1e-3);
  EXPECT_EQ(in.buttons, kPrimaryButton);
  loop.mouse.setCursor({5.0, 0.0, 0.0});
  in = loop.ticks(200);
  EXPECT_NEAR(in.position_mm.z, -0.3, 1e-3);
  EXPECT_EQ(in.buttons, kPrimaryButton);
  // Let go in the air, it has nowhere to go first.
  loop.mouse.leave();
  loop.mouse.release();
  EXPECT_EQ(loop.ticks(3).buttons, 0U);
}

TEST(MouseStylus, AStrokeKeepsItsToolAndTheDepthItIsGiven) {
  MouseLoop loop;
  loop.mouse.setCursor({0.0, 0.0, 0.0});
  static_cast<void>(loop.tick());
  loop.mouse.press(Tool::kSmooth);
  static_cast<void>(loop.ticks(200));
  loop.mouse.wheel(-4);
  loop.mouse.press(Tool::kMark);
  const DeviceInput in = loop.ticks(200);
  EXPECT_NEAR(in.position_mm.z, -0.5, 1e-3);
  EXPECT_EQ(in.tool, Tool::kSmooth);
}

TEST(MouseStylus, AFramesBunchOfPlacesIsFollowedAlongItsWay) {
  // Round a corner within one frame of a slow window: half the places along x, half along y.
  MouseLoop loop;
  loop.mouse.setCursor({0.0, 0.0, 0.0});
  static_cast<void>(loop.tick());
  loop.mouse.press(Tool::kSmooth);
  static_cast<void>(loop.ticks(200));
  for (int i = 1; i <= 20; ++i) loop.mouse.setCursor({0.5 * i, 0.0, 0.0});
  for (int i = 1; i <= 20; ++i) loop.mouse.setCursor({10.0, 0.5 * i, 0.0});
  loop.mouse.release();
  double nearest = 1e9;
  for (const DeviceInput& in : loop.stroke())
    nearest = std::min(nearest, std::hypot(in.position_mm.x - 10.0, in.position_mm.y));
  // What is cut off the corner; a tip that only knew the last place would keep 7.1 mm off.
  EXPECT_LT(nearest, 6.0);
}

TEST(MouseStylus, AWindowThatOutrunsAStoppedLoopLosesPlacesNotButtons) {
  MouseLoop loop;
  loop.mouse.setCursor({0.0, 0.0, 0.0});
  static_cast<void>(loop.tick());
  for (int i = 0; i < 20000; ++i) loop.mouse.setCursor({1e-3 * i, 0.0, 0.0});
  loop.mouse.press(Tool::kSmooth);
  loop.mouse.release();
  const std::vector<DeviceInput> stroke = loop.stroke();
  ASSERT_FALSE(stroke.empty());
  EXPECT_NEAR(stroke.back().position_mm.x, 20.0, 0.05);
}

TEST(MouseStylus, WheelSetsTheDepthWithinItsBounds) {
  MouseStylus mouse;
  mouse.wheel(-4);
  EXPECT_NEAR(mouse.pressMm(), 0.5, 1e-12);
  mouse.wheel(-1e9);
  EXPECT_EQ(mouse.pressMm(), 3.0);
  mouse.wheel(1e9);
  EXPECT_EQ(mouse.pressMm(), 0.0);
  mouse.wheel(std::nan(""));
  EXPECT_EQ(mouse.pressMm(), 0.0);
}

TEST(MouseStylus, NonFiniteCursorIsNoPlace) {
  MouseStylus mouse;
  mouse.setCursor({std::nan(""), 0, 0});
  EXPECT_EQ(mouse.readAt(0).link, LinkState::kDisconnected);
  mouse.setCursor({1, 2, 3});
  static_cast<void>(mouse.readAt(1 * kMs));
  mouse.setCursor({0, std::numeric_limits<double>::infinity(), 0});
  const glm::dvec3 p = mouse.readAt(100 * kMs).position_mm;
  EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
}

std::vector<StrokeSample> threeRows() {
  return {
      {1.000, {0, 0, 5}, Tool::kFeel}, {1.001, {1, 0, 4}, Tool::kSmooth}, {1.003, {2, 0, 3}, Tool::kMark}};
}

TEST(ReplayDevice, RowsComeWhenTheirTimeHasCome) {
  ReplayDevice replay(threeRows());
  EXPECT_EQ(replay.readAt(500 * kMs).position_mm.x, 0.0);
  EXPECT_EQ(replay.readAt(500 * kMs + 999'999).position_mm.x, 0.0);
  DeviceInput in = replay.readAt(501 * kMs);
  EXPECT_EQ(in.position_mm.x, 1.0);
  EXPECT_EQ(in.tool, Tool::kSmooth);
  EXPECT_EQ(replay.readAt(502 * kMs).position_mm.x, 1.0);
  EXPECT_FALSE(replay.finished());
  in = replay.readAt(900 * kMs);  // late: the last row holds
  EXPECT_EQ(in.position_mm.x, 2.0);
  EXPECT_TRUE(replay.finished());
  EXPECT_EQ(in.sequence, 5U);
}

TEST(ReplayDevice, EachReadPaceGivesEveryRowOnce) {
  ReplayDevice replay(threeRows(), ReplayPace::kEachRead);
  for (int run = 0; run < 2; ++run) {
    ASSERT_TRUE(replay.start());
    for (int i = 0; i < 3; ++i) EXPECT_EQ(replay.readAt(0).position_mm.x, i);
    EXPECT_TRUE(replay.finished());
  }
}

TEST(ReplayDevice, WithoutRowsThereIsNoDevice) {
  ReplayDevice replay({});
  EXPECT_EQ(replay.readAt(0).link, LinkState::kDisconnected);
  EXPECT_TRUE(replay.finished());
}

TEST(Workspace, TurnAndScaleMapBothWaysWithWorkKeptUpToTheScale) {
  const Workspace w(0.25, {100, 200, 30}, 0.7);
  EXPECT_EQ(w.toField({0, 0, 0}), (glm::dvec3{100, 200, 30}));
  const glm::dvec3 step_device{3, -4, 12};
  const glm::dvec3 step_field = w.toField(step_device) - w.toField({0, 0, 0});
  EXPECT_NEAR(glm::length(step_field), 0.25 * 13.0, 1e-12);
  const glm::dvec3 f{1.0, 2.0, -3.0};
  // F_field . dx_field = s F_device . dx_device
  EXPECT_NEAR(glm::dot(f, step_field), 0.25 * glm::dot(w.forceToDevice(f), step_device), 1e-12);
}

TEST(Workspace, StiffnessIsFeltAsTheScaleSays) {
  const Workspace w(0.25, {0, 0, 0});
  constexpr double k = 2.0;  // N/mm in the field
  const double depth_device = 0.4;
  const double force = k * -w.toField({0, 0, -depth_device}).z;
  EXPECT_NEAR(w.forceToDevice({0, 0, force}).z / depth_device, w.feltStiffness(k), 1e-12);
  EXPECT_DOUBLE_EQ(w.fieldStiffness(w.feltStiffness(k)), k);
}

TEST(Workspace, ClutchHoldsTheTipAndGoesOnFromThere) {
  Workspace w(2.0, {0, 0, 0});
  w.setClutch(Workspace::Clutch::kHeld, {10, 0, 0});
  EXPECT_EQ(w.toField({-30, 5, 5}), (glm::dvec3{20, 0, 0}));
  EXPECT_EQ(w.forceToDevice({1, 1, 1}), glm::dvec3{0.0});
  w.setClutch(Workspace::Clutch::kReleased, {-30, 5, 5});
  EXPECT_EQ(w.toField({-30, 5, 5}), (glm::dvec3{20, 0, 0}));
  EXPECT_EQ(w.toField({-29, 5, 5}), (glm::dvec3{22, 0, 0}));
}

TEST(Workspace, ChangeOfViewDoesNotMoveTheTip) {
  Workspace w(2.0, {7, 8, 9});
  const glm::dvec3 device{10, -20, 5};
  const glm::dvec3 tip = w.toField(device);
  w.setView(0.1, 2.5, device);
  EXPECT_LT(glm::length(w.toField(device) - tip), 1e-12);
  EXPECT_DOUBLE_EQ(w.scale(), 0.1);
}

TEST(KnownDevices, UnknownDeviceGetsTheLowestLimitsOfAll) {
  const DeviceProfile unknown;
  EXPECT_FALSE(knownProfile("no such thing"));
  for (const KnownDevice& d : knownDevices()) {
    EXPECT_LE(unknown.max_force_n, d.max_force_n) << d.name;
    EXPECT_LE(unknown.max_stiffness_n_per_mm, d.max_stiffness_n_per_mm) << d.name;
    EXPECT_LE(unknown.max_damping_n_s_per_mm, d.max_damping_n_s_per_mm) << d.name;
  }
  EXPECT_EQ(knownProfile("falcon")->max_force_n, 8.0);
}

TEST(OpenDevice, DriversAreThoseOfTheDocuments) {
  const auto rows = tests::markdownTable("docs/devices.md", "| device | word |");
  ASSERT_EQ(rows.size(), knownDrivers().size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const KnownDriver& driver = knownDrivers()[i];
    EXPECT_EQ(rows[i][0], driver.title);
    const std::string argument = driver.argument.empty() ? "" : ":" + std::string(driver.argument);
    EXPECT_EQ(rows[i][1], "`" + std::string(driver.word) + argument + "`");
    if (driver.kind != DeviceKind::kOther) {
      EXPECT_EQ(rows[i][3], driver.gives_force ? "yes" : "no");
    }
  }
}

TEST(OpenDevice, WordsNameDevicesAndWrongOnesAreRefused) {
  const tests::TempFolder folder;
  const std::string strokes = folder.file("s.csv");
  ASSERT_TRUE(writeStrokes(strokes, threeRows()));
  EXPECT_EQ((*openDevice("mouse"))->profile().name, "mouse");
  EXPECT_EQ((*openDevice("hand"))->profile().name, "simulated hand");
  EXPECT_EQ((*openDevice("replay:" + strokes))->read().position_mm.z, 5.0);
  EXPECT_EQ((*openDevice("spacemouse"))->profile().gives_force, false);
  EXPECT_FALSE(openDevice("replay:/nowhere.csv"));
  EXPECT_FALSE(openDevice("replay"));
  EXPECT_FALSE(openDevice("/dev/null"));
  EXPECT_FALSE(openDevice(""));
}

}  // namespace
}  // namespace fettle::haptic
