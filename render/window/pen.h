#pragma once

#include <optional>

#include <glm/vec2.hpp>

namespace fettle::render {

/// A tablet's pen whose tip is on the tablet.
struct Pen {
  double pressure = 0.0;  ///< 0 .. 1 of what the tablet measures
  /// How far it leans to the right and towards the user [degrees], -90 .. 90; nothing where the tablet does not measure it.
  std::optional<glm::dvec2> tilt_deg;
  bool eraser = false;  ///< it is held the other way round
  friend bool operator==(const Pen&, const Pen&) = default;
};

}  // namespace fettle::render
