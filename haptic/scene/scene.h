#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "haptic/base/search_limits.h"
#include "haptic/base/tools.h"
#include "haptic/scene/effects.h"
#include "haptic/scene/falloff.h"

namespace fettle::haptic {

/// Shape of the stylus tip.
enum class TipShape : std::uint8_t {
  kPoint,   ///< a point: the seed paper's
  kSphere,  ///< a ball: sphere_tip.h
};

/// How the closest point of the surface is found.
/// For the point tip; a ball has one method, sphere_tip.h.
enum class ContactLevel : std::uint8_t {
  /// Bounded closest points, cell by cell from the previous proxy's (Potter, Johnson, Cohen 2004).
  kPaper,
  kDescent,    ///< down from the previous proxy itself: stops at more local minima, can be cut into steps
  kCertified,  ///< the true closest point of all cells within a radius, by branch and bound
};

/// "paper", "descent", "certified".
[[nodiscard]] std::string_view levelName(ContactLevel level) noexcept;

/// Largest Scene::brush_radius_samples and mark_radius_samples.
inline constexpr double kMaxBrushRadius = 64.0;
/// Largest Scene::brush_spacing.
inline constexpr double kMaxBrushSpacing = 2.0;

/// How a field is felt and edited: all that a tick depends on apart from the field and the input. Values, no
/// behaviour; a scene is composed into a tick once, when it is loaded.
struct Scene {
  TipShape tip = TipShape::kPoint;
  /// Ball's radius [mm]; the endpoint is its centre. > 0 .. 1e9, and at most 16 cells of the field that is
  /// touched (sphereProblem). Not used by a point.
  double tip_radius_mm = 0.1;

  ContactLevel level = ContactLevel::kPaper;
  /// Level certified: all cells whose horizontal distance to the endpoint is at most this many times the
  /// larger spacing are searched, so the result is the true closest point of the whole field whenever it is
  /// nearer than that. [cells], 1 .. 64. Also the radius when a replay measures level paper.
  int certified_radius_cells = 2;
  /// Level descent: rounds a search may take in one tick, 2 .. 2048; each evaluates a patch and takes a step,
  /// the last one only evaluates. With the largest number every search ends at rest. Fewer bound the tick's
  /// time and lag behind a fast hand. A ball takes one step fewer, and never more than kSphereSteps. At level paper a
  /// search has no such rounds: only 2048 is allowed there for a point.
  int search_rounds = 2048;
  /// A ball: searches for contacts after which a tick takes no further step, so that the tick's time is bounded; from 1
  /// to 4096, or 0 for no bound, as before contact revision 3 (SphereTracker).
  int ball_searches = kBallSearches;
  /// A ball: steep cells that its searches in a tick may look at in plan, after which it takes no further step, so that the time
  /// among needles is bounded; from 1 to 1,000,000, or 0 for no bound, as before contact revision 5 (SphereTracker).
  int ball_work = kBallWork;
  /// A ball: which minima it searches for inside cells.
  BallMinima ball_minima = BallMinima::kAll;
  /// A ball: in which direction a step has a largest length.
  BallSteps ball_steps = BallSteps::kInPlan;

  /// Spring: newtons per millimetre of penetration. > 0 .. 1e9; a hand device holds about 1 to 3 times its scale.
  double stiffness_n_per_mm = 1.0;
  /// Largest force [N], and what counts as full strength for smoothing. > 0 .. 1000; devices: 3 to 20.
  double force_limit_n = 8.0;

  /// Smoothing replaces all samples within this distance of the brush's centre, which is the lower-left
  /// sample of the proxy's cell. [samples], 0 .. 64; 0 is the paper's one sample.
  double brush_radius_samples = 0.0;
  /// How that fades: a sample takes this share of what smoothing would change. The way runs from the centre to one
  /// sample beyond the radius, so that the outermost samples of the brush still take some. Without use below a radius
  /// of 1, which has one sample.
  Falloff brush_falloff = Falloff::kFlat;
  /// Smoothing acts again in a contact when the tip has moved by this share of the radius (of half a sample, where
  /// the radius is less), 0 .. 2. 0: in every tick, at rest too.
  double brush_spacing = 0.0;
  /// Marking and unmarking, likewise. [samples], 0 .. 64.
  double mark_radius_samples = 0.0;
  /// Smoothing keeps every sample within this of the ORIGINAL field, over all strokes and filters together.
  /// [height unit of the field], >= 0; none = no limit.
  std::optional<double> max_change;

  /// Feel and edit the field upside down (z -> -z); the result is upright again.
  bool invert = false;

  /// Parameters of the other effects. Those of an effect that is not listed are ignored.
  EffectParams params;

  /// Which effects there are; each kind at most once. Forces act in this order, the spring before those that
  /// need it.
  std::vector<EffectKind> effects = {EffectKind::kSpring, EffectKind::kSmoothing};
  [[nodiscard]] bool lists(EffectKind kind) const noexcept {
    return std::find(effects.begin(), effects.end(), kind) != effects.end();
  }

  friend bool operator==(const Scene&, const Scene&) = default;
};

/// The radius of a tool's brush: that of marking, or of smoothing, which a tool that edits nothing shows.
[[nodiscard]] constexpr double Scene::*brushRadiusOf(Tool tool) noexcept {
  return isMarkTool(tool) ? &Scene::mark_radius_samples : &Scene::brush_radius_samples;
}

/// The scene of `fettle replay` without --scene; the same as assets/scenes/default.toml.
[[nodiscard]] Scene defaultScene();

/// A range violated by a scene put together in code, as one sentence; nothing when all is well.
[[nodiscard]] std::optional<std::string> sceneProblem(const Scene& scene);

/// Reads a scene file (TOML; assets/scenes/default.toml documents every key). What the file leaves out keeps
/// defaultScene()'s value. Errors (kInput, naming file and line): unreadable, no TOML, an unknown key or
/// effect, a value of the wrong type or out of range. Thread: any.
[[nodiscard]] engine::Result<Scene> loadScene(const std::string& path);
/// The same; without a path, empty, the default scene.
[[nodiscard]] engine::Result<Scene> loadSceneOrDefault(const std::string& path);
/// What the words of a scene's [contact] mean, stored beside scenes whose ticks are replayed later (journal, session).
/// 1, and where none is stored: the level "paper" is the search that is called "descent" since 2. Below 3: a ball's searches
/// are not bounded. Below 4: a ball falls a cell per step, its minima are those of equal pieces, 64 searches are the default.
/// Below 5: what its searches look at among steep cells is not bounded.
inline constexpr int kContactRevision = 5;
/// The same from a text that calls itself `name` in errors. `contact_revision`, 1 .. kContactRevision: of the program
/// that wrote the text; errors: a newer one.
[[nodiscard]] engine::Result<Scene> parseScene(const std::string& text, const std::string& name,
                                               int contact_revision = kContactRevision);
/// A scene file's text that parseScene reads back to the very same scene (in range).
[[nodiscard]] std::string sceneText(const Scene& scene);

}  // namespace fettle::haptic
