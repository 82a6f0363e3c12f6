#pragma once

#include <atomic>
#include <cstdint>

#include <glm/vec3.hpp>

#include "haptic/base/rings.h"
#include "haptic/devices/device.h"

namespace fettle::haptic {

/// How a mouse stands in for a stylus.
struct MouseFeel {
  double hover_mm = 1.0;        ///< height over the surface while not pressing, > 0
  double press_mm = 0.3;        ///< depth at first; the wheel changes it
  double wheel_step_mm = 0.05;  ///< depth a wheel step adds, > 0
  double deepest_mm = 3.0;      ///< of the depth the wheel reaches, > 0
  /// Time constant with which the tip follows the cursor and the depth [s], > 0: a window tells its cursor at
  /// 60 Hz, the loop runs at 1000.
  double follow_s = 0.020;
  /// The same where a stroke begins and ends, and nothing is smoothed [s], > 0: the way down and the last bit
  /// to the place where the button was let go.
  double land_s = 0.003;
};

/// All that the window wants of a MouseStylus at one time, so that a wish that is lost is made up for by the
/// next.
struct MouseWish {
  glm::dvec3 surface_mm{0.0};
  double press_mm = 0.0;
  Tool tool = Tool::kFeel;
  bool over = false;
  bool held = false;
};

/// The mouse as a stylus without force: the cursor's point on the surface gives x and y, holding the button
/// presses the tip in, the wheel sets how deep. Its positions are field coordinates.
///
/// A stroke is what the hand did, whatever the window's pace: what the window says goes through a ring, in
/// order, so that a press and its release between two ticks are a stroke all the same. A press lifts the tip
/// off (one input without a place: position NaN), puts it down where the button was pressed, follows the
/// cursor, and gives the button back where it was let go: no way to the place of the press, no missing end.
/// Off the surface the tip lifts while the button stays held.
///
/// Threading: the window's thread calls the cursor functions, the loop's read(), both wait-free.
class MouseStylus final : public Device {
 public:
  explicit MouseStylus(const MouseFeel& feel = {});

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const glm::dvec3&) noexcept override {}
  [[nodiscard]] engine::Status start() override { return {}; }
  void stop() noexcept override {}

  /// Window thread: the cursor points at this place of the surface [mm, field coordinates; z its height].
  /// Non-finite: as leave().
  void setCursor(const glm::dvec3& surface_mm) noexcept;
  /// Window thread: the cursor points at no place of the surface; the tip lifts where it is.
  void leave() noexcept;
  /// Window thread: the button goes down for a stroke with this tool; where the cursor is, or at the first
  /// place of the surface it comes to. The tool holds until the stroke's end.
  void press(Tool tool) noexcept;
  /// Window thread: the button goes up. Nothing when it is up.
  void release() noexcept;
  /// Window thread: wheel steps, up = less deep.
  void wheel(double steps) noexcept;
  /// Window thread: depth the button presses to now [mm].
  [[nodiscard]] double pressMm() const noexcept { return wish_.press_mm; }
  /// Window thread: whether the tip still has to do something that was said here; a stroke is done when its
  /// end is.
  [[nodiscard]] bool busy() const noexcept { return followed_.load(std::memory_order_acquire) != said_; }

  /// read() at a time given by the caller [ns]; read() takes the steady clock. For tests.
  [[nodiscard]] DeviceInput readAt(std::int64_t now_ns) noexcept;

 private:
  using Wish = MouseWish;
  enum class Stage : std::uint8_t {
    kHover,    // over the cursor
    kLifted,   // nowhere, for one input
    kLanding,  // straight down where the button was pressed
    kStroke,   // after the cursor
    kEnding,   // to where the button was let go
  };

  void tell() noexcept;
  void takeWishes() noexcept;
  [[nodiscard]] bool accept(const Wish& wish) noexcept;
  void move(double passed_s) noexcept;

  const MouseFeel feel_;
  DeviceProfile profile_;
  SpscRing<Wish> wishes_;  // window to loop
  // The window's own.
  Wish wish_;
  std::uint64_t said_ = 0;  // wishes

  // The loop's own.
  DeviceInput input_;
  Wish now_;   // followed
  Wish next_;  // popped, and too early for the stage
  bool has_next_ = false;
  Stage stage_ = Stage::kHover;
  glm::dvec3 tip_mm_{0.0};
  std::int64_t last_read_ns_ = 0;
  bool placed_ = false;
  std::uint64_t accepted_ = 0;              // wishes
  std::atomic<std::uint64_t> followed_{0};  // of said_, up to the end of the last stroke
};

}  // namespace fettle::haptic
