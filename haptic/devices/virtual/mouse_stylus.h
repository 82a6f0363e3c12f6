#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "haptic/base/rings.h"
#include "haptic/devices/device.h"

namespace fettle::haptic {

/// How a mouse simulates a stylus.
struct MouseFeel {
  double hover_mm = 1.0;        ///< height over the surface while not pressing, > 0
  double press_mm = 0.3;        ///< depth at first; the wheel changes it
  double wheel_step_mm = 0.05;  ///< depth a wheel step adds, > 0
  double deepest_mm = 3.0;      ///< largest depth that the wheel reaches, > 0
  /// Time constant with which the tip follows the cursor and the depth [s], > 0: a window reports its cursor
  /// at 60 Hz, the loop runs at 1000.
  double follow_s = 0.020;
  /// The same where a stroke begins and ends, and nothing is smoothed [s], > 0: the movement down and the
  /// last movement to the place where the button was released.
  double land_s = 0.003;
};

/// The complete state that the window requests of a MouseStylus at one time, so that a lost request is
/// replaced by the next.
struct MouseRequest {
  glm::dvec3 surface_mm{0.0};
  double press_mm = 0.0;
  Tool tool = Tool::kFeel;
  bool over = false;
  bool held = false;
  std::optional<glm::dquat> orientation{};  ///< as DeviceInput::orientation
};

/// How a pen is held that moves in the mouse's place.
struct PenHold {
  double share = 1.0;  ///< of the depth the button presses to, 0 .. 1
  /// Field coordinates: the direction from the tip to the hand, of length 1; nothing where it is not measured.
  std::optional<glm::dvec3> to_hand;
};

/// The mouse as a stylus without force: the cursor's point on the surface gives x and y, holding the button
/// presses the tip in, the wheel sets how deep. Its positions are field coordinates.
///
/// A stroke is what the user did, whatever the window's frame rate: requests of the window go through a ring,
/// in order, so that a press and its release between two ticks are still a stroke. A press lifts the tip off
/// (one input without a position: NaN), puts it down where the button was pressed, follows the cursor, and
/// ends the stroke where the button was released: no movement to the place of the press, no missing end.
/// Outside the surface the tip lifts while the button stays held.
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
  /// place of the surface it comes to. The tool stays until the stroke's end.
  void press(Tool tool) noexcept;
  /// Window thread: the button goes up. Nothing when it is up.
  void release() noexcept;
  /// Window thread: wheel steps, up = less deep.
  void wheel(double steps) noexcept;
  /// Window thread: a pen is held so; without one, the button presses to the whole depth.
  void hold(const std::optional<PenHold>& pen) noexcept;
  /// Window thread: depth the button, or the whole pressure of a pen, presses to now [mm].
  [[nodiscard]] double pressMm() const noexcept { return depth_mm_; }
  /// The largest of these [mm].
  [[nodiscard]] double deepestMm() const noexcept { return feel_.deepest_mm; }
  /// Window thread: whether a request sent here is not completed yet; a stroke is completed with its end, the cursor's place
  /// when the tip is over it.
  [[nodiscard]] bool busy() const noexcept { return followed_.load(std::memory_order_acquire) != sent_; }

  /// read() at a time given by the caller [ns]; read() takes the steady clock. For tests.
  [[nodiscard]] DeviceInput readAt(std::int64_t now_ns) noexcept;

 private:
  using Request = MouseRequest;
  enum class Stage : std::uint8_t {
    kHover,    // over the cursor
    kLifted,   // no position, for one input
    kLanding,  // straight down where the button was pressed
    kStroke,   // follows the cursor
    kEnding,   // to where the button was released
  };

  void send() noexcept;
  void takeRequests() noexcept;
  [[nodiscard]] bool accept(const Request& request) noexcept;
  void move(double passed_s) noexcept;
  [[nodiscard]] bool isThere() const noexcept;  // over the cursor's place, if that is over the surface

  const MouseFeel feel_;
  DeviceProfile profile_;
  SpscRing<Request> requests_;  // window to loop
  // Used by the window's thread only.
  Request request_;
  double depth_mm_ = 0.0;
  double share_ = 1.0;      // of it
  std::uint64_t sent_ = 0;  // requests

  // Used by the loop's thread only.
  DeviceInput input_;
  Request now_;   // followed
  Request next_;  // popped, and not allowed in this stage yet
  bool has_next_ = false;
  Stage stage_ = Stage::kHover;
  glm::dvec3 tip_mm_{0.0};
  std::int64_t last_read_ns_ = 0;
  bool placed_ = false;
  std::uint64_t accepted_ = 0;              // requests
  std::atomic<std::uint64_t> followed_{0};  // of sent_, up to the end of the last stroke
};

}  // namespace fettle::haptic
