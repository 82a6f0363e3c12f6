#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/field/live_field.h"
#include "haptic/tick/tick.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic::tests {

using fettle::tests::fieldOf;
using fettle::tests::uniform;

/// A scene of some effects: 1 N/mm, 8 N.
inline Scene sceneOf(std::vector<EffectKind> effects) {
  Scene scene;
  scene.effects = std::move(effects);
  return scene;
}

/// 40 x 40 samples at height 0.
inline const engine::Version& flat() {
  static const engine::Version field = fieldOf(40, 40, [](int, int) { return 0.0; });
  return field;
}

/// A scene, a field, a tick and a clock.
struct Touch {
  Touch(const engine::Version& start, const Scene& settings, double rate_hz = 1000.0)
      : scene(settings),
        period_s(1.0 / rate_hz),
        field(start, engine::Growth::kAllowed),
        tick(scene, field, start) {}

  /// The force of the next tick [N].
  ForceSample at(const glm::dvec3& tip_mm, Tool tool = Tool::kFeel) {
    t_s += period_s;
    return tick.run({t_s, tip_mm, tool});
  }

  Scene scene;
  double period_s;
  double t_s = 0.0;
  engine::LiveField field;
  Tick tick;
};

/// A mass on a device with damping, on what is felt through a tick, the force held from tick to tick; exact
/// between them (the closed form of m x'' = F - b x'). The reference twin of SimulatedHand without a hand.
struct HeldMass {
  double mass_kg = 0.1;
  double damping_n_s_per_mm = 0.0;
  glm::dvec3 x_mm{0.0};
  glm::dvec3 v_mm_s{0.0};

  void advance(const glm::dvec3& force_n, double period_s) {
    const double m = mass_kg * 1e-3;  // N s^2/mm
    const double b = damping_n_s_per_mm;
    if (b == 0.0) {
      x_mm += v_mm_s * period_s + force_n * (period_s * period_s / (2.0 * m));
      v_mm_s += force_n * (period_s / m);
      return;
    }
    const double left = std::exp(-b * period_s / m);
    const double way = m / b * (1.0 - left);
    x_mm += v_mm_s * way + force_n * ((period_s - way) / b);
    v_mm_s = v_mm_s * left + force_n * ((1.0 - left) / b);
  }
  [[nodiscard]] double kineticMj() const {
    return 0.5e-3 * mass_kg * (v_mm_s.x * v_mm_s.x + v_mm_s.y * v_mm_s.y + v_mm_s.z * v_mm_s.z);
  }
};

}  // namespace fettle::haptic::tests
