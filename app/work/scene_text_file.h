#pragma once

#include <string>

#include "engine/base/error.h"
#include "engine/field/grid.h"
#include "engine/io/files/atomic_file.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

/// Reads a scene file to be felt on a field. Errors (kInput): those of haptic::loadScene, which name the line; a ball that is too
/// large for this field. Thread: any.
[[nodiscard]] engine::Result<haptic::Scene> readSceneFor(const std::string& path, const engine::Grid& grid);

/// Writes a scene file, whole or not at all, which readSceneFor() reads back to the very same scene. Errors: a scene out of range
/// (kInput); those of engine::writeFileAtomically. Thread: any.
[[nodiscard]] engine::Status writeScene(const std::string& path, const haptic::Scene& scene);
/// The same, to be put in place by AtomicFile::commit(): what lies there stays until then.
[[nodiscard]] engine::Result<engine::AtomicFile> prepareScene(const std::string& path,
                                                              const haptic::Scene& scene);

/// Whether a file holds this scene as writeScene() writes it, without a comment or another order of somebody's. Thread: any.
[[nodiscard]] bool isAsWritten(const std::string& path, const haptic::Scene& scene);

/// Where the scene of a recording lies beside its strokes: `a.csv.scene.toml` of `a.csv`, so that it is that of no other recording.
[[nodiscard]] std::string sceneBeside(const std::string& strokes);

}  // namespace fettle::app
