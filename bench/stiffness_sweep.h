#pragma once

#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::bench {

struct StiffnessSweepOptions {
  double damping_n_s_per_mm = 0.002;  ///< of the device to ground, b; 1e-5 .. 0.02
  double mass_kg = 0.2;               ///< of the moving parts, 0.01 .. 10
  double press_n = 2.0;               ///< held constant on the flat, 0.1 .. 100
  std::vector<double> rates_hz = {1000.0, 2000.0, 5000.0, 10000.0};  ///< each 100 .. 20000
};

struct StiffnessRow {
  double rate_hz = 0.0;
  double damping_n_s_per_mm = 0.0;
  double theory_n_per_mm = 0.0;    ///< 2 b / T
  double exact_n_per_mm = 0.0;     ///< of this mass as SimulatedHand moves it, see below
  double measured_n_per_mm = 0.0;  ///< largest without a growing oscillation, to 0.1 %
  double ratio = 0.0;              ///< measured / theory
};

/// The stiffness at which the felt wall becomes unstable, in closed loop: a SimulatedHand without a hand (no
/// stiffness or damping of its own; only the device's damping b) is pressed on a flat field by a constant
/// force and displaced by a hundredth of its depth; Tick::run gives the force, held for one period. By
/// bisection on the scene's stiffness: the largest amplitude in the last tenth of the time is compared with
/// that in the first.
///
/// Theory: passivity of a sampled wall needs b > K T / 2 (Colgate and Schenkel, "Passivity of a class of
/// sampled-data systems: application to haptic interfaces", 1994, 1997). In general that is sufficient only:
/// the damping of a hand helps. Here there is no other damping, and contact is never lost (because of the
/// press), so the loop is linear and its bound can be computed. A mass m that moves exactly under a held
/// force: det = 1 of its one-period map gives
///   K = b (1 - p) / (g - p T) = (2 b / T) (1 + b T / (6 m) + ...),   p = exp(-b T / m),  g = (m / b) (1 -
///   p),
/// so the condition is tight up to b T / (6 m), 0.2 % with the defaults at 1 kHz. SimulatedHand moves it in
/// substeps h of at most 10 us, semi-implicitly: its position is half a substep ahead, the delay of the hold
/// is shorter by that, and the bound is 1 / (1 - h / T) higher: 1 % at 1 kHz, 11 % at 10 kHz. exact_n_per_mm
/// is det = 1 of that map.
///
/// Errors: kInput for options out of range, kCancelled. Thread: any; blocks. Deterministic.
[[nodiscard]] engine::Result<std::vector<StiffnessRow>> stiffnessSweep(const StiffnessSweepOptions& options,
                                                                       engine::JobControl& job);

}  // namespace fettle::bench
