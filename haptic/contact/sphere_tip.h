#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include <glm/vec3.hpp>

#include "engine/field/grid.h"
#include "haptic/base/search_limits.h"
#include "haptic/base/tick_counters.h"
#include "haptic/contact/contact.h"
#include "haptic/contact/sphere_solve.h"
#include "haptic/contact/sphere_window.h"
#include "haptic/contact/surface.h"

namespace fettle::haptic {

/// Largest radius, in cells of the smaller spacing.
inline constexpr double kMostSphereCells = 16.0;

/// Steps of one tick, at most.
inline constexpr int kSphereSteps = 128;

/// Why a ball of this radius cannot feel a field of this grid; nothing when it can.
[[nodiscard]] std::optional<std::string> sphereProblem(double radius_mm, const engine::Grid& grid);

/// Contact of a ball of radius r: what ContactTracker is for a point.
///
///                 o  centre = proxy of the god-object: never in the material, as near to the endpoint as it
///              .     .                                                           can slide without leaving
///              it
///             .   o   .        contact.penetration_mm = centre - endpoint
///   ____      .   |   .  ____
///       \______ . | .___/      contact.proxy = the point of the surface that the ball presses on most
///                 x            pressed().normal = from there to the centre
///              endpoint
///
/// A ball on a height field is equivalent to a point on another one: the material M = all at or below the
/// surface, grown by the ball, is all at or below H(x, y) = max over |d| <= r of h((x, y) + d) + sqrt(r^2 -
/// |d|^2). So the free space is connected, a centre can always be lifted out of the material, and the tip
/// touches exactly when the endpoint is within r of the material or below the surface.
///
/// One tick: the centre starts where it was and moves towards the endpoint in steps. A step is the projection
/// of the endpoint on the half-spaces n . (x - p) >= r of all contacts nearby: their active set, at most
/// three, supports the ball (Zilles and Salisbury 1995). For a convex part of the surface the half-space is
/// an inner approximation, so the step and the path to it stay out of it. With one or two contacts the ball
/// can slide along them: there the step is Newton's on the curved surface rather than on its planes, and when
/// it ends slightly inside the material it is moved out by the shortest path. Where that fails, the plain
/// step is taken, and what rises into the ball on its path (concave parts) is added as a further half-space
/// and the step is computed again. Every step makes the centre's distance to the endpoint smaller, so the
/// ball comes to rest on both walls of a groove and does not jump between them. It ends when a step is
/// shorter than the tolerance, or after the largest number of steps or searches (counted in search_bound_hits; the
/// centre is free of the material and continues in the next tick). They bound the tick's time: a ball that rolls into
/// another hollow needs a few ticks for it, and one that is moved through free space faster than that lags behind. On
/// its way, where nothing holds it, it touches when a ball at the endpoint would: so a tip at rest keeps its contact.
///
/// BallSteps::kInPlan. Since M is all at or below H, a step from one free centre to another may be taken as one in
/// plan at the greater height and one straight down, and only the first can step over anything. So a step is
/// limited in plan alone, and a ball falls down a wall or a needle of any height at once. What is in its way twice, it
/// ends on top of. A ball that is placed is lifted on top of the samples and out of what lies between them; if it
/// ends too high, it falls. Where the distance bends downwards along the way, so that Newton's step has no minimum,
/// it is ten times as long as the plain one at most. The tick also ends where the next step would be
/// shorter than ten rests by the ratio of the last two. The bound of searches ends a step as well, but
/// for the first of a tick; a search among steep cells (BallMinima::kAll) counts as two.
/// Its bound of work (contact revision 5). A search takes as long as there are steep cells within reach, and deep among needles
/// there are many: a place there that is in the material below some sample is not searched, and the step ends on top of what
/// is in its way, or becomes shorter. When the searches of a tick have looked at so many steep cells, no further try begins, in its
/// first step neither, which the next tick goes on with; and where nothing reaches up to a ball at the endpoint's height
/// on its way there, it is free at once.
/// BallSteps::kInSpace is the walk of before contact revision 4: no step is longer than a cell in any direction, a ball that is
/// placed is lifted by halvings.
///
/// The samples around the ball, and the contacts where it rests, are kept from tick to tick until the surface
/// is refreshed.
///
/// Sources: Zilles, Salisbury 1995, "A constraint-based god-object method for haptic display"; Ruspini,
/// Kolarov, Khatib 1997, "The haptic display of complex graphical environments" (ball as proxy); Serra 1982,
/// "Image analysis and mathematical morphology" (dilation by a ball); Nocedal and Wright 2006, "Numerical
/// Optimization", section 18.1 (Newton's step under constraints).
///
/// Errors. The ball reaches into the material by at most toleranceMm(): 1e-6 of the smaller of radius and
/// spacing, plus roundings of the heights; beside a needle of slope 1e6, whose valley rounding hides, by up to
/// its radius; with BallMinima::kPieces beside needles from 200 times as high as a cell is wide. Where it reached in and is pushed out, a tick may end farther from the endpoint than the one before, by the
/// tolerance times sqrt(1 + slope^2). At rest no step longer than 1e-4 of that size makes it nearer; in plan, 1e-3 in a tick
/// that moved it. Continuity: steps are at most between a quarter of a cell and a cell, and both ends are free of
/// the material. A ball cannot step over anything that would lift its centre by more than s^2 / (8 r) for a
/// step s: 1/16 of a cell for r = 2 cells. A hand that moves more steps in one tick than a tick may take or search is
/// placed again, lifted out vertically, as at the first tick; so is a centre that an edit left inside the
/// material.
///
/// Holes and borders. A ball rests on the rim of a hole that is too small for it, and falls into a larger
/// one; there, and outside the field, walls support it sideways, unlike the point tip, which nothing supports
/// there.
///
/// As r -> 0 the centre goes to the closest point of the surface that the point tip has.
///
/// Threading: one thread; wait-free, noexcept, allocates nothing.
class SphereTracker {
 public:
  /// `radius_mm` > 0; over kMostSphereCells cells it is clamped to that (sphereProblem reports it before).
  /// `most_steps`, 1 .. kSphereSteps, of a tick. `most_searches`, 1 .. kMostBallSearches, after which no step begins;
  /// 0: no such bound, and a ball on its way counts as touching, as before contact revision 3 (scene.h). In plan fewer than some
  /// 25 do not shorten a tick whose first step needs them. `most_work`, 0 .. kMostBallWork: steep cells that the searches of a
  /// tick in plan may look at; 0: no such bound, as before contact revision 5.
  SphereTracker(double radius_mm, const engine::Grid& grid, int most_steps = kSphereSteps,
                SphereSearch search = SphereSearch::kBounded, int most_searches = kBallSearches,
                BallMinima minima = BallMinima::kAll, BallSteps steps = BallSteps::kInPlan,
                int most_work = kBallWork) noexcept;

