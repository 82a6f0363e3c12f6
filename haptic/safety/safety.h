#pragma once

#include <cstdint>
#include <string_view>

#include <glm/vec3.hpp>

#include "haptic/devices/device.h"
#include "haptic/safety/safety_limits.h"

namespace fettle::haptic {

/// State of the guard.
///
///      link up                 arm()              small command         ceiling at peak
///  Disconnected --> Uncalibrated --> Armed -------------------> Ramping ---------------> Active
///       ^               ^   disarm()   |                         ^  |   gap, disturbance   |
///       |               +--------------+-------------------------+--+----------------------+
///       |                                                           |
///       |                                                           | 50 ms without good input, loop stopped,
///       |                                                           | unplugged while armed, last resort
///       |                                                           v
///       +-- link lost (was not armed)                             Fault -- arm() --> Armed
enum class SafetyState : std::uint8_t {
  kDisconnected,  ///< no device: 0 N
  kUncalibrated,  ///< not calibrated, or not armed yet: 0 N
  kArmed,         ///< 0 N until the commanded force is small: a tip deep inside at arming must first come out
  kRamping,       ///< the largest allowed force grows to the peak
  kActive,        ///< the commanded force, within limits
  kFault,         ///< 0 N, latched until arm()
};

enum class FaultCause : std::uint8_t {
  kNone,
  kInputLost,      ///< no good input for SafetyLimits::fault_s
  kLoopStopped,    ///< the loop itself did not run for that long (debugger, suspend)
  kUnplugged,      ///< the device was unplugged while armed
  kOutputStalled,  ///< the device has not taken a report for SafetyLimits::fault_s
  kLastResort,     ///< the program is being ended by a signal
};

/// "disconnected", "uncalibrated", "armed", "ramping", "active", "fault".
[[nodiscard]] std::string_view name(SafetyState state) noexcept;
/// "", "input lost", "loop stopped", "unplugged", "output stalled", "ended by a signal".
[[nodiscard]] std::string_view name(FaultCause cause) noexcept;

/// Whether something other than the hand changed the force since the last tick: an adopted version, undo,
/// another scene, tool or mapping. Only then may the commanded force jump although the hand is at rest, and
/// the guard ramps the rise.
enum class Disturbance : std::uint8_t { kNone, kSurfaceReplaced };

/// Input of the guard in one tick. Any value is allowed for any number, NaN included.
struct SafetyInput {
  double dt_s = 0.0;         ///< since the previous tick, as measured [s]
  double input_age_s = 0.0;  ///< since the newest input arrived [s]; a future arrival is age 0
  LinkState link = LinkState::kDisconnected;
  glm::dvec3 command_n{0.0};          ///< force computed by the scene [N]
  glm::dvec3 velocity_mm_per_s{0.0};  ///< of the tip
  Disturbance disturbance = Disturbance::kNone;
  double output_waits_s = 0.0;  ///< time for which the report being written has waited for the device [s]
  /// Part of the command that exists with the hand at rest in free space (the stylus' weight) [N]: arming
  /// waits for the rest of it to be small.
  glm::dvec3 at_rest_n{0.0};
  /// The last step's force has not been sent and the device holds an older one.
  bool output_pending = false;
};

/// Counters of everything the guard did. Plain numbers, used by the ticking thread only.
struct SafetyCounters {
  std::int64_t ticks = 0;
  std::int64_t not_finite = 0;       ///< command or velocity with a NaN or infinity: treated as zero force
  std::int64_t bad_time = 0;         ///< dt or age not finite, dt not positive
  std::int64_t clamped = 0;          ///< |command| above the peak
  std::int64_t ceiling_held = 0;     ///< |command| above the ramp's ceiling
  std::int64_t slewed = 0;           ///< change held to the slew limit
  std::int64_t behind = 0;           ///< rise held back until the device has the force before
  std::int64_t over_speed = 0;       ///< tip faster than the limit
  std::int64_t jumps = 0;            ///< tip faster than a hand can be: ramped
  std::int64_t motor_scaled = 0;     ///< factor below 1
  std::int64_t bad_motor_scale = 0;  ///< factor not in 0 .. 1: zero
  std::int64_t thermal = 0;          ///< limited below the peak by the motors' warmth
  std::int64_t disturbances = 0;     ///< surface replaced
  std::int64_t disturbances_ramped =
      0;                      ///< of these, those that would have raised the force by more than small
  std::int64_t silences = 0;  ///< gaps of 10 ms and more
  std::int64_t faults = 0;
  std::int64_t arms_refused = 0;  ///< arm() without a ready device with fresh input

