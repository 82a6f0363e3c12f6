#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "engine/base/rows.h"

namespace fettle::haptic {

// All that a scene states of effects: which there are, and their parameters, whose ranges are checked by kSceneNumbers
// (scene_numbers.h). The header of each effect, in haptic/effects, gives its source and stability condition.

/// What a scene may list. What it does not list is not built, not stored and not called.
enum class EffectKind : std::uint8_t {
  kSpring,     ///< force along the penetration vector and proportional to it
  kSmoothing,  ///< local smoothing of the field by force, with Tool::kSmooth
  kFriction,   ///< Coulomb friction with stick-slip
  kViscosity,  ///< against the endpoint's velocity
  kEdgeSnap,   ///< pull towards marked samples, for tracing
  kTexture,    ///< relief finer than the grid
  kGravity,    ///< holds up the stylus, in free space too
  kCoupling,   ///< damping between proxy and endpoint
  kPassivity,  ///< no more energy comes out than was put in
  kSound,      ///< the surface, contact and friction to be heard; gives no force
  kCount
};

inline constexpr int kEffectKinds = static_cast<int>(EffectKind::kCount);

struct EffectRow {
  EffectKind kind;
  std::string_view word;      ///< in scene files and reports
  std::string_view says;      ///< in the window
  bool needs_spring = false;  ///< depends on the force with which the spring presses
};
inline constexpr std::array kEffectRows = {
    EffectRow{EffectKind::kSpring, "spring",
              "Force against the tip that is pressed in, proportional to how deep."},
    EffectRow{EffectKind::kSmoothing, "smoothing", "The tool \"smooth\" smooths where it presses."},
    EffectRow{EffectKind::kFriction, "friction",
              "The tip sticks to the surface and slips under force, as a pencil does.", true},
    EffectRow{EffectKind::kViscosity, "viscosity", "Force against the speed of the tip, as in oil."},
    EffectRow{EffectKind::kEdgeSnap, "edge_snap",
              "Pulls towards marked samples and edge lines, to trace an edge again."},
    EffectRow{EffectKind::kTexture, "texture",
              "Relief finer than the samples, which is felt and not in the data.", true},
    EffectRow{EffectKind::kGravity, "gravity", "Holds up the stylus, in free space too."},
    EffectRow{EffectKind::kCoupling, "coupling", "Damping between the tip and the surface.", true},
    EffectRow{EffectKind::kPassivity, "passivity",
              "Never gives the hand more energy than it put in: stops buzzing."},
    EffectRow{EffectKind::kSound, "sound",
              "The surface, contact and friction to be heard; changes no force."},
};
static_assert(engine::inOrder(kEffectRows, &EffectRow::kind, EffectKind::kCount));

/// The words, in the order of EffectKind.
inline constexpr auto kEffectWords = [] {
  std::array<std::string_view, kEffectRows.size()> words;
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = kEffectRows[i].word;
  return words;
}();
[[nodiscard]] constexpr const EffectRow& rowOf(EffectKind kind) noexcept {
  return kEffectRows[static_cast<std::size_t>(kind)];
}
[[nodiscard]] constexpr std::string_view effectName(EffectKind kind) noexcept {
  return rowOf(kind).word;
}

// Parameters: one table of the scene file for each effect, with the same names.

/// [friction]
struct FrictionParams {
  double static_coefficient = 0.4;   ///< "static": tangential over normal force at which it slips, 0 .. 2
  double dynamic_coefficient = 0.3;  ///< "dynamic": the same while it slips, 0 .. static
  double stiffness_n_per_mm = 1.0;   ///< of the stuck tip, along the surface, > 0 .. 1e9

  friend bool operator==(const FrictionParams&, const FrictionParams&) = default;
};

/// Where the tip is in the viscous medium.
enum class ViscousMedium : std::uint8_t {
  kContact,     ///< while the tip touches
  kEverywhere,  ///< in free space too
};

/// [viscosity]
struct ViscosityParams {
  double damping_n_s_per_mm = 0.002;               ///< 0 .. 1e6; hand devices hold 0.004 to 0.03
  ViscousMedium medium = ViscousMedium::kContact;  ///< "in"

  friend bool operator==(const ViscosityParams&, const ViscosityParams&) = default;
};

/// [edge_snap]
struct EdgeSnapParams {
  double force_n = 0.5;   ///< largest pull, halfway between edge and reach, 0 .. 20
  double reach_mm = 1.0;  ///< horizontal distance at which the pull begins, > 0 .. 1e9

  friend bool operator==(const EdgeSnapParams&, const EdgeSnapParams&) = default;
};

enum class TexturePattern : std::uint8_t {
  kNoise,    ///< even in all directions, all of it between one and four thirds of the wavelength
  kGrating,  ///< a sine along x
};

/// [texture]
struct TextureParams {
  double amplitude_mm = 0.02;  ///< highest to lowest point, both below the surface, 0 .. 1e9
  double wavelength_mm = 0.5;  ///< shortest there is, > 0 .. 1e9
  TexturePattern pattern = TexturePattern::kNoise;

  friend bool operator==(const TextureParams&, const TextureParams&) = default;
};

/// [gravity]
struct GravityParams {
  double stylus_kg = 0.05;  ///< mass held up, 0 .. 2; more than the device weighs makes it rise

  friend bool operator==(const GravityParams&, const GravityParams&) = default;
};

/// [coupling]
struct CouplingParams {
  double damping_n_s_per_mm = 0.001;  ///< between proxy and endpoint, 0 .. 1e6

  friend bool operator==(const CouplingParams&, const CouplingParams&) = default;
};

/// [passivity]
struct PassivityParams {
  /// Largest damping the controller adds beyond taking driving force away, 0 .. 1e6
  double max_damping_n_s_per_mm = 0.005;

  friend bool operator==(const PassivityParams&, const PassivityParams&) = default;
};

/// [sound]: how loud its parts are, and the body that rings. How loud all of it is belongs to the window, not to the scene.
struct SoundParams {
  double profile = 1.0;     ///< of the surface under the tip at the hand's speed, 0 .. 10
  double knock = 1.0;       ///< of contact that begins, 0 .. 10
  double slip = 1.0;        ///< of friction that lets go and slides; needs the effect friction, 0 .. 10
  double body_hz = 1200.0;  ///< lowest mode of the body that is struck, 50 .. 8000
  double ring_ms = 60.0;    ///< until that mode has fallen to a thousandth, 1 .. 2000

  friend bool operator==(const SoundParams&, const SoundParams&) = default;
};

/// [velocity]: the estimate that viscosity and coupling share
struct VelocityParams {
  double filter_ms = 2.0;  ///< time constant of its low pass, 0 .. 50
  /// Of the tip in the field [mm/s]: a faster step is a jump, > 0 .. 1e13. A hand reaches 4000, times the scale of its workspace.
  double fastest_mm_per_s = 5000.0;

  friend bool operator==(const VelocityParams&, const VelocityParams&) = default;
};

/// All of them. An effect that is not listed does not use its own.
struct EffectParams {
  FrictionParams friction;
  ViscosityParams viscosity;
  EdgeSnapParams edge_snap;
  TextureParams texture;
  GravityParams gravity;
  CouplingParams coupling;
  PassivityParams passivity;
  SoundParams sound;
  VelocityParams velocity;

  friend bool operator==(const EffectParams&, const EffectParams&) = default;
};

}  // namespace fettle::haptic
