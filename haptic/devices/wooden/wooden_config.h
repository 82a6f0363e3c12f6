#pragma once

#include <array>
#include <string>
#include <string_view>

#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "haptic/devices/device.h"

namespace fettle::haptic {

/// One WoodenHaptics-like device (WoodenHaptics, AluHaptics, Polhem): bodies a (turns about the vertical), b
/// and c (the two links), each driven by a motor over a capstan. Field names, signs and SI units are those of
/// the configuration file of the makers' own software, so that a user's file can be read unchanged.
/// Members indexed by body: x = a, y = b, z = c.
struct WoodenConfig {
  std::string name = "woody_v2015";
  int variant = 0;                                  ///< the makers' number; kept, not interpreted
  glm::dvec3 diameter_capstan_m{0.010};             ///< > 0
  glm::dvec3 length_body_m{0.080, 0.205, 0.245};    ///< > 0
  glm::dvec3 diameter_body_m{0.160, 0.120, 0.120};  ///< > 0
  glm::dvec3 workspace_origin_m{0.22, 0.0, 0.08};   ///< of the device's position 0, from its foot
  double workspace_radius_m = 0.100;                ///< > 0
  glm::dvec3 torque_constant_nm_a{0.0259};          ///< > 0
  std::array<double, 6> cpr_encoder{2000, 2000, 2000, 2000, 2000, 2000};  ///< counts per turn, > 0
  double max_linear_force_n = 5.0;                                        ///< > 0
  double max_linear_stiffness_n_m = 1000.0;                               ///< > 0
  double max_linear_damping_n_s_m = 8.0;                                  ///< > 0
  std::array<int, 6> calibrate_enc{0, 0, 6000, 0, 0, 0};                  ///< counts in the home pose, int16
  std::array<bool, 3> motor_and_body_aligned{false, false, false};
  /// Not in the makers' files, optional (max_current_motor_a ...): the firmware of the mbed boards clamps at
  /// 3 A; the serial boards reject a value above 6 A and apply none. 0 < current <= 6.
  glm::dvec3 max_current_a{3.0};
};

/// The three published configurations: "woody_v2015", "woody_v2019", "aluhaptics_v2". Error kInput: unknown.
[[nodiscard]] engine::Result<WoodenConfig> wooden(std::string_view name);

/// Reads a configuration file (JSON, one object). Fields: variant; diameter_capstan_{a,b,c};
/// length_body_{a,b,c}; diameter_body_{a,b,c}; workspace_origin_{x,y,z}; workspace_radius;
/// torque_constant_motor_{a,b,c}; cpr_encoder_{a..f}; max_linear_force, _stiffness, _damping;
/// calibrate_enc_{a..f}; motor_and_body_aligned_{a,b,c} (0 or 1, false or true). All but variant,
/// encoders d to f and max_current_motor_{a,b,c} [A] must be there; others are ignored. Metres, newtons, N/m,
/// N s/m.
/// Errors (kInput, naming the field): unreadable file, invalid JSON, field missing, not a number or out of
/// range.
[[nodiscard]] engine::Result<WoodenConfig> readWoodenConfig(const std::string& path);

/// The same from text; `where` is named in errors.
[[nodiscard]] engine::Result<WoodenConfig> parseWoodenConfig(std::string_view json, const std::string& where);

/// Where the makers' software keeps the file: $HOME/woodenhaptics.json; empty without HOME.
[[nodiscard]] std::string defaultWoodenConfigPath();

/// Limits and workspace in Fettle's units.
[[nodiscard]] DeviceProfile woodenProfile(const WoodenConfig& config);

}  // namespace fettle::haptic
