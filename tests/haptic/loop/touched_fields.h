#pragma once

#include <cmath>

#include <gtest/gtest.h>

#include "haptic/loop/loop_tick.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic::tests {

/// Samples along each side of the fields that a hand touches here, 1 mm apart.
inline constexpr int kSide = 300;

/// Waves of 0.3 mm.
inline engine::Version bumpy() {
  return fettle::tests::fieldOf(kSide, kSide,
                                [](int c, int r) { return 0.3 * std::sin(0.9 * c) * std::cos(0.7 * r); });
}

/// All of the usual scene, with brushes and marks of this radius [samples].
inline Scene sceneWithBrush(double radius) {
  Scene scene = defaultScene();
  scene.brush_radius_samples = radius;
  scene.mark_radius_samples = radius;
  return scene;
}

/// Tiles and nodes for all edits of a test: the thread of the loop takes none from the system.
inline void reserve(const engine::Version& version) {
  ASSERT_TRUE(version.memory()->tiles.reserve(3000));
  ASSERT_TRUE(version.memory()->nodes.reserve(300));
}

}  // namespace fettle::haptic::tests