  /// One tick. `endpoint` is finite. `surface` is the field as it now is: edits since the last tick are felt,
  /// by Surface::refreshes().
  [[nodiscard]] Contact update(Surface& surface, const glm::dvec3& endpoint, TickCounters& counters) noexcept;

  /// Discards the centre, as before the first tick.
  void reset() noexcept {
    placed_ = false;
    touching_ = false;
    unfinished_ = {};
  }

  /// Centre after the last tick [mm]; equal to the endpoint while nothing is touched.
  [[nodiscard]] const glm::dvec3& centre() const noexcept { return centre_; }
  /// The contact that carries most of the force, while touching: contact.proxy with its normal.
  [[nodiscard]] const SphereContact& pressed() const noexcept { return pressed_; }
  /// Searches for contacts in the last tick: what its time is proportional to. In plan one among steep cells counts as two.
  [[nodiscard]] int searches() const noexcept { return searches_; }
  /// Steep cells that these searches looked at, while there is a bound of them: what its time is proportional to beside needles.
  [[nodiscard]] int work() const noexcept { return work_; }
  [[nodiscard]] double toleranceMm(double height_mm) const noexcept;

 private:
  enum class Arrival : std::uint8_t { kFree, kTouching, kBound, kUnheldOnItsWay };

  [[nodiscard]] bool clearOfAll(const Surface& surface, const glm::dvec3& a,
                                const glm::dvec3& b) const noexcept;
  void hold(const Surface& surface, const glm::dvec3& centre) noexcept;
  [[nodiscard]] int steepCells(const glm::dvec3& centre) noexcept;
  [[nodiscard]] bool dearAndInTheWay(const Surface& surface, const glm::dvec3& centre,
                                     double distance) noexcept;
  void findContacts(const Surface& surface, const glm::dvec3& centre, SphereContactList& out) noexcept;
  void discardEdited(const Surface& surface) noexcept;
  [[nodiscard]] double riseOutOf(const SphereContactList& there, const glm::dvec3& centre) const noexcept;
  void lift(const Surface& surface) noexcept;
  [[nodiscard]] HalfSpace cutFor(const glm::dvec3& point, const glm::dvec3& normal) const noexcept;
  [[nodiscard]] int halfSpacesAt(const SphereContactList& near) noexcept;
  [[nodiscard]] int addCuts(const glm::dvec3& to, SphereContactList& there, double tolerance, int seen,
                            int cuts) noexcept;
  [[nodiscard]] glm::dvec3 slideOf(const Projection& step) const noexcept;
  [[nodiscard]] bool bentStep(const Projection& step, const glm::dvec3& slide, int seen, double longest,
                              glm::dvec3& out) const noexcept;
  [[nodiscard]] bool liftedOut(const SphereContactList& there, glm::dvec3& step) noexcept;
  [[nodiscard]] Arrival walk(const Surface& surface, const glm::dvec3& endpoint,
                             TickCounters& counters) noexcept;

