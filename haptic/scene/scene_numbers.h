#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "haptic/scene/scene.h"

namespace fettle::haptic {

// Every number and every word of a scene, once: scene files are read and written, scenes checked, panels laid out and
// docs/scenes.md is compared by these tables. What they do not have: `invert`, `effects` and `max_change`.

/// Whether the lower end of a range belongs to it.
enum class LowEnd : std::uint8_t { kIncluded, kExcluded };
enum class NumberKind : std::uint8_t { kReal, kWhole };
/// Whether a scene's text has a key whose value is the default. Older programs read a text without a key they do not know.
enum class Written : std::uint8_t { kAlways, kUnlessDefault };

// Ends of ranges: of a field as small as an atom and as large as the earth, in the hand of a device. What a device holds is said
// by its stability (haptic/effects/stability.h), not by these.
inline constexpr double kMostStiffness = 1e9;  // [N/mm]
inline constexpr double kMostDamping = 1e6;    // [N s/mm]
inline constexpr double kMostLength = 1e9;     // [mm]
inline constexpr double kMostSpeed = 1e13;     // [mm/s]

namespace scene_rows {

// A member of a member of ... of a scene.
template <auto first, auto... rest>
[[nodiscard]] constexpr auto& memberOf(auto& scene) noexcept {
  if constexpr (sizeof...(rest) == 0)
    return scene.*first;
  else
    return memberOf<rest...>(scene.*first);
}
template <class To, auto... path>
[[nodiscard]] To get(const Scene& scene) noexcept {
  return static_cast<To>(memberOf<path...>(scene));
}
template <class From, auto... path>
void set(Scene& scene, From value) noexcept {
  auto& member = memberOf<path...>(scene);
  member = static_cast<std::remove_reference_t<decltype(member)>>(value);
}

}  // namespace scene_rows

/// One number of a scene.
struct SceneNumber {
  std::string_view table;  ///< of the scene file; empty: above all tables
  std::string_view key;
  std::string_view name;  ///< in panels
  std::string_view unit;  ///< empty: it has none
  double low, high;
  std::string_view says;  ///< what it is, as the tip of its field
  double (*of)(const Scene& scene) noexcept;
  void (*set)(Scene& scene, double value) noexcept;  ///< `value` in range
  LowEnd low_end = LowEnd::kIncluded;
  NumberKind kind = NumberKind::kReal;
  Written written = Written::kAlways;

