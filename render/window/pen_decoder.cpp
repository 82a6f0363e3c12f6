#include "render/window/pen_decoder.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numbers>
#include <string>

namespace fettle::render {
namespace {

// Of the tip.
constexpr std::uint32_t kTip = 1;
// libxcb sets four bytes of its own behind the first 32 of an event.
constexpr std::size_t kOfEvent = 32 + sizeof(std::uint32_t);
// Angles are given in units per radian. Drivers that mean whole degrees say 57 or nothing of use.
constexpr double kFinerThanDegrees = 60.0;

double numberOf(const xcb_input_fp3232_t& fixed) {
  return fixed.integral + std::ldexp(static_cast<double>(fixed.frac), -32);
}

bool namesEraser(std::string_view name) {
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower.find("eraser") != std::string::npos;
}

}  // namespace

std::optional<PenDecoder::Known> PenDecoder::pen(const xcb_input_xi_device_info_t& info,
                                                 const PenLabels& labels) {
  if (info.type != XCB_INPUT_DEVICE_TYPE_SLAVE_POINTER) return std::nullopt;
  Known pen;
  for (auto it = xcb_input_xi_device_info_classes_iterator(&info); it.rem > 0;
       xcb_input_device_class_next(&it)) {
    if (it.data->type != XCB_INPUT_DEVICE_CLASS_TYPE_VALUATOR) continue;
    xcb_input_valuator_class_t valuator;
    std::memcpy(&valuator, it.data, sizeof valuator);
    if (valuator.label == XCB_ATOM_NONE) continue;
    Axis axis{valuator.number, numberOf(valuator.min), numberOf(valuator.max), 1.0, numberOf(valuator.value)};
    if (!(axis.low < axis.high)) continue;
    if (valuator.resolution > kFinerThanDegrees)
      axis.degrees = 180.0 / std::numbers::pi / valuator.resolution;
    if (valuator.label == labels.pressure) pen.pressure = axis;
    if (valuator.label == labels.tilt_x) pen.tilt_x = axis;
    if (valuator.label == labels.tilt_y) pen.tilt_y = axis;
  }
  if (!pen.pressure) return std::nullopt;
  pen.eraser = namesEraser({xcb_input_xi_device_info_name(&info),
                            static_cast<std::size_t>(xcb_input_xi_device_info_name_length(&info))});
  return pen;
}

void PenDecoder::describe(const xcb_input_xi_query_device_reply_t& devices, const PenLabels& labels) {
  std::map<xcb_input_device_id_t, Known> now;
  for (auto it = xcb_input_xi_query_device_infos_iterator(&devices); it.rem > 0;
       xcb_input_xi_device_info_next(&it)) {
    std::optional<Known> found = pen(*it.data, labels);
    if (!found) continue;
    if (const auto before = pens_.find(it.data->deviceid); before != pens_.end())
      found->down = before->second.down;
    now.emplace(it.data->deviceid, *found);
  }
  pens_ = std::move(now);
}

std::vector<xcb_input_device_id_t> PenDecoder::pens() const {
  std::vector<xcb_input_device_id_t> ids;
  for (const auto& [id, pen] : pens_) ids.push_back(id);
  return ids;
}

void PenDecoder::takeValue(Known& pen, std::uint32_t number, double value) {
  for (std::optional<Axis>* axis : {&pen.pressure, &pen.tilt_x, &pen.tilt_y})
    if (*axis && (*axis)->number == number) (*axis)->value = value;
}

void PenDecoder::take(const xcb_ge_generic_event_t& event) {
  if (event.event_type != XCB_INPUT_MOTION && event.event_type != XCB_INPUT_BUTTON_PRESS &&
      event.event_type != XCB_INPUT_BUTTON_RELEASE)
    return;
  const std::size_t size = kOfEvent + std::size_t{4} * event.length;
  const auto* const bytes = reinterpret_cast<const std::byte*>(&event);
  xcb_input_button_press_event_t head;
  if (size < sizeof head) return;
  std::memcpy(&head, bytes, sizeof head);
  const auto known = pens_.find(head.deviceid);
  if (known == pens_.end()) return;
  Known& pen = known->second;

  // Behind the head: buttons held, which values follow, and these, in words of 32 bits.
  const std::size_t which_at = sizeof head + std::size_t{4} * head.buttons_len;
  std::size_t value_at = which_at + std::size_t{4} * head.valuators_len;
  if (value_at > size) return;
  for (std::uint32_t word = 0; word < head.valuators_len; ++word) {
    std::uint32_t which = 0;
    std::memcpy(&which, bytes + which_at + std::size_t{4} * word, sizeof which);
    for (; which != 0; which &= which - 1) {
      xcb_input_fp3232_t fixed;
      if (value_at + sizeof fixed > size) return;
      std::memcpy(&fixed, bytes + value_at, sizeof fixed);
      value_at += sizeof fixed;
      takeValue(pen, 32 * word + static_cast<std::uint32_t>(std::countr_zero(which)), numberOf(fixed));
    }
  }
  if (head.detail == kTip && event.event_type == XCB_INPUT_BUTTON_PRESS) pen.down = true;
  if (head.detail == kTip && event.event_type == XCB_INPUT_BUTTON_RELEASE) pen.down = false;
}

std::optional<Pen> PenDecoder::down() const {
  for (const auto& [id, known] : pens_) {
    if (!known.down) continue;
    const auto share = [](const Axis& axis) {
      return std::clamp((axis.value - axis.low) / (axis.high - axis.low), 0.0, 1.0);
    };
    // Where all values are positive, upright is the middle.
    const auto angle = [](const Axis& axis) {
      const double upright = axis.low < 0.0 ? 0.0 : 0.5 * (axis.low + axis.high);
      return std::clamp(axis.degrees * (axis.value - upright), -90.0, 90.0);
    };
    Pen pen{share(*known.pressure), std::nullopt, known.eraser};
    if (known.tilt_x && known.tilt_y) pen.tilt_deg = {angle(*known.tilt_x), angle(*known.tilt_y)};
    return pen;
  }
  return std::nullopt;
}

}  // namespace fettle::render
