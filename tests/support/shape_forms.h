#pragma once

#include <cmath>
#include <random>

#include <glm/geometric.hpp>

#include "engine/field/grid.h"
#include "engine/field/shape_form.h"

namespace fettle::engine {

/// A sphere, cylinder or cone of any place, direction and size over a field, also one that ends within the field; sound.
/// Radii from a fifth of the field's diagonal to 1e4 times as much.
inline ShapeForm someShape(const Grid& grid, FormShape shape, double base, unsigned seed) {
  std::mt19937 random(seed);
  const auto real = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) * 0x1p-32;
  };
  const auto direction = [&] { return glm::normalize(glm::dvec3(real(-1, 1), real(-1, 1), real(0.01, 1))); };
  ShapeForm form;
  form.shape = shape;
  form.width = grid.width;
  form.height = grid.height;
  form.spacing_x_mm = grid.spacingXMm();
  form.spacing_y_mm = grid.spacingYMm();
  form.height_mm = grid.height_unit.mm;
  form.column = real(-0.2, 1.2) * grid.width;
  form.row = real(-0.2, 1.2) * grid.height;
  form.base = base;
  do form.normal = direction();
  while (form.normal.z < 0.1);
  const double diagonal = std::hypot(grid.width * form.spacing_x_mm, grid.height * form.spacing_y_mm);
  form.curvature =
      std::exp(-real(std::log(0.2), std::log(1e4))) / diagonal * (random() % 2 == 0 ? 1.0 : -1.0);
  if (shape != FormShape::kSphere) {
    const glm::dvec3 across = glm::normalize(glm::cross(form.normal, direction()));
    // Of a cone turned towards the normal: between a hundredth of a degree and 80 degrees.
    const double turn = shape == FormShape::kCone ? real(-1.4, 1.4) : 0.0;
    form.axis = glm::normalize(std::cos(turn) * across + std::sin(turn) * form.normal);
    if (shape == FormShape::kCylinder)
      form.axis = glm::normalize(form.axis - glm::dot(form.axis, form.normal) * form.normal);
  }
  return form;
}

}  // namespace fettle::engine
