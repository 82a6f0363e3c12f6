#include "bench/least_search.h"

#include <algorithm>

#include "engine/field/live_field.h"
#include "haptic/contact/closest_on_cell.h"
#include "haptic/contact/closest_point.h"
#include "haptic/contact/hull_distance.h"
#include "haptic/contact/normal.h"
#include "haptic/scene/scene.h"
#include "haptic/tick/tick.h"

namespace fettle::bench {

using haptic::CellIndex;
using haptic::Patch;
using haptic::PatchPoint;

namespace {

bool isInside(const PatchPoint& point) noexcept {
  return point.u > 0.0 && point.u < 1.0 && point.v > 0.0 && point.v < 1.0;
}

std::int8_t sideOf(double x) noexcept {
  return static_cast<std::int8_t>(x == 0.0 ? -1 : (x == 1.0 ? 1 : 0));
}

}  // namespace

LeastSearch::LeastSearch(const engine::Version& field, std::span<const haptic::StrokeSample> strokes)
    : heights_(field) {
  engine::LiveField live(field, engine::Growth::kAllowed);
  haptic::Tick tick(haptic::defaultScene(), live, field);
  haptic::Surface surface(field.reader());
  haptic::SurfacePoint proxy;
  bool touching = false;
  for (const haptic::StrokeSample& sample : strokes) {
    (void)tick.run(sample);
    const haptic::Contact& contact = tick.contact();
    if (contact.touching && touching) {
      ++contacts_;
      CellIndex cell = proxy.cell;
      double u = proxy.u, v = proxy.v;
      for (;;) {
        PatchPoint at = haptic::closestOnCell(heights_.patch(cell), sample.tip_mm, u, v);
        steps_.push_back(
            {sample.tip_mm, cell.column, cell.row, u, v, isInside(at), false, sideOf(at.u), sideOf(at.v)});
        newton_cells_ += isInside(at) ? 1 : 0;
        samples_ += 4;
        CellIndex next = cell;
        haptic::forEachSharing(surface, cell, at.u, at.v, [&](const haptic::SharingCell& other) {
          const PatchPoint point =
              haptic::closestOnCell(heights_.patch(other.cell), sample.tip_mm, other.u, other.v);
          if (!(point.distance2_mm2 < haptic::shorterThan(at.distance2_mm2, sample.tip_mm))) return;
          at = point;
          next = other.cell;
          u = other.u;
          v = other.v;
        });
        if (next == cell) break;
        cell = next;
      }
      Step& rest = steps_.back();
      rest.last = true;
      samples_ += rest.du != 0 && rest.dv != 0 ? 5 : (rest.du != 0 || rest.dv != 0 ? 2 : 0);
    }
    touching = contact.touching;
    proxy = contact.proxy;
  }
}

double LeastSearch::run() const noexcept {
  double sum = 0.0;
  for (const Step& step : steps_) {
    const Patch s = heights_.patch({step.column, step.row});
    const PatchPoint at = step.newton ? haptic::closestOnPatch(s, step.endpoint_mm, step.u, step.v)
                                      : haptic::closestOnEdges(s, step.endpoint_mm);
    if (!step.last) continue;
    const glm::dvec3 point = s.at(at.u, at.v);
    sum += point.z;
    const glm::dvec3 away = step.endpoint_mm - point;
    // Samples outside the field stand for nothing here: hands keep away from the border.
    const auto rise = [&](int du, int dv) {
      const std::int32_t column = std::max(step.column + (at.u == 1.0 ? 1 : 0) + du, 0);
      const std::int32_t row = std::max(step.row + (at.v == 1.0 ? 1 : 0) + dv, 0);
      const std::size_t i =
          std::min(static_cast<std::size_t>(row) * static_cast<std::size_t>(heights_.width) +
                       static_cast<std::size_t>(column),
                   heights_.samples.size() - 1);
      return away.x * (column * heights_.spacing_x_mm - point.x) +
             away.y * (row * heights_.spacing_y_mm - point.y) +
             away.z * (heights_.unit_mm * static_cast<double>(heights_.samples[i]) - point.z);
    };
    double highest = 0.0;
    if (step.du != 0 && step.dv != 0)
      highest = std::max({rise(step.du, 0), rise(0, step.dv), rise(step.du, -step.dv),
                          rise(-step.du, step.dv), rise(step.du, step.dv)});
    else if (step.du != 0)
      highest = std::max(rise(step.du, 0), rise(step.du, 1));
    else if (step.dv != 0)
      highest = std::max(rise(0, step.dv), rise(1, step.dv));
    sum += highest;
  }
  return sum;
}

}  // namespace fettle::bench
