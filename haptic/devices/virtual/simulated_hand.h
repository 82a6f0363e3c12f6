#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "haptic/devices/device.h"
#include "haptic/operator/hand_motion.h"

namespace fettle::haptic {

/// Target position of the hand, and its time.
struct HandTarget {
  double t = 0.0;  ///< [s], rising
  glm::dvec3 at_mm{0.0};
  Tool tool = Tool::kFeel;  ///< from here to the next target
};

/// A hand holding a stylus: a mass with a spring and a damper to its target, in each axis. The defaults are
/// of the order of a light grip, the moving parts of stylus and device included; they are not measurements of
/// a person.
struct HandSpec {
  double mass_kg = 0.15;                   ///< hand and moving device, > 0
  double stiffness_n_per_mm = 0.3;         ///< of hand to target, >= 0
  double damping_n_s_per_mm = 0.003;       ///< of hand to target, >= 0
  double device_damping_n_s_per_mm = 0.0;  ///< of the device to ground: the b of b > K T / 2, >= 0
  double tremor_mm = 0.0;                  ///< standard deviation per axis, 8 to 12 Hz, of the target, >= 0
  double resolution_mm = 0.0;              ///< position is read in steps of this size; 0 = exact
  double rate_hz = 1000.0;                 ///< each read() advances virtual time by one period, 100 .. 100000
  double max_force_n = 10.0;               ///< of its profile
  std::uint64_t seed = 1;                  ///< of the tremor
};

/// A simulated hand on an ideal force device, in closed loop, for tests and for users without hardware:
/// written forces move the hand, and read() returns its position. In field coordinates. Its profile states
/// what is stable with such a hand: a wall up to 2 b / T, b the sum of its dampings, 6 N/mm at 1 kHz with the
/// defaults.
///
/// Each read() after the first advances virtual time by 1 / rate_hz with the last written force held (the
/// zero-order hold of a real device), in substeps of at most 10 us (semi-implicit Euler: Hairer, Lubich and
/// Wanner, Geometric numerical integration, 2006, section I.1.2; its energy error stays bounded). No clock:
/// it runs faster than real time in a test and in step with any loop of the same rate. Deterministic by seed.
/// Loop thread only.
class SimulatedHand final : public Device {
 public:
  /// At least one target; before the first and after the last the target stays there. Starts at rest on the
  /// first. Asserts the ranges above.
  SimulatedHand(std::vector<HandTarget> path, const HandSpec& spec);

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] DeviceInput read() noexcept override;
  /// Non-finite: zero.
  void write(const glm::dvec3& force_n) noexcept override;
  /// Back to the start, at rest.
  [[nodiscard]] engine::Status start() override;
  void stop() noexcept override { force_ = glm::dvec3{0.0}; }

  /// Virtual time [s].
  [[nodiscard]] double seconds() const noexcept;
  [[nodiscard]] const glm::dvec3& positionMm() const noexcept { return x_; }
  [[nodiscard]] const glm::dvec3& velocityMmS() const noexcept { return v_; }
  /// Work the written forces did on the hand since start() [N mm = mJ]: above zero, the virtual surface
  /// returned more energy than was put in.
  [[nodiscard]] double workOnHandMj() const noexcept { return work_; }
  /// Whether the last target's time has passed.
  [[nodiscard]] bool finished() const noexcept { return seconds() >= path_.back().t; }

 private:
  struct Target {
    glm::dvec3 at{0.0};
    Tool tool = Tool::kFeel;
  };
  [[nodiscard]] Target targetAt(double t) noexcept;
  void advance() noexcept;

  std::vector<HandTarget> path_;
  HandSpec spec_;
  DeviceProfile profile_;
  std::array<HandMotion, 3> tremor_;
  int substeps_ = 1;
  double step_ = 0.0;  // [s]

  std::size_t leg_ = 0;  // index into path_ of the last target used
  std::uint64_t ticks_ = 0;
  bool read_once_ = false;
  glm::dvec3 x_{0.0};
  glm::dvec3 v_{0.0};
  glm::dvec3 target_{0.0};
  glm::dvec3 force_{0.0};
  double work_ = 0.0;
  DeviceInput input_;
};

}  // namespace fettle::haptic
