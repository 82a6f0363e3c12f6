#include "app/window/flight.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace fettle::app {
namespace {

using render::Camera;
using render::View;

// Of the viewer's distance: a point that is looked at must not be beside or behind a perspective viewer.
constexpr double kNearestLooked = 0.75;

double nearestLooked(const View& view) {
  return view.projection == render::Projection::kOrthographic ? HUGE_VAL : kNearestLooked;
}

// How far along their axes, towards the viewer, two views look at nearly the same point: where the axes are
// nearest to each other, within `reach` of the middles of the pictures [mm].
struct Looked {
  double first = 0.0, last = 0.0;
};
Looked lookedAt(const Camera& a, const Camera& b, double reach) {
  const glm::dvec3 between = b.target() - a.target();
  const double cosine = glm::dot(a.toViewer(), b.toViewer());
  const double along_a = glm::dot(between, a.toViewer()), along_b = glm::dot(between, b.toViewer());
  const double square = 1.0 - cosine * cosine;
  // Of parallel axes every point is as near: the middle of the first picture.
  if (square < 1e-12) return {0.0, std::clamp(-cosine * along_a, -reach, reach)};
  return {std::clamp((along_a - cosine * along_b) / square, -reach, reach),
          std::clamp((cosine * along_a - along_b) / square, -reach, reach)};
}

// From rest to rest: the polynomial of least degree without a jump of the acceleration.
double eased(double t) {
  return t * t * t * (10.0 + t * (6.0 * t - 15.0));
}

}  // namespace

void Flight::begin(const View& from, const View& to, const render::Framing& framing, Clock::time_point now) {
  from_ = from;
  to_ = to;
  framing_ = framing;
  begun_ = now;
  active_ = true;
  turn_deg_ = std::remainder(to.azimuth_deg - from.azimuth_deg, 360.0);
  const Camera a = framing.camera(from), b = framing.camera(to);
  const Looked looked = lookedAt(a, b, 2.0 * framing.longerSide());
  nearer_first_ = std::min(looked.first, nearestLooked(from) * a.distance());
  nearer_last_ = std::min(looked.last, nearestLooked(to) * b.distance());
  first_ = a.target() + nearer_first_ * a.toViewer();
  last_ = b.target() + nearer_last_ * b.toViewer();
  const double side = std::min(framing.plot.width, framing.plot.height);
  path_ =
      ZoomPath(glm::length(last_ - first_), side / a.pixelsPerMmAt(first_), side / b.pixelsPerMmAt(last_));
}

View Flight::at(double way) const {
  View view = to_;
  view.azimuth_deg = std::remainder(from_.azimuth_deg + way * turn_deg_, 360.0);
  view.elevation_deg = from_.elevation_deg + way * (to_.elevation_deg - from_.elevation_deg);
  const ZoomPath::Place place = path_.at(way);
  view.zoom = 1.0;
  Camera unit = framing_.camera(view);
  const double nearer =
      std::min(glm::mix(nearer_first_, nearer_last_, way), nearestLooked(view) * unit.distance());
  const glm::dvec3 looked = glm::mix(first_, last_, place.share);
  framing_.aimAt(looked - nearer * unit.toViewer(), view);
  unit = framing_.camera(view);
  const double side = std::min(framing_.plot.width, framing_.plot.height);
  view.zoom = std::clamp(side / place.across / unit.pixelsPerMmAt(looked), 1e-3, 1e6);
  return view;
}

void Flight::follow(View& view, Clock::time_point now) {
  if (!active_) return;
  const double way = std::chrono::duration<double>(now - begun_) / kTime;
  const bool ends = !(way < 1.0) || from_.vertical_exaggeration != to_.vertical_exaggeration;
  View next = ends ? to_ : at(eased(std::max(way, 0.0)));
  next.width = view.width;
  next.height = view.height;
  view = next;
  active_ = !ends;
}

}  // namespace fettle::app