  static constexpr int kMostCuts = 16;

  // A first step that the bound of work ended before it moved: what it met, and where its tries go on.
  struct Unfinished {
    int cuts = 0;
    int round = 0;
    int drop = 0;
    double limit = 1.0;  // of the step's length
  };

  bool plan_;  // whether steps are limited in plan alone
  int most_steps_;
  int most_searches_;
  int most_work_;  // 0: no bound
  SphereSearch search_;
  double radius_, step_, slack_, tolerance_;
  glm::dvec3 centre_{0.0};
  glm::dvec3 previous_{0.0};  // endpoint
  bool placed_ = false;
  bool touching_ = false;
  SphereContact pressed_;  // the contact with the largest share of the force, after walk()
  SphereWindow window_;
  int here_ = 0;  // index of the centre's list; the other is for the next position
  std::array<SphereContactList, 2> lists_;
  std::array<glm::dvec3, 2> list_centres_{glm::dvec3(NAN), glm::dvec3(NAN)};  // centres of the lists
  const Surface* felt_ = nullptr;  // the surface of window and lists, and its refreshes() then
  std::uint64_t felt_refreshes_ = 0;
  std::array<HalfSpace, SphereContactList::kMost + kMostCuts> half_spaces_;
  std::array<SphereContact, kMostCuts> cuts_;
  int oldest_cut_ = 0;
  Unfinished unfinished_;
  int searches_ = 0;
  int work_ = 0;
  int first_work_ = 0;  // as first_search_
  int counted_ = 0;     // steep cells within reach of counted_at_, in this tick
  glm::dvec3 counted_at_{NAN};
  int first_search_ =
      0;  // searches before those that the bound counts: none but where the last tick's list was discarded
};

}  // namespace fettle::haptic
