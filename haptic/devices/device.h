#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "haptic/base/strokes.h"

namespace fettle::haptic {

/// Frame of a device's positions and forces, right-handed, millimetres and newtons.
enum class DeviceSpace : std::uint8_t {
  /// x to the user's right, y away from the user, z up; 0 in the middle of the workspace. A Workspace turns
  /// it into field coordinates.
  kDesk,
  /// Field coordinates already (mouse, replayed strokes, simulated hand): not mapped.
  kField,
};

/// Capabilities and limits of a device. The limits hold in the device's own millimetres. The defaults are for
/// an unknown device: low enough for any known one.
struct DeviceProfile {
  std::string name = "unknown device";
  std::string serial;  ///< of this one among its kind; empty: it states none, or it was not there to be asked
  DeviceSpace space = DeviceSpace::kDesk;
  double workspace_radius_mm = 50.0;      ///< > 0; of the ball about the origin that is reached everywhere
  double max_force_n = 3.0;               ///< >= 0
  double max_stiffness_n_per_mm = 0.4;    ///< >= 0; as felt, see Workspace
  double max_damping_n_s_per_mm = 0.004;  ///< >= 0
  double resolution_mm = 0.0;             ///< of the position at the origin, coarsest axis; 0 = not stated
  double rate_hz = 1000.0;                ///< inputs per second at most
  bool gives_force = false;               ///< false: write() is a no-op
};

enum class LinkState : std::uint8_t {
  kDisconnected,  ///< not plugged in, or unplugged; the driver searches for it in the background
  kUncalibrated,  ///< reports arrive, but the position of the stylus is not known yet: it is not valid, and
                  ///< the driver itself sends zero force whatever is written
  kConnected,
};

/// Buttons of DeviceInput::buttons.
inline constexpr std::uint32_t kPrimaryButton = 1U << 0U;
inline constexpr std::uint32_t kSecondaryButton = 1U << 1U;

/// The newest input of a device.
struct DeviceInput {
  /// In the frame of the profile. Finite from the drivers of hardware; a replayed stroke returns the NaN of a
  /// recorded dropout, and a mouse returns NaN where a stylus would be lifted off. Held while disconnected.
  glm::dvec3 position_mm{0.0};
  std::uint32_t buttons = 0;  ///< bit mask of the buttons held
  /// Incremented for each input; never decreases. Unchanged: nothing new arrived. A change of `link` alone
  /// does not count as an input.
  std::uint64_t sequence = 0;
  std::int64_t arrival_ns = 0;  ///< engine::steadyNs() when it arrived at this machine
  LinkState link = LinkState::kDisconnected;
  /// Time for which the report being written has waited for the device [ns]; 0 = nothing waits. Above some ms
  /// the device does not apply the forces of the loop.
  std::int64_t output_waits_ns = 0;
  /// The force written last has not reached the device, which still applies an older one.
  bool output_pending = false;
  /// How the stylus is held, of length 1, in the frame of the profile: its z runs from the tip along the stylus to the hand.
  /// Nothing where the device does not measure it.
  std::optional<glm::dquat> orientation{};
  std::optional<Tool> tool{};  ///< set by devices that choose the tool themselves (a replayed stroke)

  friend bool operator==(const DeviceInput&, const DeviceInput&) = default;
};

/// Counters of events since start(), for the user's panel and for tests.
struct DeviceCounters {
  std::uint64_t inputs = 0;          ///< good reports, those skipped for a newer one included
  std::uint64_t skipped = 0;         ///< good reports replaced by a newer one before they were published
  std::uint64_t bad_inputs = 0;      ///< reports of a wrong length or form, left out
  std::uint64_t outputs = 0;         ///< reports accepted by the device
  std::uint64_t forced_zeros = 0;    ///< outputs that were zero because no new force was written in time
  std::uint64_t failed_outputs = 0;  ///< writes that failed (stalled, unplugged)
  std::uint64_t scaled_forces = 0;   ///< forces scaled down, direction kept, to protect a motor
  std::uint64_t faults = 0;          ///< inputs in which the device itself reported a fault
  std::uint64_t lost_inputs = 0;  ///< gaps in the device's own numbering of its reports, if it numbers them
  std::uint64_t connects = 0;     ///< times the device was opened
  std::uint64_t disconnects = 0;  ///< times it was lost
  std::int64_t longest_output_ns = 0;  ///< longest single write; 5 s when the device stops taking reports
};

/// What the tip meets in a tick: for a device that shows it otherwise than by a force.
struct Touched {
  bool contact = false;
  glm::dvec3 proxy_mm{0.0};  ///< field coordinates; of a tick with contact
  glm::dvec3 force_n{0.0};   ///< the scene's, field frame
  double strength = 0.0;     ///< 0 .. 1 of the scene's largest force; 0 while the device is disarmed
  std::int64_t when_ns = 0;  ///< engine::steadyNs() of the tick
};

/// One haptic or input device.
///
/// Life: construct, start(), any number of read()/write(), stop(); start() may follow again. The destructor
/// stops.
/// Threading: one loop thread calls read(), write() and show(); one other thread owns start(), stop() and calibrate()
/// (the loop thread must not be running yet at start() nor still at stop()); counters() from any thread;
/// profile() from any thread, constant between start() and stop().
class Device {
 public:
  virtual ~Device() = default;
  Device& operator=(Device&&) = delete;

  [[nodiscard]] virtual const DeviceProfile& profile() const noexcept = 0;

  /// The newest input. Wait-free: no lock, no allocation, no I/O, whatever the hardware does.
  [[nodiscard]] virtual DeviceInput read() noexcept = 0;

  /// The force to apply from now on [N], in the frame of the profile; the newest replaces older ones that
  /// were not sent yet. Wait-free like read(): at most one futex wake of the writer thread. A non-finite
  /// force counts as zero. The driver keeps motors within their limits by scaling all of them by one factor,
  /// but the caller clamps to max_force_n: only the safety stage clamps. A force that is not renewed for 10
  /// ms is replaced by zero.
  virtual void write(const glm::dvec3& force_n) noexcept = 0;

  /// What the tick met, after each write(). Wait-free like read().
  virtual void show(const Touched&) noexcept {}

  /// Allocates, starts threads. A device that is not plugged in is no error: its link stays kDisconnected
  /// until it is plugged in. Errors: kFailed when threads or system libraries are not available.
  [[nodiscard]] virtual engine::Status start() = 0;

  /// Sends an explicit zero force to a device that gives force, then ends the threads. Takes some
  /// milliseconds; up to 5 s (the kernel's limit of one write) when the device has stopped taking reports.
  virtual void stop() noexcept = 0;

  /// The user holds the stylus in its home pose now. Takes effect within some reports, seen as kConnected.
  /// No effect on devices that need no calibration.
  virtual void calibrate() noexcept {}

  [[nodiscard]] virtual DeviceCounters counters() const noexcept { return {}; }
};

}  // namespace fettle::haptic
