// Written from the maker's public documentation of the Inverse Service, 3.1 and 3.5 (simulation channel, control commands, basis), and
// from programs that others wrote for it; not from the driver.
#include "tests/haptic/devices/fake_vendor/fake_inverse_messages.h"

#include <cmath>

#include <nlohmann/json.hpp>

namespace fettle::fake {

namespace {

using nlohmann::json;

json triple(const std::array<double, 3>& v) {
  return {{"x", v[0]}, {"y", v[1]}, {"z", v[2]}};
}

json armState(InverseForm form, const InverseUnit& unit) {
  json state{{"cursor_position", triple(unit.position_m)},
             {"cursor_velocity", triple(unit.velocity_m_per_s)},
             {"angular_position", {{"a0", -69.3}, {"a1", 137.6}, {"a2", 19.8}}},
             {"angular_velocity", {{"a0", 0.0}, {"a1", 0.0}, {"a2", 0.0}}},
             {"body_orientation", {{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}}}};
  if (form == InverseForm::k31) {
    state["mode"] = "idle";
  } else {
    // Other positions and forces than those of the cursor: a reader that takes the first `x` it finds is wrong.
    state["current_cursor_position"] = triple({9.0, 9.0, 9.0});
    state["current_cursor_force"] = triple({8.0, 8.0, 8.0});
    state["control_mode"] = "idle";
    state["control_domain"] = "cartesian";
    state["transform"] = json::object();  // parts that are as they are by default are left out
  }
  return state;
}

json armStatus(const InverseUnit& unit) {
  return {{"calibrated", unit.calibrated},
          {"in_use", false},
          {"power_supply", true},
          {"ready", true},
          {"started", true}};
}

json grip(const InverseUnit& unit) {
  const auto& q = unit.orientation_wxyz;
  return {{"device_id", "G" + unit.id},
          {"state",
           {{"orientation", {{"w", q[0]}, {"x", q[1]}, {"y", q[2]}, {"z", q[3]}}},
            {"buttons", {{"a", unit.a}, {"b", unit.b}, {"c", unit.c}}},
            {"hall", 0},
            {"battery_level", 0.9}}},
          {"status", {{"connected", true}, {"awake", true}, {"ready", true}}}};
}

json armConfig(const InverseUnit& unit) {
  return {{"type", "inverse3"},
          {"port", "/dev/ttyACM0"},
          {"device_info", {{"major_version", 7}, {"minor_version", 4}, {"id", unit.id}}},
          {"extended_device_id", "2D35F80DD9005F599B68F49944CB" + unit.id},
          {"gravity_compensation", {{"enabled", true}, {"scaling_factor", 1.0}}},
          {"handedness", "right"},
          {"torque_scaling", {{"enabled", true}}}};
}

json message(InverseForm form, const std::vector<InverseUnit>& units, bool first) {
  json arms = json::array();
  json grips = json::array();
  for (const InverseUnit& unit : units) {
    json arm{{"device_id", unit.id}, {"state", armState(form, unit)}};
    if (first || form == InverseForm::k35) arm["status"] = armStatus(unit);
    if (first) arm["config"] = armConfig(unit);
    arms.push_back(std::move(arm));
    if (unit.has_grip) grips.push_back(grip(unit));
  }
  json whole{{"inverse3", std::move(arms)},
             {"verse_grip", json::array()},
             {"wireless_verse_grip", std::move(grips)}};
  if (first && form == InverseForm::k35) whole["session_id"] = 7;
  return whole;
}

// The one command of a device. False where it is another than the form's, or no force.
bool takeForce(const json& commands, const char* key, std::array<double, 3>& n) {
  if (!commands.is_object() || commands.size() != 1 || !commands.contains("set_cursor_force")) return false;
  const json& command = commands["set_cursor_force"];
  if (!command.is_object() || command.size() != 1 || !command.contains(key)) return false;
  const json& vector = command[key];
  if (!vector.is_object() || vector.size() != 3) return false;
  for (int i = 0; i < 3; ++i) {
    const std::string axis(1, static_cast<char>('x' + i));
    // What is not finite cannot be a number of JSON.
    if (!vector.contains(axis) || !vector[axis].is_number()) return false;
    n[static_cast<std::size_t>(i)] = vector[axis].get<double>();
  }
  return true;
}

}  // namespace

std::string inventory(InverseForm form, const std::vector<InverseUnit>& units) {
  return message(form, units, true).dump();
}

std::string stateUpdate(InverseForm form, const std::vector<InverseUnit>& units) {
  return message(form, units, false).dump();
}

InverseCommand readCommand(InverseForm form, std::string_view text) {
  const char* const key = form == InverseForm::k31 ? "values" : "vector";
  const json whole = json::parse(text, nullptr, false);
  if (!whole.is_object()) return {"a message is an object of JSON", false, {}};
  InverseCommand out;
  for (const auto& [name, part] : whole.items()) {
    if (name == "session") {  // profile, configuration and questions
      out.asks_full_state = part.contains("force_render_full_state");
      continue;
    }
    if (name != "inverse3" || !part.is_array()) return {"a message names kinds of devices", false, {}};
    for (const json& device : part) {
      if (!device.is_object() || !device.contains("device_id") || !device["device_id"].is_string())
        return {"a command names its device", false, {}};
      InverseForce force{device["device_id"].get<std::string>(), {}};
      if (!device.contains("commands") || !takeForce(device["commands"], key, force.n))
        return {"a device's command is a finite force, as this version of the service names it", false, {}};
      out.forces.push_back(std::move(force));
    }
  }
  return out;
}

}  // namespace fettle::fake
