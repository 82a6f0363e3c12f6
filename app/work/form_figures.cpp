#include "app/work/form_figures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "engine/measure/form_figures.h"

namespace fettle::app {

namespace {

Report vectorOf(const glm::dvec3& v) {
  return Report::array({v.x, v.y, v.z});
}

// "3, 4.1, -12", to a part in 1e5 of the largest.
std::string numbersText(const Report& vector) {
  double most = 0.0;
  for (const Report& number : vector) most = std::max(most, std::abs(number.get<double>()));
  const double unit = most > 0.0 ? std::pow(10.0, std::floor(std::log10(most)) - 4.0) : 1.0;
  std::string text;
  for (const Report& number : vector) {
    // No -0.
    const double rounded = std::round(number.get<double>() / unit) * unit + 0.0;
    text += fmt::format("{}{:.5g}", text.empty() ? "" : ", ", rounded);
  }
  return text;
}

}  // namespace

void addShape(Report& report, const engine::Shape& shape) {
  report["point_mm"] = vectorOf(shape.point);
  if (shape.kind != engine::ShapeKind::kSphere) report["direction"] = vectorOf(shape.direction);
  if (shape.kind == engine::ShapeKind::kCone)
    report["half_angle_deg"] = shape.half_angle * 180.0 / std::numbers::pi;
  else
    report["radius_mm"] = shape.radius;
  report["hollow"] = shape.hollow;
}

void addFormFigures(Report& report, const engine::NominalForm& form, const engine::Grid& grid) {
  if (const engine::ShapeForm* shape = form.shape()) return addShape(report, engine::shapeOfForm(*shape));
  if (const auto tilt = engine::tiltOf(form, grid)) {
    report["tilt_x"] = tilt->x_deg;
    report["tilt_y"] = tilt->y_deg;
    return;
  }
  report["level"] = form.heightAt(0.0, 0.0);
}

std::string formFiguresText(const Report& report, const std::string& unit) {
  if (report.contains("level")) return fmt::format("at {:.6g} {}", report["level"].get<double>(), unit);
  if (report.contains("tilt_x"))
    return fmt::format("tilted {:.4g} degrees along x, {:.4g} along y", report["tilt_x"].get<double>(),
                       report["tilt_y"].get<double>());
  const std::string hollow = report["hollow"].get<bool>() ? ", hollow" : "",
                    point = numbersText(report["point_mm"]);
  if (report.contains("half_angle_deg"))
    return fmt::format("half angle {:.4g} degrees{}, apex at {} mm, axis along {}",
                       report["half_angle_deg"].get<double>(), hollow, point,
                       numbersText(report["direction"]));
  const std::string radius = fmt::format("radius {:.5g} mm{}", report["radius_mm"].get<double>(), hollow);
  if (report.contains("direction"))
    return fmt::format("{}, axis through {} mm along {}", radius, point, numbersText(report["direction"]));
  return fmt::format("{}, centre at {} mm", radius, point);
}

std::string formFigures(const engine::NominalForm& form, const engine::Grid& grid) {
  Report report;
  addFormFigures(report, form, grid);
  return formFiguresText(report, grid.height_unit.name);
}

}  // namespace fettle::app
