#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "haptic/devices/device.h"
#include "haptic/devices/latest_slot.h"

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
};

/// The mouse as a stylus without force: the cursor's point on the surface gives x and y, holding the button
/// presses the tip in, the wheel sets how deep. Its positions are field coordinates.
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

  enum class Button : std::uint8_t { kReleased, kHeld };

  /// Window thread: the cursor points at this place of the surface [mm, field coordinates; z its height].
  /// Non- finite: as leave().
  void setCursor(const glm::dvec3& surface_mm) noexcept;
  /// Window thread: the cursor points at no place of the surface; the tip lifts where it is.
  void leave() noexcept;
  void setButton(Button button) noexcept;
  /// Window thread: wheel steps, up = less deep.
  void wheel(double steps) noexcept;
  /// Window thread: depth the button presses to now [mm].
  [[nodiscard]] double pressMm() const noexcept { return wish_.press_mm; }

  /// read() at a time given by the caller [ns]; read() takes the steady clock. For tests.
  [[nodiscard]] DeviceInput readAt(std::int64_t now_ns) noexcept;

 private:
  struct Wish {
    glm::dvec3 surface_mm{0.0};
    double press_mm = 0.0;
    bool over = false;
    bool held = false;
  };

  const MouseFeel feel_;
  DeviceProfile profile_;
  LatestSlot<Wish> slot_;  // window to loop
  Wish wish_;              // the window's own

  // The loop's own.
  DeviceInput input_;
  glm::dvec3 target_{0.0};
  std::int64_t last_read_ns_ = 0;
  bool placed_ = false;
};

}  // namespace fettle::haptic
