#pragma once

#include <cmath>

#include "haptic/scene/scene.h"
#include "tests/haptic/support/fields.h"

namespace fettle::tests {

/// A small part with steps, noise and holes.
inline engine::Version roughPart() {
  std::mt19937_64 random(42);
  return fieldOf(
      230, 180,
      [&](int c, int r) {
        if ((c / 60 + r / 50) % 5 == 4 && (c + r) % 7 == 0) return std::nan("");
        return 0.4 * ((c / 30) % 2) + 0.02 * uniform(random, -1.0, 1.0);
      },
      0.1, 0.12);
}

/// Brushes that a person sees.
inline haptic::Scene brushScene() {
  haptic::Scene scene;
  scene.brush_radius_samples = 4.0;
  scene.mark_radius_samples = 2.0;
  return scene;
}

}  // namespace fettle::tests
