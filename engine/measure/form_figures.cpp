#include "engine/measure/form_figures.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

namespace fettle::engine {

std::optional<Tilt> tiltOf(const NominalForm& form, const Grid& grid) {
  const PolynomialForm* polynomial = form.polynomial();
  if (polynomial == nullptr || polynomial->degree == 0) return std::nullopt;
  const PolynomialForm::Gradient gradient = polynomial->gradient();
  const auto degrees = [](double slope) { return std::atan(slope) * 180.0 / std::numbers::pi; };
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return Tilt{degrees(gradient.by_column * grid.height_unit.mm / grid.spacingXMm()),
              degrees(gradient.by_row * grid.height_unit.mm / grid.spacingYMm()), kNone, kNone};
}

Shape shapeOfForm(const ShapeForm& form) {
  const glm::dvec3 foot(form.column * form.spacing_x_mm, form.row * form.spacing_y_mm,
                        form.base * form.height_mm);
  const glm::dvec3 &n = form.normal, &a = form.axis;
  Shape shape;
  shape.hollow = form.curvature > 0.0;
  switch (form.shape) {
    case FormShape::kSphere:
      shape.kind = ShapeKind::kSphere;
      break;
    case FormShape::kCylinder:
      shape.kind = ShapeKind::kCylinder;
      shape.direction = inAxisSense(a);
      break;
    case FormShape::kCone: {
      shape.kind = ShapeKind::kCone;
      shape.half_angle = form.halfAngle();
      // Along the generator through the foot, n and a in one plane with it.
      const double along = glm::dot(n, a);
      const glm::dvec3 to_apex = (along * n - a) / (form.curvature * along);
      shape.point = foot + to_apex;
      shape.direction = glm::dot(to_apex, a) > 0.0 ? -a : a;
      return shape;
    }
  }
  shape.radius = form.radius();
  shape.point = foot + n / form.curvature;
  return shape;
}

}  // namespace fettle::engine
