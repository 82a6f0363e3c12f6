#include "haptic/contact/contact.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "haptic/contact/certified.h"
#include "haptic/contact/closest_point.h"
#include "haptic/contact/collision.h"
#include "haptic/contact/descent.h"

namespace fettle::haptic {

namespace {

SearchResult counted(const SearchResult& result, TickCounters& counters) noexcept {
  counters.search_bound_hits += result.end == SearchEnd::kBound ? 1 : 0;
  counters.longest_search = std::max<std::int64_t>(counters.longest_search, result.cells);
  return result;
}

// The contact test at what a search found. Where distance is at a local minimum over all cells that share the
// point, the penetration vector is made of their normals with weights of one sign, and all normals have
// z > 0: its z decides the side, and no normal is computed (four square roots at a vertex).
bool touchesAt(Surface& surface, const SearchResult& found, const glm::dvec3& endpoint,
               TickCounters& counters, Contact& out) noexcept {
  if (!found.ringed) return contactTest(surface, found.point, endpoint, counters, out);
  out.proxy = found.point;
  out.penetration_mm = found.point.position_mm - endpoint;
  return out.penetration_mm.z > 0.0;
}

}  // namespace

SearchResult ContactTracker::search(Surface& surface, const glm::dvec3& endpoint, CellIndex start, double u,
                                    double v, TickCounters& counters) const noexcept {
  return counted(level_ == ContactLevel::kDescent
                     ? searchDownhill(surface, endpoint, start, u, v, search_rounds_)
                     : searchClosest(surface, endpoint, start, u, v),
                 counters);
}

bool contactTest(Surface& surface, const SurfacePoint& proxy, const glm::dvec3& endpoint,
                 TickCounters& counters, Contact& out) noexcept {
  const SurfaceNormal normal = surfaceNormal(surface, proxy);
  out.proxy = proxy;
  out.penetration_mm = proxy.position_mm - endpoint;
  const bool positive = glm::dot(out.penetration_mm, normal.direction) > 0.0;
  const bool below = out.penetration_mm.z > 0.0;
  if (normal.cells == 4 && positive != below) {
    ++counters.mean_normal_overruled;
    return below;
  }
  return positive;
}

bool ContactTracker::track(Surface& surface, const glm::dvec3& endpoint, TickCounters& counters,
                           Contact& out) noexcept {
  const SearchResult found = search(surface, endpoint, cell_, u_, v_, counters);
  if (found.end == SearchEnd::kHole) {
    ++counters.lost_cell;
    return false;
  }
  return touchesAt(surface, found, endpoint, counters, out);
}

bool ContactTracker::collide(Surface& surface, const glm::dvec3& endpoint, bool below, CellIndex own,
                             TickCounters& counters, Contact& out) noexcept {
  const glm::dvec3 from = has_previous_ ? previous_ : endpoint;
  const auto searchFrom = [&](CellIndex cell, const glm::dvec3& above) {
    const double u = std::clamp(above.x / surface.spacingX() - cell.column, 0.0, 1.0);
    const double v = std::clamp(above.y / surface.spacingY() - cell.row, 0.0, 1.0);
    const SearchResult found = search(surface, endpoint, cell, u, v, counters);
    return touchesAt(surface, found, endpoint, counters, out);
  };

  RayWalk walk(surface, from, endpoint);
  RayCell candidate;
  // The number of searches from cells that the ray may touch is limited: the endpoint's own cell, tried last,
  // does not depend on them.
  constexpr int kMaxSearches = 16;
  int searches = 0;
  while (searches < kMaxSearches && walk.next(candidate)) {
    if (!below) {
      Patch patch;
      if (!surface.patch(candidate.cell, patch) ||
          !entersPatch(patch, from, endpoint, candidate.enter, candidate.leave))
        continue;
    }
    ++searches;
    if (searchFrom(candidate.cell, from + candidate.leave * (endpoint - from))) return true;
  }
  counters.search_bound_hits += walk.stoppedByBound() ? 1 : 0;
  if (!below) return false;
  if (searchFrom(own, endpoint)) return true;
  // Below the surface, but every local search ended on a part that faces away: the closest point of the
  // neighbouring cells cannot. Rare (spikes), so its cost does not matter.
  SurfacePoint closest;
  const double cell = std::max(surface.spacingX(), surface.spacingY());
  return certifiedClosest(surface, endpoint, cell, closest) &&
         contactTest(surface, closest, endpoint, counters, out);
}

bool ContactTracker::staysAbove(CellIndex own, const Patch& own_patch, const glm::dvec3& endpoint,
                                bool below) const noexcept {
  return !below && has_previous_ && previous_over_cell_ && previous_cell_ == own &&
         !entersPatch(own_patch, previous_, endpoint, 0.0, 1.0);
}

void ContactTracker::update(Surface& surface, const glm::dvec3& endpoint, TickCounters& counters,
                            Contact& contact) noexcept {
  contact.touching = false;
  CellIndex own;
  Patch own_patch;
  const bool inside = surface.cellUnder(endpoint, own);
  const bool over_cell = inside && surface.patch(own, own_patch);
  if (!over_cell) {
    if (!inside)
      ++counters.outside;
    else if (endpoint.z <= static_cast<double>(surface.reader().bounds().max) * surface.heightUnit())
      ++counters.over_hole;
    touching_ = false;
  } else {
    const bool below = belowPatch(own_patch, endpoint);
    const bool was_touching = touching_;
    if (level_ == ContactLevel::kCertified) {
      SurfacePoint closest;
      if (below) {
        const double radius = radius_cells_ * std::max(surface.spacingX(), surface.spacingY());
        contact.touching = certifiedClosest(surface, endpoint, radius, closest);
        if (contact.touching && !contactTest(surface, closest, endpoint, counters, contact))
          ++counters.mean_normal_overruled;
      }
    } else {
      contact.touching = (was_touching && track(surface, endpoint, counters, contact)) ||
                         (!staysAbove(own, own_patch, endpoint, below) &&
                          collide(surface, endpoint, below, own, counters, contact));
    }
    touching_ = contact.touching;
    if (touching_) {
      cell_ = contact.proxy.cell;
      u_ = contact.proxy.u;
      v_ = contact.proxy.v;
      if (!was_touching && has_previous_ && !previous_over_cell_) ++counters.side_entries;
    } else if (below) {
      ++counters.below_without_contact;
    }
  }
  previous_ = endpoint;
  previous_over_cell_ = over_cell;
  previous_cell_ = own;
  has_previous_ = true;
}

}  // namespace fettle::haptic
