#include "app/window/navigation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fettle::app {
namespace {

constexpr double kZoomPerStep = 1.15;

double extentX(const engine::Grid& grid) {
  return std::max(grid.width - 1, 1) * grid.spacingXMm();
}
double extentY(const engine::Grid& grid) {
  return std::max(grid.height - 1, 1) * grid.spacingYMm();
}

}  // namespace

void Navigation::showAll(render::View& view) noexcept {
  view.zoom = 1.0;
  view.centre_x = view.centre_y = 0.5;
}

void Navigation::turn(render::View& view, double dx_px, double dy_px, double picture_px) noexcept {
  const double degrees = 180.0 / std::max(picture_px, 1.0);
  view.azimuth_deg = std::remainder(view.azimuth_deg - dx_px * degrees, 360.0);
  view.elevation_deg = std::clamp(view.elevation_deg + dy_px * degrees, kLowestElevation_deg, 90.0);
}

void Navigation::pan(render::View& view, const engine::Grid& grid, double dx_px, double dy_px,
                     double pixels_per_mm) noexcept {
  if (!(pixels_per_mm > 0.0)) return;
  const double a = view.azimuth_deg * std::numbers::pi / 180.0;
  const double e = view.elevation_deg * std::numbers::pi / 180.0;
  // Farther from the viewer the field is foreshortened; near the horizon a pixel would be infinitely far.
  const double right = -dx_px / pixels_per_mm;
  const double away = dy_px / (pixels_per_mm * std::max(std::sin(e), 0.1));
  view.centre_x += (right * std::cos(a) - away * std::sin(a)) / extentX(grid);
  view.centre_y += (right * std::sin(a) + away * std::cos(a)) / extentY(grid);
  view.centre_x = std::clamp(view.centre_x, -0.5, 1.5);
  view.centre_y = std::clamp(view.centre_y, -0.5, 1.5);
}

void Navigation::zoom(render::View& view, const engine::Grid& grid, double steps, double dx_px, double dy_px,
                      double pixels_per_mm) noexcept {
  const double before = view.zoom;
  view.zoom = std::clamp(before * std::pow(kZoomPerStep, steps), kSmallestZoom, kLargestZoom);
  // The point under the cursor moves away from the middle by the factor: compensate.
  const double grown = view.zoom / before;
  pan(view, grid, dx_px * (1.0 - grown), dy_px * (1.0 - grown), pixels_per_mm * grown);
}

void Navigation::centreOn(render::View& view, const engine::Grid& grid, double x_mm, double y_mm) noexcept {
  view.centre_x = x_mm / extentX(grid);
  view.centre_y = y_mm / extentY(grid);
}

void Navigation::show(render::View& view, const engine::Grid& grid, double x_mm, double y_mm,
                      double extent_mm) noexcept {
  centreOn(view, grid, x_mm, y_mm);
  // A zoom of 1 shows all of the field.
  const double all_mm = std::max(extentX(grid), extentY(grid));
  view.zoom = std::clamp(all_mm / (3.0 * std::max(extent_mm, 1e-9 * all_mm)), 1.0, kLargestZoom);
}

}  // namespace fettle::app