  [[nodiscard]] bool holds(double value) const noexcept {
    return (low_end == LowEnd::kExcluded ? value > low : value >= low) && value <= high &&
           (kind == NumberKind::kReal || value == std::floor(value));
  }
};

/// One choice of a scene between words.
struct SceneWord {
  std::string_view table, key;
  std::string_view name;  ///< in panels
  std::span<const std::string_view> words;
  std::string_view says;
  std::size_t (*of)(const Scene& scene) noexcept;  ///< index of the word
  void (*set)(Scene& scene, std::size_t word) noexcept;
  Written written = Written::kAlways;
};

inline constexpr std::array<std::string_view, 2> kTipWords = {"point", "sphere"};
inline constexpr std::array<std::string_view, 3> kLevelWords = {"paper", "descent", "certified"};
inline constexpr std::array<std::string_view, 2> kMinimaWords = {"pieces", "all"};
inline constexpr std::array<std::string_view, 2> kStepWords = {"space", "plan"};
inline constexpr std::array<std::string_view, 2> kMediumWords = {"contact", "everywhere"};
inline constexpr std::array<std::string_view, 2> kPatternWords = {"noise", "grating"};

namespace scene_rows {

template <auto... path>
constexpr SceneNumber number(std::string_view table, std::string_view key, std::string_view name,
                             std::string_view unit, double low, double high, std::string_view says,
                             LowEnd low_end = LowEnd::kIncluded, NumberKind kind = NumberKind::kReal,
                             Written written = Written::kAlways) {
  return {table,
          key,
          name,
          unit,
          low,
          high,
          says,
          scene_rows::get<double, path...>,
          scene_rows::set<double, path...>,
          low_end,
          kind,
          written};
}
template <auto... path>
constexpr SceneWord word(std::string_view table, std::string_view key, std::string_view name,
                         std::span<const std::string_view> words, std::string_view says,
                         Written written = Written::kAlways) {
  return {table,
          key,
          name,
          words,
          says,
          scene_rows::get<std::size_t, path...>,
          scene_rows::set<std::size_t, path...>,
          written};
}
// Of an effect's parameters.
template <auto effect, auto member>
constexpr SceneNumber ofEffect(std::string_view table, std::string_view key, std::string_view name,
                               std::string_view unit, double low, double high, std::string_view says,
                               LowEnd low_end = LowEnd::kIncluded) {
  return number<&Scene::params, effect, member>(table, key, name, unit, low, high, says, low_end);
}

}  // namespace scene_rows

/// In the order of scene files. The table of an effect's own numbers is called as the effect is.
inline constexpr std::array kSceneNumbers = {
    scene_rows::number<&Scene::tip_radius_mm>("", "tip_radius_mm", "ball radius", "mm", 0, kMostLength,
                                              "Radius of the ball with which the surface is felt.",
                                              LowEnd::kExcluded),
    scene_rows::number<&Scene::certified_radius_cells>(
        "contact", "certified_radius_cells", "certified radius", "cells", 1, 64,
        "All cells that are as near as this are searched at the level \"certified\".", LowEnd::kIncluded,
        NumberKind::kWhole),
    scene_rows::number<&Scene::search_rounds>("contact", "search_rounds", "search rounds", "", 2, kMaxRounds,
                                              "Rounds that a search may take in one tick at the level "
                                              "\"descent\", and of a ball: fewer bound the time of a "
                                              "tick and lag behind a fast hand.",
                                              LowEnd::kIncluded, NumberKind::kWhole),
    scene_rows::number<&Scene::ball_searches>(
        "contact", "ball_searches", "ball searches", "", 0, kMostBallSearches,
        "Searches after which a ball takes no further step in a tick; 0: no bound.", LowEnd::kIncluded,
        NumberKind::kWhole),
    scene_rows::number<&Scene::ball_work>("contact", "ball_work", "ball work", "cells", 0, kMostBallWork,
                                          "Steep cells that a ball's searches look at in a tick before it "
                                          "ends, where steps are limited in plan; 0: no bound.",
                                          LowEnd::kIncluded, NumberKind::kWhole),
    scene_rows::number<&Scene::stiffness_n_per_mm>(
        "force", "stiffness_n_per_mm", "stiffness", "N/mm", 0, kMostStiffness,
        "Force for each millimetre that the tip is pressed in.", LowEnd::kExcluded),
    scene_rows::number<&Scene::force_limit_n>(
        "force", "limit_n", "force limit", "N", 0, 1000,
        "Largest force, and with which smoothing has its full strength.", LowEnd::kExcluded),
    scene_rows::number<&Scene::brush_radius_samples>(
        "brush", "radius_samples", "radius", "samples", 0, kMaxBrushRadius,
        "Smoothing changes the samples within this distance of the brush's centre."),
    scene_rows::number<&Scene::mark_radius_samples>(
        "brush", "mark_radius_samples", "mark radius", "samples", 0, kMaxBrushRadius,
        "Marking sets the samples within this distance of the brush's centre."),
    scene_rows::number<&Scene::brush_spacing>(
        "brush", "spacing", "spacing", "", 0, kMaxBrushSpacing,
        "Smoothing acts again when the tip has moved by this share of the radius; 0: in every tick.",
        LowEnd::kIncluded, NumberKind::kReal, Written::kUnlessDefault),
    scene_rows::ofEffect<&EffectParams::friction, &FrictionParams::static_coefficient>(
        "friction", "static", "static", "", 0, 2,
        "Force along the surface over force into it at which a tip that sticks lets go."),
    scene_rows::ofEffect<&EffectParams::friction, &FrictionParams::dynamic_coefficient>(
        "friction", "dynamic", "dynamic", "", 0, 2, "The same while the tip slides; at most the static one."),
    scene_rows::ofEffect<&EffectParams::friction, &FrictionParams::stiffness_n_per_mm>(
        "friction", "stiffness_n_per_mm", "grip", "N/mm", 0, kMostStiffness,
        "Stiffness along the surface of a tip that sticks.", LowEnd::kExcluded),
    scene_rows::ofEffect<&EffectParams::viscosity, &ViscosityParams::damping_n_s_per_mm>(
        "viscosity", "damping_n_s_per_mm", "damping", "N s/mm", 0, kMostDamping,
        "Force against the speed of the tip. Hand devices hold 0.004 to 0.03."),
    scene_rows::ofEffect<&EffectParams::edge_snap, &EdgeSnapParams::force_n>(
        "edge_snap", "force_n", "pull", "N", 0, 20,
        "Largest pull towards marks and edge lines, halfway between them and the reach."),
    scene_rows::ofEffect<&EffectParams::edge_snap, &EdgeSnapParams::reach_mm>(
        "edge_snap", "reach_mm", "reach", "mm", 0, kMostLength,
        "Horizontal distance at which the pull begins.", LowEnd::kExcluded),
    scene_rows::ofEffect<&EffectParams::texture, &TextureParams::amplitude_mm>(
        "texture", "amplitude_mm", "amplitude", "mm", 0, kMostLength,
        "From the highest to the lowest point of the relief, all of it below the surface."),
    scene_rows::ofEffect<&EffectParams::texture, &TextureParams::wavelength_mm>(
        "texture", "wavelength_mm", "wavelength", "mm", 0, kMostLength, "The shortest of the relief.",
        LowEnd::kExcluded),
    scene_rows::ofEffect<&EffectParams::gravity, &GravityParams::stylus_kg>(
        "gravity", "stylus_kg", "mass", "kg", 0, 2,
        "Mass that is held up; more than the stylus weighs makes it rise."),
    scene_rows::ofEffect<&EffectParams::coupling, &CouplingParams::damping_n_s_per_mm>(
        "coupling", "damping_n_s_per_mm", "damping", "N s/mm", 0, kMostDamping,
        "Between the tip and the surface, along the press only."),
    scene_rows::ofEffect<&EffectParams::passivity, &PassivityParams::max_damping_n_s_per_mm>(
        "passivity", "max_damping_n_s_per_mm", "largest damping", "N s/mm", 0, kMostDamping,
        "That the controller adds, beyond taking driving force away."),
    scene_rows::ofEffect<&EffectParams::sound, &SoundParams::profile>(
        "sound", "profile", "profile", "", 0, 10,
        "Loudness of the surface under the tip at the hand's speed."),
    scene_rows::ofEffect<&EffectParams::sound, &SoundParams::knock>("sound", "knock", "knock", "", 0, 10,
                                                                    "Loudness of contact that begins."),
    scene_rows::ofEffect<&EffectParams::sound, &SoundParams::slip>(
        "sound", "slip", "slip", "", 0, 10,
        "Loudness of friction that lets go and slides; needs the effect friction."),
    scene_rows::ofEffect<&EffectParams::sound, &SoundParams::body_hz>(
        "sound", "body_hz", "body", "Hz", 50, 8000, "Lowest mode of the body that is struck."),
    scene_rows::ofEffect<&EffectParams::sound, &SoundParams::ring_ms>(
        "sound", "ring_ms", "ring", "ms", 1, 2000, "Until that mode has fallen to a thousandth."),
    scene_rows::ofEffect<&EffectParams::velocity, &VelocityParams::filter_ms>(
        "velocity", "filter_ms", "speed filter", "ms", 0, 50,
        "Time constant of the speed that viscosity and coupling go by: a longer one is quieter and later."),
    scene_rows::number<&Scene::params, &EffectParams::velocity, &VelocityParams::fastest_mm_per_s>(
        "velocity", "fastest_mm_per_s", "fastest hand", "mm/s", 0, kMostSpeed,
        "Speed of the tip above which it jumped: such a step is not damped and is no work of the hand.",
        LowEnd::kExcluded, NumberKind::kReal, Written::kUnlessDefault),
};

inline constexpr std::array kSceneWords = {
    scene_rows::word<&Scene::tip>("", "tip", "tip", kTipWords, "With what the surface is felt."),
    scene_rows::word<&Scene::level>("contact", "level", "contact", kLevelWords,
                                    "How the closest point is found."),
    scene_rows::word<&Scene::ball_minima>("contact", "ball_minima", "ball minima", kMinimaWords,
                                          "Which minima of the distance a ball searches for inside cells."),
    scene_rows::word<&Scene::ball_steps>("contact", "ball_steps", "ball steps", kStepWords,
                                         "In which direction a ball's step is a cell long at most."),
    scene_rows::word<&Scene::brush_falloff>("brush", "falloff", "falloff", kFalloffWords,
                                            "How smoothing fades from the centre to the rim.",
                                            Written::kUnlessDefault),
    scene_rows::word<&Scene::params, &EffectParams::viscosity, &ViscosityParams::medium>(
        "viscosity", "in", "acts in", kMediumWords, "While the tip touches, or in free space too."),
    scene_rows::word<&Scene::params, &EffectParams::texture, &TextureParams::pattern>(
        "texture", "pattern", "pattern", kPatternWords, "Noise, even in all directions, or a sine along x."),
};

/// The row of a key that there is.
[[nodiscard]] consteval const SceneNumber& sceneNumber(std::string_view table, std::string_view key) {
  for (const SceneNumber& each : kSceneNumbers)
    if (each.table == table && each.key == key) return each;
  throw "no such number";
}

/// How a number follows the size of a field that shall feel alike: 1, a length or speed, grows with it; -1, something for each
/// millimetre, falls with it; 0: it is of the hand (force, time, mass, loudness), a share, or counted in samples.
[[nodiscard]] constexpr int lengthPower(const SceneNumber& number) noexcept {
  if (number.unit == "mm" || number.unit == "mm/s") return 1;
  return number.unit == "N/mm" || number.unit == "N s/mm" ? -1 : 0;
}

/// "0 to 2 N", "above 0, at most 1000 N", "a whole number from 1 to 64 cells".
[[nodiscard]] std::string rangeText(const SceneNumber& number);
/// A value out of range as one sentence, with the names of the scene file: "limit_n in [force] must be above 0, at most 1000 N".
[[nodiscard]] std::string rangeProblem(const SceneNumber& number);
/// The nearest value in range; nothing where there is no nearest: not a number, and at an end that does not belong to the range.
[[nodiscard]] std::optional<double> nearestInRange(const SceneNumber& number, double value) noexcept;

}  // namespace fettle::haptic
