#pragma once

#include <string>

#include "engine/base/error.h"
#include "engine/field/grid.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

/// Reads a scene file to be felt on a field. Errors (kInput): those of haptic::loadScene, which name the line; a ball that is too
/// large for this field. Thread: any.
[[nodiscard]] engine::Result<haptic::Scene> readSceneFor(const std::string& path, const engine::Grid& grid);

/// Writes a scene file, whole or not at all, which readSceneFor() reads back to the very same scene. Errors: a scene out of range
/// (kInput); those of engine::writeFileAtomically. Thread: any.
[[nodiscard]] engine::Status writeScene(const std::string& path, const haptic::Scene& scene);

}  // namespace fettle::app
