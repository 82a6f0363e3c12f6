// What the buttons of a device do: the clutch, the tool and the tip that they choose, the strokes that they begin and end.
#include "haptic/loop/loop_tick.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/haptic/loop/hand_device.h"
#include "tests/haptic/loop/touched_fields.h"

namespace fettle::haptic {
namespace {

// A hand in the surface that marks with the first button.
class ButtonHand {
 public:
  ButtonHand() : start_(tests::bumpy()) {
    tests::reserve(start_);
    options_.tool_switch = ToolSwitch::kButton;
    options_.workspace = Workspace(1.0, {100.0, 100.0, 0.0});
    channels_ = std::make_unique<LoopChannels>(options_);
    loop_ = std::make_unique<LoopTick>(std::make_unique<PreparedScene>(tests::sceneWithBrush(0.0), start_),
                                       start_, device_, *channels_, options_);
  }
  // So many milliseconds with these buttons, moving on.
  void hold(std::uint32_t buttons, int ms) {
    for (int i = 0; i < ms; ++i) {
      device_.input.position_mm = {0.1 * moved_++, 0.0, -1.0};
      device_.input.buttons = buttons;
      device_.now_ns += 1'000'000;
      loop_->run(device_.now_ns, 1'000'000);
    }
  }
  void setLink(LinkState link) { device_.input.link = link; }
  void choose(Tool tool) {
    LoopCommand command;
    command.kind = CommandKind::kTool;
    command.tool = tool;
    ASSERT_TRUE(channels_->commands.push(std::move(command)));
  }
  [[nodiscard]] const LoopState& state() const { return loop_->state(); }
  // Since the last call: strokes begun when each ended.
  [[nodiscard]] std::vector<std::uint64_t> endedStrokes() {
    std::vector<std::uint64_t> ended;
    for (LoopEvent event; channels_->events.pop(event);)
      if (event.kind == EventKind::kStrokeEnded) {
        ended.push_back(event.stroke);
        tool_of_ended_ = event.tool;
      }
    return ended;
  }
  // Of the last of them.
  [[nodiscard]] std::optional<Tool> toolOfEnded() const { return tool_of_ended_; }

