#pragma once

#include <cstdint>

namespace fettle::haptic {

// Parameters of each effect: one table of the scene file each, with the same names. Ranges are checked by
// sceneProblem and loadScene. Each effect's own header gives its source and stability condition.

/// [friction]
struct FrictionParams {
  double static_coefficient = 0.4;   ///< "static": tangential over normal force at which it slips, 0 .. 2
  double dynamic_coefficient = 0.3;  ///< "dynamic": the same while it slips, 0 .. static
  double stiffness_n_per_mm = 1.0;   ///< of the stuck tip, along the surface, > 0 .. 1000

  friend bool operator==(const FrictionParams&, const FrictionParams&) = default;
};

/// Where the tip is in the viscous medium.
enum class ViscousMedium : std::uint8_t {
  kContact,     ///< while the tip touches
  kEverywhere,  ///< in free space too
};

/// [viscosity]
struct ViscosityParams {
  double damping_n_s_per_mm = 0.002;               ///< 0 .. 1; hand devices hold 0.004 to 0.03
  ViscousMedium medium = ViscousMedium::kContact;  ///< "in"

  friend bool operator==(const ViscosityParams&, const ViscosityParams&) = default;
};

/// [edge_snap]
struct EdgeSnapParams {
  double force_n = 0.5;   ///< largest pull, halfway between edge and reach, 0 .. 20
  double reach_mm = 1.0;  ///< horizontal distance at which the pull begins, > 0 .. 50

  friend bool operator==(const EdgeSnapParams&, const EdgeSnapParams&) = default;
};

enum class TexturePattern : std::uint8_t {
  kNoise,    ///< even in all directions, all of it between one and four thirds of the wavelength
  kGrating,  ///< a sine along x
};

/// [texture]
struct TextureParams {
  double amplitude_mm = 0.02;  ///< highest to lowest point, both below the surface, 0 .. 1
  double wavelength_mm = 0.5;  ///< shortest there is, > 0 .. 100
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
  double damping_n_s_per_mm = 0.001;  ///< between proxy and endpoint, 0 .. 1

  friend bool operator==(const CouplingParams&, const CouplingParams&) = default;
};

/// [passivity]
struct PassivityParams {
  /// Largest damping the controller adds beyond taking driving force away, 0 .. 1
  double max_damping_n_s_per_mm = 0.005;

  friend bool operator==(const PassivityParams&, const PassivityParams&) = default;
};

/// [velocity]: the estimate that viscosity and coupling share
struct VelocityParams {
  double filter_ms = 2.0;  ///< time constant of its low pass, 0 .. 50

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
  VelocityParams velocity;

  friend bool operator==(const EffectParams&, const EffectParams&) = default;
};

}  // namespace fettle::haptic
