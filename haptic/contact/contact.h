#pragma once

#include <glm/vec3.hpp>

#include "haptic/base/tick_counters.h"
#include "haptic/contact/normal.h"
#include "haptic/contact/search_result.h"
#include "haptic/contact/surface.h"
#include "haptic/scene/scene.h"

namespace fettle::haptic {

/// The outcome of one tick's contact.
struct Contact {
  bool touching = false;
  // The rest is valid only while touching.
  SurfacePoint proxy;
  glm::dvec3 penetration_mm{0.0};  ///< proxy minus endpoint; for the normal call surfaceNormal()
};

/// The two modes of the seed paper, as a state machine over ticks.
///
///                   search found, test positive
///        +------+  ----------------------------->  +------------+
///        | free |                                  | in contact |  keeps the proxy's cell and parameters
///        +------+  <-----------------------------  +------------+
///                   test not positive and none on the ray; endpoint outside the field or over a hole;
///                   bad input
///
/// Test: dot(proxy - endpoint, normal) > 0. Exactly zero, for example with an endpoint on the surface, is no
/// contact; its force would be zero.
///
/// Levels paper and descent. In contact, the search for the local closest point starts at the previous proxy. Free, or
/// when that finds no contact, it starts from the cells under the haptic ray (previous to current endpoint),
/// one after the other until the test is positive. All below the surface is material: an endpoint that is
/// below the surface of its own cell is found whatever the ray was, because its own cell is the ray's last.
/// When it is not, only a ray that comes down through a patch counts (it went through a wall within one
/// tick), so that a tip that passes above a ridge is not held by it. So a fast hand cannot fall through, and
/// a tip pushed out of the far side of a wall stays in contact with the near side until its proxy slides off.
///
/// Level certified. Has no memory but the endpoint: the tip touches when it is below the surface of its own
/// cell, and the proxy is the true closest point within the radius.
///
/// At all levels the tip touches only over a cell without holes: outside the field and over holes nothing is
/// felt (counted). The sides of the field and the walls of holes are no surface; a tip that enters the
/// material through them is in contact immediately (counted).
///
/// At a point that is a local minimum of the distance over all cells that share it the penetration vector is
/// a combination of their normals with weights of one sign, and all of these have z > 0: the sign of proxy.z
/// - endpoint.z is the test, and no normal is computed. The mean normal is used only where a hole, the border
/// or the search's bound ended the search early. It can point to the wrong side, for example at a pit with
/// slopes of 1 and 1000; where the two disagree over four cells the sign decides (counted).
///
/// Threading: one thread; wait-free, noexcept, allocates nothing.
class ContactTracker {
 public:
  ContactTracker(ContactLevel level, int certified_radius_cells, int search_rounds) noexcept
      : level_(level), radius_cells_(certified_radius_cells), search_rounds_(search_rounds) {}

  /// One tick. `endpoint` is finite. `surface` is the field as it now is: edits since the last tick are felt.
  /// `contact` is overwritten (in place, which saves copying 100 bytes per tick).
  void update(Surface& surface, const glm::dvec3& endpoint, TickCounters& counters,
              Contact& contact) noexcept;

  /// Discards contact and previous endpoint, as before the first tick: the next ray is a point.
  void reset() noexcept {
    touching_ = false;
    has_previous_ = false;
  }

 private:
  /// The search of the level, counted.
  [[nodiscard]] SearchResult search(Surface& surface, const glm::dvec3& endpoint, CellIndex start, double u,
                                    double v, TickCounters& counters) const noexcept;
  [[nodiscard]] bool track(Surface& surface, const glm::dvec3& endpoint, TickCounters& counters,
                           Contact& out) noexcept;
  [[nodiscard]] bool collide(Surface& surface, const glm::dvec3& endpoint, bool below, CellIndex own,
                             TickCounters& counters, Contact& out) noexcept;

  /// Whether a ray within one cell stays above its patch: no walk is needed then: it hits nothing.
  [[nodiscard]] bool staysAbove(CellIndex own, const Patch& own_patch, const glm::dvec3& endpoint,
                                bool below) const noexcept;

  ContactLevel level_;
  int radius_cells_;
  int search_rounds_;
  bool touching_ = false;
  bool has_previous_ = false;
  bool previous_over_cell_ = false;
  CellIndex previous_cell_;  // under previous_, if any
  glm::dvec3 previous_{0.0};
  CellIndex cell_;  // of the previous proxy, while touching
  double u_ = 0.0, v_ = 0.0;
};

/// The contact test by the mean normal at any surface point (see ContactTracker); fills proxy and
/// penetration.
[[nodiscard]] bool contactTest(Surface& surface, const SurfacePoint& proxy, const glm::dvec3& endpoint,
                               TickCounters& counters, Contact& out) noexcept;

}  // namespace fettle::haptic
