#pragma once

#include <string>

#include "engine/field/grid.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

/// A scene with another tip, and what that is called.
struct ChosenTip {
  haptic::Scene scene;
  std::string name;
};

/// The next of the tips that are offered where contact is chosen (trials::contactChoices): the point, then balls from the
/// smallest, without those that are too large for the field, then the point again. Only the tip changes: a point has the
/// level that the scene has, with the rounds that level needs. Thread: any.
[[nodiscard]] ChosenTip nextTip(haptic::Scene scene, const engine::Grid& grid);

}  // namespace fettle::app