  friend bool operator==(const SafetyCounters&, const SafetyCounters&) = default;
};

/// The last stage before the device: a state machine that turns any sequence of commanded forces into one
/// that the device's profile allows. Each step, in this order:
///
///   state (link, age, dt) --> non-finite check --> |F| clamp (peak, ramp ceiling) --> slew --> velocity
///   limit with damping --> motors' scale --> thermal I2t --> |F| and slew once more, over what the three
///   added
///
/// Promises, whatever the input:
///   - the output is finite and |F| <= peak_force_n * (1 + 1e-12);
///   - it changes by at most slew * min(dt, 2 ms) per step, so a late tick causes no jump; a force that fades
///   to
///     zero (fault, silence, bad command) may use the whole dt, and a lost link is zero at once;
///   - it rises by at most slew * 2 ms above what the device holds, however many steps the device has missed:
///     a report that was delayed, by the machine or by a device that answers in lock-step, causes no jump;
///   - a device that has not taken a report for 50 ms is a Fault as well: its own watchdog may have removed
///     the force meanwhile, and the next report must not apply the present force immediately;
///   - without good input for 10 ms it falls to zero, which takes at most peak / slew; after 50 ms
///     the state is Fault and stays so until arm(); a disarm() does not clear it;
///   - in Disconnected, Uncalibrated, Armed and Fault only such a fade is applied;
///   - a rise that the hand did not cause (Disturbance, a jump of the pose, return from a silence) increases
///     by at most peak * dt / ramp_s per step, after a first step of at most small_force_n.
///
/// The motors' warmth q follows dq/dt = (F^2 - q) / tau (first-order I2t; the windings' loss goes with the
/// square of current, and current with force). Below 80 % of continuous^2 there is no limit; above it the
/// limit falls from peak to continuous at q = continuous^2, where |F| <= continuous keeps q where it is: so q
/// never passes it.
///
/// Sources: bumpless transfer by a rate-limited ceiling, Astrom and Hagglund, "Advanced PID Control" (2006),
/// section 3.5; I2t as in IEC 60034-1 thermal classes; the "wait for a small force" rule is common practice
/// of haptic frameworks.
///
/// Threading: one thread. Every method is noexcept, wait-free, allocates nothing and calls only the
/// MotorScale.
class ForceGuard {
 public:
  /// `limits` in range (limitsProblem); asserted.
  explicit ForceGuard(const SafetyLimits& limits) noexcept;

  /// One tick: the force to send to the device [N].
  [[nodiscard]] glm::dvec3 step(const SafetyInput& input) noexcept;

  /// The user allows force; takes effect with the next step: from Uncalibrated or Fault to Armed, if the
  /// device is ready and its input fresh (else counted as refused). Without effect while armed.
  void arm() noexcept { arm_requested_ = true; }
  /// To Uncalibrated; the force fades within peak / slew. A Fault stays a Fault.
  void disarm() noexcept;
  /// A fatal signal arrived: Fault from the next step on.
  void lastResort() noexcept { fault_requested_ = true; }

  [[nodiscard]] SafetyState state() const noexcept { return state_; }
  /// Cause of the last Fault; kNone before the first and after arm().
  [[nodiscard]] FaultCause cause() const noexcept { return cause_; }
  [[nodiscard]] const SafetyCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] const SafetyLimits& limits() const noexcept { return limits_; }
  [[nodiscard]] const glm::dvec3& force() const noexcept { return output_; }
  /// Warmth of the motors, 0 cold .. 1 as warm as allowed.
  [[nodiscard]] double warmth() const noexcept;

 private:
  void advanceState(const SafetyInput& input, double dt_s, double age_s) noexcept;
  void fault(FaultCause cause) noexcept;
  void startRamp(double from_n) noexcept;
  void rampUnexpectedRise(const SafetyInput& input, double dt_s) noexcept;
  [[nodiscard]] bool armed() const noexcept;
  [[nodiscard]] glm::dvec3 limitSpeed(const glm::dvec3& force, const glm::dvec3& velocity) noexcept;
  [[nodiscard]] double motorFactor(const glm::dvec3& force) noexcept;
  [[nodiscard]] double thermalLimit() const noexcept;
  void noteHeld(const SafetyInput& input, double dt_s) noexcept;
  [[nodiscard]] glm::dvec3 limitRiseFromHeld(const glm::dvec3& force) noexcept;

  SafetyLimits limits_;
  SafetyState state_ = SafetyState::kDisconnected;
  FaultCause cause_ = FaultCause::kNone;
  SafetyCounters counters_;
  glm::dvec3 output_{0.0};
  glm::dvec3 slewed_{0.0};  // before the brake and the motors' factors, which must not add up over ticks
  glm::dvec3 held_{0.0};    // the last force known to have been sent
  double held_for_s_ = 0.0;
  double ceiling_n_ = 0.0;  // of the ramp; the peak when there is none
  double warmth_n2_ = 0.0;  // q
  double bad_for_s_ = 0.0;  // since the last good number
  bool silent_ = false;
  bool arm_requested_ = false;
  bool fault_requested_ = false;
};

}  // namespace fettle::haptic
