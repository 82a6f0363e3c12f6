#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "haptic/base/latest_slot.h"
#include "haptic/devices/device.h"
#include "haptic/devices/virtual/mouse_stylus.h"

namespace fettle::haptic {

/// A headset whose last frame is older than this has stopped to make them: its hands let go. Not earlier: a runtime that draws on a
/// busy processor leaves some tenths of a second between two frames.
inline constexpr std::chrono::seconds kFramesStayAway{2};

/// The hand with the tip, as one frame of a headset has it; field coordinates.
struct ControllerHand {
  bool tip = false;  ///< false: no hand may be the tip: it points at panels, holds the field, or is not seen
  bool pressed = false;  ///< its trigger
  /// Which press it is, counted: another number with each press, each change of hand and each jump of its coordinates, over which
  /// nothing may be drawn.
  std::uint64_t press = 0;
  std::uint64_t reader = 0;  ///< of whose field the coordinates are: ControllerLink::reader
  std::int64_t when_ns = 0;  ///< engine::steadyNs() when it was read
  glm::dvec3 position_mm{0.0};
  glm::dquat orientation{1.0, 0.0, 0.0, 0.0};  ///< as DeviceInput::orientation
};

/// Between the thread of a headset and the loop; neither waits for the other. It outlives loops and devices, which end and begin
/// with each document, while the headset's thread goes on.
struct ControllerLink {
  LatestSlot<ControllerHand> hand;  ///< headset's thread to loop
  LatestSlot<Touched> touched;      ///< loop to headset's thread: what the hand meets while it is the tip
  /// Whether the hand is the tip. Relaxed everywhere: it stands for itself.
  std::atomic<bool> leads{false};
  /// Counts the devices on the link, each with its field: the newest reads hands with its own number alone. Relaxed, as above:
  /// the field itself goes another way to the headset's thread, which is given the number with it.
  std::atomic<std::uint64_t> reader{0};
  /// Whether a question is on the window's screen: a trigger does nothing then. Relaxed, as above.
  std::atomic<bool> asked{false};
};

/// The mouse, and in its place a headset's controller: from the first press of a trigger over the field until the mouse draws
/// a stroke. A stroke has one hand: what the other presses meanwhile begins none. Where one takes over, the tip lifts off for
/// one input (NaN), so that nothing is drawn on the way from one to the other.
///
/// A press gives one stroke: one that was held when the hand stopped to lead, when a question was asked, or before this
/// device was there, gives none until the trigger is pressed again.
///
/// Poses come with the headset's frames, the tip moves with the loop's ticks: it follows with a time constant. Where the hand
/// or its coordinates are others (ControllerHand::press), it is lifted for one input and goes on there. Frames that stay away for
/// two seconds lift it.
///
/// Threading: as MouseStylus; the headset's thread uses the link alone.
class ControllerStylus final : public Device {
 public:
  ControllerStylus(const MouseFeel& feel, std::shared_ptr<ControllerLink> link);

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const glm::dvec3&) noexcept override {}
  void show(const Touched& touched) noexcept override;
  [[nodiscard]] engine::Status start() override { return {}; }
  /// Nothing is touched, and no hand is the tip, from here on.
  void stop() noexcept override;

  [[nodiscard]] MouseStylus& mouse() noexcept { return mouse_; }

  /// read() at a time given by the caller [ns]; read() takes the steady clock. For tests.
  [[nodiscard]] DeviceInput readAt(std::int64_t now_ns) noexcept;

 private:
  void lead(bool leads) noexcept;
  [[nodiscard]] DeviceInput numbered(DeviceInput input) noexcept;

  MouseStylus mouse_;
  std::shared_ptr<ControllerLink> link_;
  DeviceProfile profile_;
  // Used by the loop's thread only.
  bool chosen_ = false;  // over the mouse
  bool leads_ = false;
  std::uint64_t number_;     // of this device on the link
  std::uint64_t press_ = 0;  // that it follows
  // The one that gives no stroke any more; nothing: that of the next read.
  std::optional<std::uint64_t> spent_press_;
  std::optional<glm::dvec3> tip_mm_;  // nothing: not placed yet
  std::int64_t last_read_ns_ = 0;
  std::uint64_t sequence_ = 0, mouse_sequence_ = 0;
};

}  // namespace fettle::haptic
