#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "render/live/live_picture.h"

namespace fettle::bench {

enum class Brush : std::uint8_t { kRests, kWorks };
enum class Camera : std::uint8_t {
  kOrbits,
  kFixed,
  kRests,  ///< turns when the picture has come to rest; the frame that follows is not counted
};
/// A stylus that moves: as lines, as a pen, with its shadow, with the trail of a second.
enum class Stylus : std::uint8_t { kNone, kLines, kPen, kPenAndShadow, kTrail };

/// One row of `fettle bench render`: what is shown, and what changes.
struct Scene {
  std::string name;
  render::Shown shown;
  render::FrameInput input;
  Camera camera = Camera::kOrbits;
  Brush brush = Brush::kRests;
  Stylus stylus = Stylus::kNone;
  std::optional<engine::Version> other = {};  ///< shown in turn with the field
};

/// The field of the scenes, 64 mm wide at any number of samples: a tilted plate with a boss, a groove, a dome and 5 um of noise.
/// `side`: 1 .. 32768 samples. Errors: memory.
[[nodiscard]] engine::Result<engine::Version> benchPart(std::int32_t side);

/// The yardstick of the others: the field from all sides, nothing else.
[[nodiscard]] Scene plainScene(const engine::Version& field, const render::FrameInput& plain);
enum class SceneSet : std::uint8_t {
  kFrames,  ///< what depends on the field's size
  kAll,     ///< and each effect alone
};
/// All scenes in the order of their rows, the plain one first; with half resolution in motion, those of a moving camera too.
/// Errors: memory, cancelled.
[[nodiscard]] engine::Result<std::vector<Scene>> renderScenes(const engine::Version& field,
                                                              const render::FrameInput& plain,
                                                              render::Sharpness in_motion, SceneSet set,
                                                              engine::JobControl& job);

/// The overlays of a stylus' frame, `way` 0 .. 1 of its way.
void putStylus(Stylus stylus, double way, render::Overlays& overlays);

}  // namespace fettle::bench