 private:
  engine::Version start_;
  tests::DeskDevice device_;
  LoopOptions options_ = tests::testOptions(Tool::kMark);
  std::unique_ptr<LoopChannels> channels_;
  std::unique_ptr<LoopTick> loop_;
  std::optional<Tool> tool_of_ended_;
  int moved_ = 0;
};
constexpr std::uint32_t kClutched = kSecondaryButton | kPrimaryButton;

TEST(ButtonTools, TheFirstButtonUnderTheClutchChoosesToolsAndIsNoStrokeUntilItWasReleased) {
  ButtonHand hand;
  hand.hold(0, 5);
  hand.hold(kSecondaryButton, 400);
  for (std::uint64_t presses = 1; presses <= 3; ++presses) {
    hand.hold(kClutched, 50);
    EXPECT_EQ(hand.state().tool_choices, presses);
    hand.hold(kSecondaryButton, 50);
  }
  hand.hold(kClutched, 50);
  // The clutch is released first.
  hand.hold(kPrimaryButton, 50);
  EXPECT_EQ(hand.state().tool, Tool::kFeel);
  EXPECT_EQ(hand.state().stroke, 0U);
  hand.hold(0, 5);
  hand.hold(kPrimaryButton, 50);
  EXPECT_EQ(hand.state().tool, Tool::kMark);
  EXPECT_EQ(hand.state().stroke, 1U);
  EXPECT_EQ(hand.state().tool_choices, 4U);
  EXPECT_EQ(hand.state().tip_choices, 0U);
}

TEST(ButtonTools, ThirdAndFourthButtonChooseOncePerPressAndNotDuringAStroke) {
  ButtonHand hand;
  hand.hold(0, 5);
  hand.hold(kThirdButton, 300);
  hand.hold(kThirdButton | kFourthButton, 300);
  EXPECT_EQ(hand.state().tool_choices, 1U);
  EXPECT_EQ(hand.state().tip_choices, 1U);
  hand.hold(0, 5);
  hand.hold(kPrimaryButton, 20);
  hand.hold(kPrimaryButton | kThirdButton | kFourthButton, 20);
  hand.hold(kPrimaryButton, 20);
  EXPECT_EQ(hand.state().tool, Tool::kMark);
  EXPECT_EQ(hand.state().stroke, 1U);
  hand.hold(0, 5);
  EXPECT_EQ(hand.state().tool_choices, 1U);
  EXPECT_EQ(hand.state().tip_choices, 1U);
  hand.hold(kThirdButton, 5);
  EXPECT_EQ(hand.state().tool_choices, 2U);
}

TEST(ButtonTools, TheClutchPressedTwiceShortlyChoosesATip) {
  ButtonHand hand;
  const auto press = [&](int held_ms, int then_ms) {
    hand.hold(kSecondaryButton, held_ms);
    hand.hold(0, then_ms);
  };
  hand.hold(0, 5);
  press(100, 200);
  press(2000, 10);  // the second one may stay
  EXPECT_EQ(hand.state().tip_choices, 1U);
  press(100, 400);
  EXPECT_EQ(hand.state().tip_choices, 1U);  // the third one is the first of another pair, which came too late
  press(400, 100);
  press(400, 400);  // a hand that is moved on and on
  EXPECT_EQ(hand.state().tip_choices, 1U);
  press(100, 100);
  press(100, 100);
  press(100, 100);
  EXPECT_EQ(hand.state().tip_choices, 2U);  // three presses are one pair
  hand.hold(0, 400);
  // A tool that is chosen under it makes a press no first one.
  hand.hold(kSecondaryButton, 20);
  hand.hold(kClutched, 20);
  hand.hold(0, 20);
  press(20, 400);
  EXPECT_EQ(hand.state().tip_choices, 2U);
  EXPECT_EQ(hand.state().tool_choices, 1U);
  // During a stroke, neither.
  hand.hold(kPrimaryButton, 20);
  for (int i = 0; i < 2; ++i) {
    hand.hold(kClutched, 50);
    hand.hold(kPrimaryButton, 50);
  }
  EXPECT_EQ(hand.state().tip_choices, 2U);
  EXPECT_EQ(hand.state().tool_choices, 1U);
  EXPECT_EQ(hand.state().tool, Tool::kMark);
}

TEST(ButtonTools, AButtonThatIsHeldWhenTheDeviceConnectsWasNotPressed) {
  ButtonHand hand;
  hand.hold(kThirdButton, 5);
  EXPECT_EQ(hand.state().tool_choices, 0U);
  hand.hold(0, 5);
  hand.hold(kThirdButton, 5);
  EXPECT_EQ(hand.state().tool_choices, 1U);
  hand.setLink(LinkState::kDisconnected);
  hand.hold(0, 5);
  hand.setLink(LinkState::kConnected);
  hand.hold(kThirdButton | kFourthButton, 5);
  EXPECT_EQ(hand.state().tool_choices, 1U);
  EXPECT_EQ(hand.state().tip_choices, 0U);
}

TEST(ButtonTools, AToolThatComesAfterTheButtonActsAtOnceWhereNothingWasChanged) {
  ButtonHand hand;
  hand.choose(Tool::kFeel);
  hand.hold(0, 5);
  hand.hold(kPrimaryButton, 20);
  EXPECT_EQ(hand.state().stroke, 0U);
  hand.choose(Tool::kMark);
  hand.hold(kPrimaryButton, 1);
  EXPECT_EQ(hand.state().tool, Tool::kMark);
  EXPECT_EQ(hand.state().stroke, 1U);
}

TEST(ButtonTools, AToolThatComesDuringAStrokeEndsItAndBeginsAnother) {
  ButtonHand hand;
  hand.hold(0, 5);
  hand.hold(kPrimaryButton, 20);
  const std::vector<std::uint64_t> before = hand.endedStrokes();
  hand.choose(Tool::kUnmark);
  hand.hold(kPrimaryButton, 20);
  EXPECT_EQ(before, std::vector<std::uint64_t>{});
  EXPECT_EQ(hand.endedStrokes(), std::vector<std::uint64_t>{1U});  // before the other tool touched anything
  EXPECT_EQ(hand.toolOfEnded(), Tool::kMark);
  EXPECT_EQ(hand.state().tool, Tool::kUnmark);
  EXPECT_EQ(hand.state().stroke, 2U);
  // The tool that is in effect already begins no other stroke.
  hand.choose(Tool::kUnmark);
  hand.hold(kPrimaryButton, 20);
  EXPECT_EQ(hand.state().stroke, 2U);
  // One that is chosen while a stroke ends does not change whose it was.
  hand.choose(Tool::kMark);
  hand.hold(0, 5);
  EXPECT_EQ(hand.endedStrokes(), std::vector<std::uint64_t>{2U});
  EXPECT_EQ(hand.toolOfEnded(), Tool::kUnmark);
}

}  // namespace
}  // namespace fettle::haptic
