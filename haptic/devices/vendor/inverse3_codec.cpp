#include "haptic/devices/vendor/inverse3_codec.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "haptic/devices/vendor/stylus_orientation.h"

namespace fettle::haptic {

namespace {

using Json = nlohmann::json;

// Null where there is no such member, or `object` is none.
const Json* member(const Json& object, const char* name) {
  if (!object.is_object()) return nullptr;
  const auto it = object.find(name);
  return it == object.end() ? nullptr : &*it;
}

std::optional<glm::dvec3> vectorOf(const Json* value) {
  if (value == nullptr) return std::nullopt;
  glm::dvec3 v{0.0};
  int axis = 0;
  for (const char* name : {"x", "y", "z"}) {
    const Json* const number = member(*value, name);
    if (number == nullptr || !number->is_number()) return std::nullopt;
    v[axis] = number->get<double>();
    if (!std::isfinite(v[axis])) return std::nullopt;
    ++axis;
  }
  return v;
}

std::optional<Inverse3State> deviceOf(const Json& entry) {
  const Json* const id = member(entry, "device_id");
  if (id == nullptr || !id->is_string()) return std::nullopt;
  Inverse3State device;
  device.device_id = id->get<std::string>();
  if (const Json* const state = member(entry, "state"))
    device.position_m = vectorOf(member(*state, "cursor_position"));
  if (const Json* const status = member(entry, "status"))
    if (const Json* const calibrated = member(*status, "calibrated");
        calibrated != nullptr && calibrated->is_boolean())
      device.calibrated = calibrated->get<bool>();
  return device;
}

// A wireless grip names its buttons a, b, c; one with a cable has a single one.
std::uint32_t buttonsOf(const Json& grip) {
  const Json* const state = member(grip, "state");
  if (state == nullptr) return 0;
  std::uint32_t mask = 0;
  if (const Json* const buttons = member(*state, "buttons")) {
    std::uint32_t bit = 1;
    for (const char* name : {"a", "b", "c"}) {
      const Json* const held = member(*buttons, name);
      if (held != nullptr && held->is_boolean() && held->get<bool>()) mask |= bit;
      bit <<= 1U;
    }
  }
  if (const Json* const button = member(*state, "button"))
    if (button->is_boolean() && button->get<bool>()) mask |= 1U;
  return mask;
}

// In the service's frame, which is the desk's; a grip that is not turned points away from the person.
std::optional<glm::dquat> orientationOf(const Json& grip) {
  const Json* const state = member(grip, "state");
  const Json* const said = state == nullptr ? nullptr : member(*state, "orientation");
  if (said == nullptr) return std::nullopt;
  const std::optional<glm::dvec3> xyz = vectorOf(said);
  const Json* const w = member(*said, "w");
  if (!xyz || w == nullptr || !w->is_number()) return std::nullopt;
  const auto turn = rotationOf(glm::dquat(w->get<double>(), xyz->x, xyz->y, xyz->z));
  if (!turn) return std::nullopt;
  return *turn * kLaidDown;
}

}  // namespace

std::optional<Inverse3Message> decodeInverse3(std::string_view text) {
  const Json root = Json::parse(text, nullptr, false);
  if (!root.is_object()) return std::nullopt;
  Inverse3Message message;
  if (root.contains("session_id")) message.form = Inverse3Form::kVector;
  if (const Json* const devices = member(root, "inverse3")) {
    if (!devices->is_array()) return std::nullopt;
    for (const Json& entry : *devices) {
      std::optional<Inverse3State> device = deviceOf(entry);
      if (!device) return std::nullopt;
      message.devices.push_back(*std::move(device));
    }
  }
  for (const char* kind : {"wireless_verse_grip", "verse_grip"}) {
    const Json* const grips = member(root, kind);
    if (grips == nullptr || !grips->is_array() || grips->empty()) continue;
    message.buttons = buttonsOf(grips->front());
    message.orientation = orientationOf(grips->front());
    break;
  }
  return message;
}

std::string encodeInverse3(Inverse3Form form, std::string_view device_id, const glm::dvec3& force_n,
                           Inverse3Asks asks) {
  const char* const name = form == Inverse3Form::kVector ? "vector" : "values";
  const Json force{{name, {{"x", force_n.x}, {"y", force_n.y}, {"z", force_n.z}}}};
  const Json device{{"device_id", device_id}, {"commands", {{"set_cursor_force", force}}}};
  Json message{{"inverse3", Json::array({device})}};
  if (asks == Inverse3Asks::kFullState) message["session"] = {{"force_render_full_state", Json::object()}};
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace fettle::haptic
