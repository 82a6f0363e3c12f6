#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include <xcb/xinput.h>

#include "render/window/pen.h"

namespace fettle::render {

/// Names of what a pen measures, as numbers of the display; XCB_ATOM_NONE: no driver has used that name.
struct PenLabels {
  xcb_atom_t pressure = XCB_ATOM_NONE;
  xcb_atom_t tilt_x = XCB_ATOM_NONE;
  xcb_atom_t tilt_y = XCB_ATOM_NONE;
};

/// Reads pens out of what an X server says with its extension XInput, version 2 (X.Org: "The X Input Extension 2.x", XI2proto).
/// Devices that measure pressure are pens. An event lists the values that changed; the others stay. Nothing is believed about
/// lengths: what does not fit into its message is left out. Threading: one thread at a time.
class PenDecoder {
 public:
  /// The devices that there are now; what is known of those that stay is kept.
  void describe(const xcb_input_xi_query_device_reply_t& devices, const PenLabels& labels);
  /// The numbers of the pens.
  [[nodiscard]] std::vector<xcb_input_device_id_t> pens() const;
  /// An event of this extension, as libxcb returns it. What is not of a pen has no effect.
  void take(const xcb_ge_generic_event_t& event);
  /// The pen whose tip is down.
  [[nodiscard]] std::optional<Pen> down() const;

 private:
  struct Axis {
    std::uint16_t number = 0;  // of its value in an event
    double low = 0.0, high = 1.0;
    double degrees = 1.0;  // of a unit
    double value = 0.0;
  };
  struct Known {
    std::optional<Axis> pressure, tilt_x, tilt_y;
    bool eraser = false;
    bool down = false;
  };
  [[nodiscard]] static std::optional<Known> pen(const xcb_input_xi_device_info_t& info,
                                                const PenLabels& labels);
  static void takeValue(Known& pen, std::uint32_t number, double value);

  std::map<xcb_input_device_id_t, Known> pens_;
};

}  // namespace fettle::render
