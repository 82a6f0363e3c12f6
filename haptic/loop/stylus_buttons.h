#pragma once

#include <cstdint>
#include <optional>

#include "haptic/devices/device.h"

namespace fettle::haptic {

/// Buttons of DeviceInput::buttons besides the primary and the secondary one.
inline constexpr std::uint32_t kThirdButton = 1U << 2U;
inline constexpr std::uint32_t kFourthButton = 1U << 3U;

/// What the buttons of a device ask for, input by input.
///
///   button           while it is held                    when it is pressed
///   first            the tool works: a stroke            under a held clutch: the next tool
///   second, clutch   the tip stays, the hand is free     twice within some tenths of a second: the next tip
///   third                                                the next tool
///   fourth                                               the next tip
///   that of a menu   the first is no stroke              opens it, whatever else this button would do
///
/// A choice begins no stroke and ends none: the first button pressed under the clutch is no stroke until it has been
/// released, and during a stroke nothing is chosen. A button that is already held when the device connects was not
/// pressed. The loop counts choices; who shows the tools makes them.
///
/// Threading: loop; constant time.
class StylusButtons {
 public:
  /// Two presses of the clutch are one choice when the first is not longer and the second not later than this [ns].
  static constexpr std::int64_t kTwiceNs = 300'000'000;

  /// Which buttons hold the clutch and which open a menu: 0 where there is none. The clutch goes first.
  struct Duties {
    std::uint32_t clutch = kSecondaryButton;
    std::uint32_t menu = 0;
  };
  /// The newest input.
  void note(const DeviceInput& input, const Duties& duties, std::int64_t now_ns) noexcept {
    const std::uint32_t clutch_buttons = duties.clutch, menu_buttons = duties.menu & ~duties.clutch;
    if (input.link != LinkState::kConnected) {
      held_ = kUnseen;
      no_stroke_ = stroke_ = false;
      short_since_ns_ = short_until_ns_ = std::nullopt;
      return;
    }
    const std::uint32_t pressed = input.buttons & ~held_;
    const std::uint32_t released = held_ & ~input.buttons;
    const bool clutch = (input.buttons & clutch_buttons) != 0;
    held_ = input.buttons;
    if ((released & kPrimaryButton) != 0) no_stroke_ = false;
    if ((pressed & kPrimaryButton) != 0 && clutch) {
      no_stroke_ = true;
      ++tools_;
      short_since_ns_ = short_until_ns_ = std::nullopt;
    }
    if ((pressed & kPrimaryButton) != 0 && (input.buttons & menu_buttons) != 0) no_stroke_ = true;
    stroke_ = (input.buttons & kPrimaryButton) != 0 && !no_stroke_;
    if (!stroke_) {
      const std::uint32_t chosen = pressed & ~clutch_buttons & ~menu_buttons;
      tools_ += (chosen & kThirdButton) != 0 ? 1 : 0;
      tips_ += (chosen & kFourthButton) != 0 ? 1 : 0;
      menus_ += (pressed & menu_buttons) != 0 ? 1 : 0;
    }
    noteClutch(pressed & clutch_buttons, released & clutch_buttons, now_ns);
  }

  /// Whether the first button is held for a stroke.
  [[nodiscard]] bool stroke() const noexcept { return stroke_; }
  /// Choices of the next tool and of the next tip so far.
  [[nodiscard]] std::uint64_t tools() const noexcept { return tools_; }
  [[nodiscard]] std::uint64_t tips() const noexcept { return tips_; }
  /// How often a menu was asked for so far.
  [[nodiscard]] std::uint64_t menus() const noexcept { return menus_; }

 private:
  void noteClutch(std::uint32_t pressed, std::uint32_t released, std::int64_t now_ns) noexcept {
    if (pressed != 0) {
      const bool second = short_until_ns_ && now_ns <= *short_until_ns_;
      if (second && !stroke_) ++tips_;
      // A second press is no first one of another pair.
      short_since_ns_ = second || stroke_ ? std::nullopt : std::optional(now_ns);
      short_until_ns_ = std::nullopt;
    } else if (released != 0 && short_since_ns_) {
      if (now_ns - *short_since_ns_ <= kTwiceNs) short_until_ns_ = now_ns + kTwiceNs;
      short_since_ns_ = std::nullopt;
    }
  }

  std::uint64_t tools_ = 0;
  std::uint64_t tips_ = 0;
  std::uint64_t menus_ = 0;
  static constexpr std::uint32_t kUnseen = ~0U;  // none was seen released
  std::uint32_t held_ = kUnseen;
  bool no_stroke_ = false;  // the first button was pressed under the clutch or a menu
  bool stroke_ = false;
  std::optional<std::int64_t> short_since_ns_;  // press of the clutch that may be the first of two
  std::optional<std::int64_t> short_until_ns_;  // until when the second one may follow
};

}  // namespace fettle::haptic
