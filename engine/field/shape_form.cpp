#include "engine/field/shape_form.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

constexpr double kMostRise = 16.0;  // [diagonals of the field]
constexpr double kLeastAcross =
    1e-3;  // of a cone, the cosine of the angle between normal and plane across the axis

// m of a shape, and of a cone what its nappe is known by: m n.a.
struct AlongAxis {
  double m = 0.0, nappe = 0.0;

  explicit AlongAxis(const ShapeForm& form) noexcept {
    if (form.shape == FormShape::kCylinder) m = form.curvature;
    if (form.shape != FormShape::kCone) return;
    const glm::dvec3 across = glm::cross(form.normal, form.axis);
    m = form.curvature / glm::dot(across, across);
    nappe = m * glm::dot(form.normal, form.axis);
  }
};

// The equation A z^2 - 2 h z + C = 0 for the height z above the foot at (x, y) from it [mm]: A is `bend`, h grows by
// slope_x, slope_y, C is quadratic.
struct Quadric {
  double bend, normal_z, slope_x, slope_y;
  double xx, xy, yy, x, y;
  double nappe_x, nappe_y, nappe_z;  // on this side of the apex where 1 + nappe.d > 0
  double most;                       // [mm]

  explicit Quadric(const ShapeForm& form) noexcept {
    const double k = form.curvature;
    const glm::dvec3& n = form.normal;
    const glm::dvec3& a = form.axis;
    const auto [m, nappe] = AlongAxis(form);
    bend = k - m * a.z * a.z;
    normal_z = n.z;
    slope_x = m * a.x * a.z;
    slope_y = m * a.y * a.z;
    xx = k - m * a.x * a.x;
    xy = -2.0 * m * a.x * a.y;
    yy = k - m * a.y * a.y;
    x = -2.0 * n.x;
    y = -2.0 * n.y;
    nappe_x = nappe * a.x;
    nappe_y = nappe * a.y;
    nappe_z = nappe * a.z;
    const double wide = form.width * form.spacing_x_mm, tall = form.height * form.spacing_y_mm;
    most = kMostRise * std::sqrt(wide * wide + tall * tall);
  }

  struct At {
    double z;
    bool beyond;
  };
  // Without branches, so that samples side by side go through vector registers.
  [[nodiscard]] At at(double dx, double dy) const noexcept {
    const double h = normal_z + (slope_x * dx + slope_y * dy);
    const double c = ((xx * dx + xy * dy + x) * dx) + ((yy * dy + y) * dy);
    const double square = h * h - bend * c;
    const double root = std::sqrt(square > 0.0 ? square : 0.0);
    // The same number; the first is without cancellation for a normal that is upwards where the plane of the foot is met.
    const double on = h > 0.0 ? c / (h + root) : (h - root) / bend;
    const double nappe = 1.0 + (nappe_x * dx + nappe_y * dy + nappe_z * on);
    const bool beyond = !(square >= 0.0) || !(nappe > 0.0);
    double z = beyond ? h / bend : on;
    z = z < most ? z : most;  // takes a NaN, of 0 / 0 where a generator is vertical, to `most`
    z = z > -most ? z : -most;
    return {z, beyond};
  }
};

}  // namespace

double ShapeForm::heightAt(double at_column, double at_row) const noexcept {
  const Quadric quadric(*this);
  return base + quadric.at((at_column - column) * spacing_x_mm, (at_row - row) * spacing_y_mm).z / height_mm;
}

void ShapeForm::readHeights(const SampleRect& rect, double* out, std::ptrdiff_t stride) const noexcept {
  const Quadric quadric(*this);
  for (int r = 0; r < rect.rows; ++r) {
    double* const line = out + r * stride;
    const double dy = (static_cast<double>(rect.row + r) - row) * spacing_y_mm;
    for (int c = 0; c < rect.columns; ++c)
      line[c] =
          base + quadric.at((static_cast<double>(rect.column + c) - column) * spacing_x_mm, dy).z / height_mm;
  }
}

bool ShapeForm::beyondOutline(double at_column, double at_row) const noexcept {
  const Quadric quadric(*this);
  return quadric.at((at_column - column) * spacing_x_mm, (at_row - row) * spacing_y_mm).beyond;
}

std::optional<ShapeForm> ShapeForm::aboutFootAt(double at_column, double at_row) const noexcept {
  const Quadric quadric(*this);
  const double dx = (at_column - column) * spacing_x_mm, dy = (at_row - row) * spacing_y_mm;
  const Quadric::At there = quadric.at(dx, dy);
  if (there.beyond || !(std::abs(there.z) < quadric.most)) return std::nullopt;
  // Half the gradient of the equation at d, which is as long as the normal but on a cone, where k and m grow to the apex.
  const glm::dvec3 d(dx, dy, there.z);
  const glm::dvec3 up = normal - curvature * d + AlongAxis(*this).m * glm::dot(axis, d) * axis;
  const double length = glm::length(up);
  if (!(up.z >= kLeastUpwards * length && length > 0.0)) return std::nullopt;
  ShapeForm moved = *this;
  moved.column = at_column;
  moved.row = at_row;
  moved.base = base + there.z / height_mm;
  moved.normal = up / length;
  moved.curvature = curvature / length;
  return moved;
}

double ShapeForm::radius() const noexcept {
  return 1.0 / std::abs(curvature);
}

double ShapeForm::halfAngle() const noexcept {
  return std::atan2(std::abs(glm::dot(normal, axis)), glm::length(glm::cross(normal, axis)));
}

ShapeForm ShapeForm::inverted() const noexcept {
  ShapeForm form = *this;
  form.base = -base;
  form.normal = {-normal.x, -normal.y, normal.z};
  form.axis.z = -axis.z;
  form.curvature = -curvature;
  return form;
}

bool ShapeForm::sound() const noexcept {
  constexpr double kLengths = 1e-9, kLeast = 1e-30, kMost = 1e30;
  const auto within = [](double value, double least, double most) { return value >= least && value <= most; };
  const bool scales = within(spacing_x_mm, kLeast, kMost) && within(spacing_y_mm, kLeast, kMost) &&
                      within(height_mm, kLeast, kMost);
  if (!scales || !(std::abs(base) <= double{std::numeric_limits<float>::max()})) return false;
  const double wide = width * spacing_x_mm, tall = height * spacing_y_mm;
  const double diagonal = std::sqrt(wide * wide + tall * tall);
  constexpr double kFarthest = 1e6, kMostBent = 1e9;  // [sides of the field], [1 / diagonal]
  if (!(std::abs(column) <= kFarthest * width && std::abs(row) <= kFarthest * height)) return false;
  if (!(std::abs(curvature) * diagonal <= kMostBent && std::abs(curvature) * diagonal > 0.0)) return false;
  if (!(normal.z >= kLeastUpwards && std::abs(glm::dot(normal, normal) - 1.0) <= kLengths &&
        std::abs(glm::dot(axis, axis) - 1.0) <= kLengths))
    return false;
  const double along = glm::dot(normal, axis);
  if (shape == FormShape::kCylinder) return std::abs(along) <= kLengths;
  if (shape == FormShape::kCone) return glm::length(glm::cross(normal, axis)) >= kLeastAcross;
  return true;
}

}  // namespace fettle::engine
