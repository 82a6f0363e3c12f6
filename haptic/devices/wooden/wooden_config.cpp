#include "haptic/devices/wooden/wooden_config.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace fettle::haptic {

namespace {

constexpr const char* kRemedy = "compare it with the maker's configuration of your device";

// Reads fields until one is wrong, and keeps that first problem: the fields after it are not read.
class Fields {
 public:
  explicit Fields(const nlohmann::json& object) : object_(object) {}

  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

  enum class Missing { kWrong, kKeep };

  void number(const std::string& name, double& value, double low, double high,
              Missing missing = Missing::kWrong) {
    if (!problem_.empty()) return;
    const auto field = object_.find(name);
    if (field == object_.end()) {
      if (missing == Missing::kWrong) problem_ = fmt::format("the field {} is missing", name);
      return;
    }
    const double read = field->is_number()    ? field->get<double>()
                        : field->is_boolean() ? (field->get<bool>() ? 1.0 : 0.0)
                                              : std::numeric_limits<double>::quiet_NaN();
    if (!(read >= low && read <= high)) {
      problem_ = fmt::format("the field {} is not a number from {} to {}", name, low, high);
      return;
    }
    value = read;
  }

  void perBody(const std::string& stem, glm::dvec3& values, double low, double high,
               Missing missing = Missing::kWrong) {
    number(stem + "_a", values.x, low, high, missing);
    number(stem + "_b", values.y, low, high, missing);
    number(stem + "_c", values.z, low, high, missing);
  }

 private:
  const nlohmann::json& object_;
  std::string problem_;
};

// Ranges for a desktop device: wide enough for any, and narrow enough to detect millimetres given as metres.
constexpr double kTinyM = 1e-4;
constexpr double kHugeM = 2.0;

}  // namespace

engine::Result<WoodenConfig> wooden(std::string_view name) {
  WoodenConfig c;
  if (name == "woody_v2015") return c;
  if (name == "woody_v2019") {
    c.name = name;
    c.torque_constant_nm_a = {0.321, 0.0603, 0.0603};
    return c;
  }
  if (name == "aluhaptics_v2") {
    c.name = name;
    c.diameter_capstan_m = {0.0138, 0.0098, 0.0098};
    c.length_body_m = {0.111, 0.140, 0.111};
    c.diameter_body_m = {0.116, 0.076, 0.076};
    c.workspace_origin_m = {0.14, 0.0, 0.0};
    c.calibrate_enc[2] = 0;  // its home pose has every angle at zero
    return c;
  }
  return engine::inputError("there is no such WoodenHaptics configuration", std::string(name),
                            "use woody_v2015, woody_v2019, aluhaptics_v2 or a configuration file");
}

engine::Result<WoodenConfig> parseWoodenConfig(std::string_view json, const std::string& where) {
  const nlohmann::json object = nlohmann::json::parse(json, nullptr, false);
  if (!object.is_object()) return engine::inputError("the file is not a JSON object", where, kRemedy);

  WoodenConfig c;
  c.name = "WoodenHaptics";
  using Missing = Fields::Missing;
  Fields fields(object);
  double variant = 0.0;
  fields.number("variant", variant, 0, 1e6, Missing::kKeep);
  fields.perBody("diameter_capstan", c.diameter_capstan_m, kTinyM, kHugeM);
  fields.perBody("length_body", c.length_body_m, kTinyM, kHugeM);
  fields.perBody("diameter_body", c.diameter_body_m, kTinyM, kHugeM);
  fields.number("workspace_origin_x", c.workspace_origin_m.x, -kHugeM, kHugeM);
  fields.number("workspace_origin_y", c.workspace_origin_m.y, -kHugeM, kHugeM);
  fields.number("workspace_origin_z", c.workspace_origin_m.z, -kHugeM, kHugeM);
  fields.number("workspace_radius", c.workspace_radius_m, kTinyM, kHugeM);
  fields.perBody("torque_constant_motor", c.torque_constant_nm_a, 1e-4, 10.0);
  fields.number("max_linear_force", c.max_linear_force_n, 1e-3, 100.0);
  fields.number("max_linear_stiffness", c.max_linear_stiffness_n_m, 1e-3, 1e5);
  fields.number("max_linear_damping", c.max_linear_damping_n_s_m, 0.0, 1e3);
  fields.perBody("max_current_motor", c.max_current_a, 1e-3, 6.0, Missing::kKeep);
  for (std::size_t i = 0; i < 6; ++i) {
    const char letter = static_cast<char>('a' + i);
    const Missing missing = i < 3 ? Missing::kWrong : Missing::kKeep;
    double home = c.calibrate_enc[i];
    fields.number(fmt::format("cpr_encoder_{}", letter), c.cpr_encoder[i], 1.0, 1e6, missing);
    fields.number(fmt::format("calibrate_enc_{}", letter), home, INT16_MIN, INT16_MAX, missing);
    c.calibrate_enc[i] = static_cast<int>(std::lround(home));
    if (i >= 3) continue;
    double aligned = 0.0;
    fields.number(fmt::format("motor_and_body_aligned_{}", letter), aligned, 0.0, 1.0);
    c.motor_and_body_aligned[i] = aligned != 0.0;
  }
  if (!fields.problem().empty()) return engine::inputError(fields.problem(), where, kRemedy);
  c.variant = static_cast<int>(variant);
  return c;
}

engine::Result<WoodenConfig> readWoodenConfig(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return engine::inputError("the configuration cannot be read", path, "check path and rights");
  // A configuration is a page of text; a path given by mistake must not fill the memory.
  constexpr std::size_t kLongest = 1U << 20U;
  std::string text(kLongest + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (file.bad())
    return engine::inputError("the configuration cannot be read", path, "check path and rights");
  if (text.size() > kLongest) return engine::inputError("the file is too long for a configuration", path);
  return parseWoodenConfig(text, path);
}

std::string defaultWoodenConfigPath() {
  const char* home = std::getenv("HOME");  // NOLINT(concurrency-mt-unsafe): never set
  return home == nullptr || *home == '\0' ? std::string() : std::string(home) + "/woodenhaptics.json";
}

DeviceProfile woodenProfile(const WoodenConfig& c) {
  DeviceProfile p;
  p.name = c.name;
  p.space = DeviceSpace::kDesk;
  p.workspace_radius_mm = 1000.0 * c.workspace_radius_m;
  p.max_force_n = c.max_linear_force_n;
  p.max_stiffness_n_per_mm = 1e-3 * c.max_linear_stiffness_n_m;
  p.max_damping_n_s_per_mm = 1e-3 * c.max_linear_damping_n_s_m;
  p.rate_hz = 1000.0;
  p.gives_force = true;
  // Lever of each body at the origin: the reach for a, the link's own length for b and c.
  const glm::dvec3 lever{std::max(c.workspace_origin_m.x, kTinyM), c.length_body_m.y, c.length_body_m.z};
  for (int i = 0; i < 3; ++i) {
    const double turn = 2.0 * std::numbers::pi / c.cpr_encoder[static_cast<std::size_t>(i)];
    const double count_mm = 1000.0 * turn * c.diameter_capstan_m[i] / c.diameter_body_m[i] * lever[i];
    p.resolution_mm = std::max(p.resolution_mm, count_mm);
  }
  return p;
}

}  // namespace fettle::haptic
