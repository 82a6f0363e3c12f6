#include "app/window/navigation.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace fettle::app {
namespace {

using render::Camera;
using render::Framing;
using render::View;

constexpr double kZoomPerStep = 1.15;
constexpr double kTurnPerPicture_deg = 360.0;
// From here on a drag moves the ground under the cursor; nearer the horizon, where a pixel is far on the ground, a
// plane that faces the viewer.
constexpr double kGroundFrom_deg = 20.0;
constexpr double kGroundSlope = 0.15;  // of the ray under the cursor, at least: perspective sees the horizon
// How far in front of the middle of the picture a point may be that is turned about, of the viewer's distance; and
// how far from it, of the field's longer side: a perspective viewer must neither come too near nor move away for
// ever. Any distance leaves the point at its pixel.
constexpr double kNearestTurned = 0.75, kFarthestTurned = 2.0;
constexpr double kNearlyAll = 0.05;  // of the plot, by which what counts as seen may lie outside

bool isParallel(const View& view) {
  return view.projection == render::Projection::kOrthographic;
}

// The point on the axis of a parallel view that stands for all of them.
glm::dvec3 settled(const glm::dvec3& target, const View& view, const Framing& framing,
                   const glm::dvec3& to_viewer) {
  if (!isParallel(view)) return target;
  const glm::dvec3 from_middle = target - framing.middle();
  const double along = view.elevation_deg >= kGroundFrom_deg ? -from_middle.z / to_viewer.z
                                                             : -glm::dot(from_middle, to_viewer);
  return target + along * to_viewer;
}

// Half the longer side beyond the block; a view that is farther away already may stay there.
glm::dvec3 limited(const glm::dvec3& target, const glm::dvec3& before, const Framing& framing) {
  const double margin = 0.5 * framing.longerSide();
  const glm::dvec3 low = glm::min(framing.shown.low - margin, before);
  const glm::dvec3 high = glm::max(framing.shown.high + margin, before);
  return glm::clamp(target, low, high);
}

View withZoom(const View& view, double zoom) {
  View zoomed = view;
  zoomed.zoom = zoom;
  return zoomed;
}

}  // namespace

void Navigation::showAll(View& view) noexcept {
  view.zoom = 1.0;
  view.centre_x = view.centre_y = 0.5;
  view.centre_z = 0.0;
}

bool Navigation::seesAll(const View& view, const Framing& framing) {
  const Camera camera = framing.camera(view);
  const render::Rectangle& plot = framing.plot;
  const double beyond = kNearlyAll * std::min(plot.width, plot.height);
  const auto corners = render::corners(framing.shown);
  return std::all_of(corners.begin(), corners.end(), [&](const glm::dvec3& corner) {
    const glm::dvec2 at = camera.pixelOf(corner);
    return camera.pixelsPerMmAt(corner) > 0.0 && at.x >= plot.x - beyond && at.y >= plot.y - beyond &&
           at.x <= plot.x + plot.width + beyond && at.y <= plot.y + plot.height + beyond;
  });
}

void Navigation::turnAbout(View& view, const Framing& framing, const glm::dvec3& point, double azimuth_deg,
                           double elevation_deg) {
  const Camera before = framing.camera(view);
  const glm::dvec2 pixel = before.pixelOf(point);
  const glm::dvec3 offset = point - before.target();
  const double aside = glm::dot(before.right(), offset), above = glm::dot(before.up(), offset);
  const double size = before.pixelsPerMmAt(point);

  view.azimuth_deg = std::remainder(azimuth_deg, 360.0);
  view.elevation_deg = std::clamp(elevation_deg, 0.0, 90.0);
  // The distance to the viewer is another one from another side, as zoom 1 shows all from everywhere.
  const Camera unit = framing.camera(withZoom(view, 1.0));
  const double farthest = kFarthestTurned * framing.longerSide();
  const double nearer = isParallel(view) ? 0.0
                                         : std::clamp(glm::dot(before.toViewer(), offset), -farthest,
                                                      std::min(farthest, kNearestTurned * unit.distance()));
  const glm::dvec3 target = point - aside * unit.right() - above * unit.up() - nearer * unit.toViewer();
  framing.aimAt(settled(target, view, framing, unit.toViewer()), view);
  const double unit_size = framing.camera(withZoom(view, 1.0)).pixelsPerMmAt(point);
  const double zoom = size / unit_size;
  view.zoom = std::clamp(zoom, kSmallestTurned, kLargestTurned);
  if (view.zoom != zoom) put(view, framing, point, pixel);
}

void Navigation::turnBy(View& view, const Framing& framing, const glm::dvec3& point,
                        const glm::dvec2& drag_px, double picture_px) {
  const double degrees = kTurnPerPicture_deg / std::max(picture_px, 1.0);
  turnAbout(view, framing, point, view.azimuth_deg - drag_px.x * degrees,
            view.elevation_deg + drag_px.y * degrees);
}

void Navigation::put(View& view, const Framing& framing, const glm::dvec3& point, const glm::dvec2& pixel) {
  const Camera camera = framing.camera(view);
  const render::Ray ray = camera.rayAt(pixel);
  const bool ground = view.elevation_deg >= kGroundFrom_deg && ray.along.z < -kGroundSlope;
  const glm::dvec3 normal = ground ? glm::dvec3(0.0, 0.0, 1.0) : camera.toViewer();
  const double along = glm::dot(normal, point - ray.from) / glm::dot(normal, ray.along);
  const glm::dvec3 there = ray.from + along * ray.along;
  const glm::dvec3 moved = settled(camera.target() + (point - there), view, framing, camera.toViewer());
  const glm::dvec3 before = settled(camera.target(), view, framing, camera.toViewer());
  framing.aimAt(limited(moved, before, framing), view);
}

void Navigation::zoomAt(View& view, const Framing& framing, const glm::dvec3& point, double steps) {
  const glm::dvec2 pixel = framing.camera(view).pixelOf(point);
  const double before = view.zoom;
  view.zoom = std::clamp(before * std::pow(kZoomPerStep, steps), std::min(kSmallestZoom, before),
                         std::max(kLargestZoom, before));
  put(view, framing, point, pixel);
}

void Navigation::centreOn(View& view, const Framing& framing, const glm::dvec3& point) {
  framing.aimAt(settled(point, view, framing, render::axesOf(view).to_viewer), view);
}

void Navigation::show(View& view, const Framing& framing, const glm::dvec3& point, double extent_mm) {
  centreOn(view, framing, point);
  // A zoom of 1 shows all of the field.
  const double all_mm = framing.longerSide();
  view.zoom = std::clamp(all_mm / (3.0 * std::max(extent_mm, 1e-9 * all_mm)), 1.0, kLargestZoom);
}

void Navigation::lookFrom(View& view, const Framing& framing, const glm::dvec3& middle, double azimuth_deg,
                          double elevation_deg) {
  const bool all = seesAll(view, framing);
  turnAbout(view, framing, middle, azimuth_deg, elevation_deg);
  if (all) showAll(view);
}

}  // namespace fettle::app
