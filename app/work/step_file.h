#pragma once

#include <string>
#include <vector>

#include "engine/measure/fit_samples.h"
#include "engine/measure/fit_shape.h"

namespace fettle::app {

/// A shape as far as samples show it: a face between two values of each of its parameters, those of ISO 10303-42. u turns
/// about `axis` from `start` [rad], of a plane it is a length along `start`; v is a length along the axis, of a sphere and a
/// torus an angle.
struct BoundedShape {
  std::string name;
  engine::Shape shape;
  glm::dvec3 origin{0.0}, axis{0.0, 0.0, 1.0}, start{1.0, 0.0, 0.0};
  double radius = 0.0;  ///< of a cone at `origin`
  double u_from = 0.0, u_to = 0.0, v_from = 0.0, v_to = 0.0;
};

/// The shape between the bounds of samples, in faces of less than a turn each.
[[nodiscard]] std::vector<BoundedShape> boundedBy(const std::string& name, const engine::Shape& shape,
                                                  const engine::FitSamples& samples);

/// A STEP file (ISO 10303-21, AP 214) with an open shell of one face for each, in millimetres; the same bytes each time.
/// Written here and not by Open CASCADE: docs/decisions/step-of-its-own.md.
[[nodiscard]] std::string stepFile(const std::string& product, const std::vector<BoundedShape>& faces);

}  // namespace fettle::app
