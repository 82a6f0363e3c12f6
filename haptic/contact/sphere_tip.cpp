#include "haptic/contact/sphere_tip.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace fettle::haptic {

namespace {

constexpr double kTolerance = 1e-6;
constexpr double kRest = 1e-4;
// Margin around the centre with which the window is loaded, in steps: a hand at 50 mm/s over cells of 0.05
// mm.
constexpr double kRoomSteps = 2.0;
// Searches within so many steps of each other share what the window gathers; 0.05 and 0.15 cost as much.
constexpr double kNearSteps = 0.1;
// BallSteps::kInSpace: a step is tried again with the contacts it met, and finally shorter.
constexpr int kCutRounds = 6;
constexpr int kHalvings = 12;
// BallSteps::kInPlan: before the third time it may end on top of what is in its way, at its end or at half of it; finally it
// becomes shorter by quarters.
constexpr int kCutRoundsBeforeDrop = 2;
constexpr int kQuarterings = 6;
constexpr int kDrops = 2;
// Heights tried where a ball is put on top of what is in its way.
constexpr int kDropHeights = 2;
constexpr int kLiftHeights = 6;
// What a search counts for among steep cells, all of whose minima are searched for.
constexpr int kSteepSearch = 2;
// Steep cells within reach from which a place is looked at by its samples before it is searched; a ball of two cells
// among needles has 8.
constexpr int kDearSearch = 12;
// Tries that a tick makes whatever its work, so that every tick leads on.
constexpr int kLeastTries = 2;
// Curvature along a step at least, of that of a plane seen from the endpoint: where the way bends downwards, Newton's step is
// at most ten times as long as the plain one.
constexpr double kLeastStiffness = 0.1;
// A tick in plan also ends where the next step would be shorter than so many rests, if it were as much shorter than the last
// one as that is than the one before; Newton's becomes shorter faster.
constexpr double kNextRests = 10.0;

double smallerSpacing(const engine::Grid& grid) noexcept {
  return std::min(grid.spacingXMm(), grid.spacingYMm());
}

double length2(const glm::dvec3& a) noexcept {
  return glm::dot(a, a);
}

}  // namespace

std::optional<std::string> sphereProblem(double radius_mm, const engine::Grid& grid) {
  const double most = kMostSphereCells * smallerSpacing(grid);
  if (radius_mm > 0.0 && radius_mm <= most) return std::nullopt;
  return fmt::format("the tip's radius must be above 0 and at most {} mm on this field, {} of its cells",
                     most, kMostSphereCells);
}

SphereTracker::SphereTracker(double radius_mm, const engine::Grid& grid, int most_steps, SphereSearch search,
                             int most_searches, BallMinima minima, BallSteps steps, int most_work) noexcept
    : plan_(steps == BallSteps::kInPlan),
      most_steps_(std::clamp(most_steps, 1, kSphereSteps)),
      most_searches_(std::clamp(most_searches, 0, kMostBallSearches)),
      most_work_(plan_ ? std::clamp(most_work, 0, kMostBallWork) : 0),
      search_(search),
      window_(minima, steps) {
  const double cell = smallerSpacing(grid);
  radius_ = std::min(radius_mm, kMostSphereCells * cell);
  // The lens that a step s cuts from a ball is s^2 / (8 r) deep: cell / 16 in the middle of the range.
  step_ = cell * std::clamp(std::sqrt(0.5 * radius_ / cell), 0.25, 1.0);
  slack_ = radius_ < cell ? step_ : 0.1 * cell;
  tolerance_ = kTolerance * std::min(radius_, cell);
}

double SphereTracker::toleranceMm(double height_mm) const noexcept {
  return tolerance_ + 1e-14 * (std::abs(height_mm) + radius_) +
         8e-16 * (std::abs(centre_.x) + std::abs(centre_.y));
}

// Whether nothing reaches up to the ball anywhere in the box around a and b.
bool SphereTracker::clearOfAll(const Surface& surface, const glm::dvec3& a,
                               const glm::dvec3& b) const noexcept {
  const engine::FieldReader& reader = surface.reader();
  const double low = std::min(a.z, b.z) - radius_;
  const auto below = [&](const engine::HeightBounds& bounds) {
    return bounds.empty() || static_cast<double>(bounds.max) * surface.heightUnit() < low;
  };
  if (below(reader.bounds())) return true;
  const double x0 = (std::min(a.x, b.x) - radius_) / surface.spacingX();
  const double x1 = (std::max(a.x, b.x) + radius_) / surface.spacingX();
  const double y0 = (std::min(a.y, b.y) - radius_) / surface.spacingY();
  const double y1 = (std::max(a.y, b.y) + radius_) / surface.spacingY();
  if (!(x0 <= surface.cellColumns() && x1 >= 0.0 && y0 <= surface.cellRows() && y1 >= 0.0)) return true;
  const auto block = [](double x, std::int32_t samples) {
    return static_cast<std::int32_t>(std::clamp(x, 0.0, samples - 1.0)) >> 3;
  };
  // One sample more to the right and up: the far corners of the last cells.
  const std::int32_t c0 = block(x0, reader.width());
  const std::int32_t c1 = block(x1 + 1.0, reader.width());
  const std::int32_t r0 = block(y0, reader.height());
  const std::int32_t r1 = block(y1 + 1.0, reader.height());
  if (c1 - c0 > 7 || r1 - r0 > 7) return false;
  for (std::int32_t r = r0; r <= r1; ++r)
    for (std::int32_t c = c0; c <= c1; ++c)
      if (!below(reader.bounds(0, c, r))) return false;
  return true;
}

void SphereTracker::hold(const Surface& surface, const glm::dvec3& centre) noexcept {
  if (!window_.holds(centre)) window_.load(surface, centre, radius_ + slack_, kRoomSteps * step_);
}

// Of a place that the window holds.
int SphereTracker::steepCells(const glm::dvec3& centre) noexcept {
  if (counted_at_ != centre) {
    counted_ = window_.steepCells(centre, radius_ + slack_);
    counted_at_ = centre;
  }
  return counted_;
}

// Whether a search there would be dear and would find material nearer than `distance`. It decides by the field alone,
// whatever was loaded or gathered before.
bool SphereTracker::dearAndInTheWay(const Surface& surface, const glm::dvec3& centre,
                                    double distance) noexcept {
  if (most_work_ == 0) return false;
  hold(surface, centre);
  return steepCells(centre) > kDearSearch && window_.columnWithin(centre, distance);
}

void SphereTracker::findContacts(const Surface& surface, const glm::dvec3& centre,
                                 SphereContactList& out) noexcept {
  hold(surface, centre);
  const double reach = radius_ + slack_;
  searches_ += plan_ && window_.steepNear(centre, reach) ? kSteepSearch : 1;
  // Below the surface there are no contacts to look for: the ball is lifted.
  out.below = window_.heightUnder(centre) > centre.z;
  if (out.below) {
    out.count = 0;
    out.nearest_mm = HUGE_VAL;
    list_centres_[&out == &lists_[0] ? 0 : 1] = centre;
    return;
  }
  if (most_work_ > 0) work_ += steepCells(centre);
  if (search_ == SphereSearch::kBounded) [[likely]] {
    window_.contacts(centre, reach, kNearSteps * step_, out);
  } else {
    window_.contactsCellByCell(centre, reach, out);
  }
  list_centres_[&out == &lists_[0] ? 0 : 1] = centre;
}

// Data of an earlier tick is discarded when the surface may have changed.
void SphereTracker::discardEdited(const Surface& surface) noexcept {
  if (felt_ == &surface && felt_refreshes_ == surface.refreshes()) return;
  felt_ = &surface;
  felt_refreshes_ = surface.refreshes();
  window_.invalidate();
  list_centres_.fill(glm::dvec3(NAN));
}

// How far a centre must rise for what it reaches into there, by planes.
double SphereTracker::riseOutOf(const SphereContactList& there, const glm::dvec3& centre) const noexcept {
  double rise = 0.0;
  SphereContact under;
  if (there.below && window_.under(centre, under)) rise = under.point_mm.z - centre.z + 0.5 * radius_;
  for (int k = 0; k < there.count; ++k) {
    const SphereContact& t = there.contacts[static_cast<std::size_t>(k)];
    if (t.distance_mm < radius_ && t.normal.z > 0.0)
      rise = std::max(rise, (radius_ - t.distance_mm) / t.normal.z);
  }
  return rise;
}

// Moves the centre straight up out of the material: the material grown by the ball is all below one height.
// In space by bisection, which ends less than the tolerance above it. In plan, where a step may fall from any height, on top of
// the samples and then out of what lies between them; if that is not found soon, above all of the window.
void SphereTracker::lift(const Surface& surface) noexcept {
  SphereContactList& near = lists_[here_];
  const auto isFree = [&](double z) {
    const glm::dvec3 at(centre_.x, centre_.y, z);
    if (dearAndInTheWay(surface, at, radius_)) return false;
    findContacts(surface, at, near);
    return !near.below && near.nearest_mm >= radius_;
  };
  if (isFree(centre_.z)) return;
  if (plan_) {
    const double top = std::max(centre_.z, window_.highestNear(centre_, radius_)) + 1.001 * radius_;
    const double past = 0.5 * toleranceMm(std::max(std::abs(centre_.z), std::abs(top)));
    for (int i = 0; i < kLiftHeights; ++i) {
      const double z = i == 0 ? std::max(centre_.z, window_.overSamples(centre_, radius_))
                              : centre_.z + riseOutOf(near, centre_);
      centre_.z = z + past;
      if (!(centre_.z < top) || (most_work_ > 0 && work_ >= most_work_)) break;
      if (isFree(centre_.z)) return;
    }
    centre_.z = top;
    findContacts(surface, centre_, near);
    return;
  }
  double low = centre_.z;
  double high = std::max(low, window_.highest()) + 1.001 * radius_;
  const double enough = 0.5 * toleranceMm(std::max(std::abs(low), std::abs(high)));
  for (int i = 0; i < 200 && high - low > enough; ++i) {
    const double middle = 0.5 * (low + high);
    (isFree(middle) ? high : low) = middle;
  }
  centre_.z = high;
  findContacts(surface, centre_, near);
}

// The half-space that a contact at the goal adds for a step from the centre: the surface's own plane there
// when the centre satisfies it (flat and concave parts), else the plane perpendicular to the line from the
// point to the centre, which the centre always satisfies (Newton's step towards touching the point).
HalfSpace SphereTracker::cutFor(const glm::dvec3& point, const glm::dvec3& normal) const noexcept {
  const glm::dvec3 from = centre_ - point;
  const double offset = radius_ - glm::dot(normal, from);
  if (offset <= 0.0) return {normal, offset};
  const double distance = glm::length(from);
  if (!(distance > 0.0)) return {normal, offset};
  return {from / distance, radius_ - distance};
}

int SphereTracker::halfSpacesAt(const SphereContactList& near) noexcept {
  for (int i = 0; i < near.count; ++i) {
    const SphereContact& t = near.contacts[static_cast<std::size_t>(i)];
    half_spaces_[static_cast<std::size_t>(i)] = {t.normal, radius_ - t.distance_mm};
  }
  return near.count;
}

// Adds what the ball met at a goal: the two deepest contacts there, or the surface above its centre.
int SphereTracker::addCuts(const glm::dvec3& to, SphereContactList& there, double tolerance, int seen,
                           int cuts) noexcept {
  const auto add = [&](const SphereContact& t) {
    // Replaces the oldest.
    const int at = cuts < kMostCuts ? cuts++ : oldest_cut_++ % kMostCuts;
    half_spaces_[static_cast<std::size_t>(seen + at)] = cutFor(t.point_mm, t.normal);
    cuts_[static_cast<std::size_t>(at)] = t;
  };
  SphereContact under;
  if (there.below) {
    if (window_.under(to, under)) add(under);
    return cuts;
  }
  for (int n = 0; n < 2; ++n) {
    SphereContact* deepest = nullptr;
    for (int i = 0; i < there.count; ++i) {
      SphereContact& t = there.contacts[static_cast<std::size_t>(i)];
      if (t.distance_mm < radius_ - tolerance && (deepest == nullptr || t.distance_mm < deepest->distance_mm))
        deepest = &t;
    }
    if (deepest == nullptr) break;
    add(*deepest);
    deepest->distance_mm = radius_;  // used; the list is searched again after this
  }
  return cuts;
}

// The part of a step along the planes that hold it.
glm::dvec3 SphereTracker::slideOf(const Projection& step) const noexcept {
  const auto normal = [&](int k) -> const glm::dvec3& {
    return half_spaces_[static_cast<std::size_t>(step.active[static_cast<std::size_t>(k)])].normal;
  };
  if (step.count == 1) return step.y - glm::dot(step.y, normal(0)) * normal(0);
  if (step.count == 2) {
    const glm::dvec3 along = glm::cross(normal(0), normal(1));
    return along * (glm::dot(along, step.y) / glm::dot(along, along));
  }
  return glm::dvec3(0.0);
}

// The step with the active contacts taken as curved, as they are: along it Newton's step for the distance to
// the endpoint (the second derivative of the Lagrangian function; Nocedal and Wright 2006, "Numerical
// Optimization", section 18.1), out of it by what the curve rises on the way. False when it equals the plain
// step or, in space, there is no minimum in that direction.
bool SphereTracker::bentStep(const Projection& step, const glm::dvec3& slide, int seen, double longest,
                             glm::dvec3& out) const noexcept {
  if (step.count < 1 || step.count > 2) return false;
  const double long2 = length2(slide);
  if (!(long2 > 1e-20 * step_ * step_)) return false;
  const auto touch = [&](int k) -> const SphereContact& {
    const int index = step.active[static_cast<std::size_t>(k)];
    return index < seen ? lists_[static_cast<std::size_t>(here_)].contacts[static_cast<std::size_t>(index)]
                        : cuts_[static_cast<std::size_t>(index - seen)];
  };
  const auto normal = [&](int k) -> const glm::dvec3& {
    return half_spaces_[static_cast<std::size_t>(step.active[static_cast<std::size_t>(k)])].normal;
  };
  const glm::dvec3 a = slide / std::sqrt(long2);
  glm::dvec3 along;
  double rise[2] = {0.0, 0.0};
  if (step.count == 2) {
    const double bend0 = window_.bend(centre_, touch(0), a, a);
    const double bend1 = window_.bend(centre_, touch(1), a, a);
    double stiff = 1.0 - step.share[0] * bend0 - step.share[1] * bend1;
    if (plan_) stiff = std::max(stiff, kLeastStiffness);
    if (!(stiff > 0.05)) return false;
    along = slide / stiff;
    rise[0] = -0.5 * bend0 * length2(along);
    rise[1] = -0.5 * bend1 * length2(along);
    const double g = glm::dot(normal(0), normal(1));
    const double det = 1.0 - g * g;
    if (!(det > 1e-6)) return false;
    out = step.y - slide + along + ((rise[0] - g * rise[1]) / det) * normal(0) +
          ((rise[1] - g * rise[0]) / det) * normal(1);
    return true;
  }
  const glm::dvec3 b = glm::cross(normal(0), a);
  const double aa = window_.bend(centre_, touch(0), a, a);
  const double ab = window_.bend(centre_, touch(0), a, b);
  const double bb = window_.bend(centre_, touch(0), b, b);
  const double m00 = 1.0 - step.share[0] * aa;
  const double m01 = -step.share[0] * ab;
  const double m11 = 1.0 - step.share[0] * bb;
  const double det = m00 * m11 - m01 * m01;
  double sa = std::sqrt(long2);
  double sb = 0.0;
  if (m00 > 0.05 && m11 > 0.05 && det > 0.05 * 0.05) {
    sb = -sa * m01 / det;
    sa = sa * m11 / det;
  } else if (plan_) {
    // No minimum: along the slide alone, farther than the plain step.
    sa = std::min(sa / std::max(m00, kLeastStiffness), 0.9 * longest / std::hypot(a.x, a.y));
  } else {
    return false;
  }
  along = sa * a + sb * b;
  out = step.y - slide + along - 0.5 * (sa * sa * aa + 2.0 * sa * sb * ab + sb * sb * bb) * normal(0);
  return true;
}

// Moves a step that ends slightly inside the material out of it by the shortest path, according to the
// contacts there.
bool SphereTracker::liftedOut(const SphereContactList& there, glm::dvec3& step) noexcept {
  if (there.below || there.nearest_mm < radius_ - slack_) return false;
  const int count = halfSpacesAt(there);
  const Projection out = projectOnHalfSpaces(glm::dvec3(0.0), half_spaces_.data(), count, 0.01 * tolerance_);
  if (!out.solved) return false;
  step += out.y;
  return true;
}

SphereTracker::Arrival SphereTracker::walk(const Surface& surface, const glm::dvec3& endpoint,
                                           TickCounters& counters) noexcept {
  const double tolerance = toleranceMm(std::max(std::abs(centre_.z), std::abs(endpoint.z)));
  const double rest = tolerance * (kRest / kTolerance);
  Projection step;
  int seen = 0;
  int made_from = here_;  // the list that the last step's half-spaces are of
  int steps = 0;
  oldest_cut_ = 0;
  glm::dvec3 last{0.0};  // the step before
  double longest = step_;
  Arrival arrival = Arrival::kBound;
  const int last_search = most_searches_ > 0 ? (plan_ ? first_search_ : searches_) + most_searches_
                                             : std::numeric_limits<int>::max();
  const int last_work = most_work_ > 0 ? first_work_ + most_work_ : std::numeric_limits<int>::max();
  const Unfinished begun = std::exchange(unfinished_, {});
  int cuts = begun.cuts;
  int tries = 0;  // in this tick
  const auto limited = [this](const glm::dvec3& a) { return plan_ ? glm::dvec3(a.x, a.y, 0.0) : a; };
  for (; steps < most_steps_ && searches_ < last_search && (steps == 0 || work_ < last_work) &&
         arrival == Arrival::kBound;
       ++steps) {
    const glm::dvec3 goal = endpoint - centre_;
    made_from = here_;
    const auto takeHalfSpaces = [&] {
      seen = halfSpacesAt(lists_[here_]);
      for (int k = 0; k < cuts; ++k) {
        const glm::dvec3 from = centre_ - cuts_[static_cast<std::size_t>(k)].point_mm;
        const double distance = glm::length(from);
        half_spaces_[static_cast<std::size_t>(seen + k)] = {from / distance, radius_ - distance};
      }
    };
    takeHalfSpaces();
    // An edit may have raised the surface into the ball: half of it is undone per step.
    const double reach_in = std::max(tolerance, 0.5 * (radius_ - lists_[here_].nearest_mm));
    SphereContactList& there = lists_[1 - here_];
    const glm::dvec3 start = centre_;
    bool refused = false;  // whether the last try was in the way of samples, and not searched
    const auto tryOut = [&](const glm::dvec3& to) {
      ++tries;
      refused = dearAndInTheWay(surface, to, radius_ - reach_in - tolerance);
      if (refused) return false;
      findContacts(surface, to, there);
      if (there.below || !(there.nearest_mm >= radius_ - reach_in)) return false;
      centre_ = to;
      return true;
    };
    // Whether it is no farther from the endpoint but for what moves it out of the material again.
    const bool inside = lists_[here_].nearest_mm < radius_ - tolerance;
    const double farthest = glm::length(goal) + tolerance;
    const auto nearer = [&](const glm::dvec3& to) {
      return inside || length2(endpoint - to) <= farthest * farthest;
    };
    // In plan a step may end at its bound of searches, but for the first, which makes sure that a ball arrives. The first ends at
    // that of work, and the next tick goes on with it.
    const auto spent = [&] {
      return plan_ && ((steps > 0 && searches_ >= last_search) ||
                       (work_ >= last_work && (steps > 0 || tries >= kLeastTries)));
    };
    const Unfinished go_on = steps == 0 ? begun : Unfinished{};
    double part = 1.0;
    double limit = 1.0;  // of the step's length, after places that were refused
    bool dropped = false;
    double bent_length2 = -1.0;  // squared length of a bent step that was taken
    bool moved = false;
    int drop = go_on.drop;
    bool drop_tried = false;
    glm::dvec3 slide{0.0};
    // On top of what is in its way: the free space has no ceiling.
    const auto drops = [&] {
      double length = std::ldexp(part, -drop);
      for (; drop < kDrops && !spent(); ++drop, length *= 0.5) {
        glm::dvec3 to = centre_ + length * step.y;
        hold(surface, to);
        for (int i = 0; i < kDropHeights && !spent(); ++i) {
          to.z = (i == 0 ? std::max(to.z, window_.overSamples(to, radius_)) : to.z + riseOutOf(there, to)) +
                 0.5 * tolerance;
          if (!nearer(to)) break;
          drop_tried = true;
          if (tryOut(to)) return true;
          if (refused) break;
        }
      }
      return false;
    };
    const int rounds = kCutRounds + (plan_ ? kQuarterings : kHalvings);
    int round = 0;
    for (; round < rounds && !moved && !spent(); ++round) {
      if (plan_ && round == kCutRoundsBeforeDrop) {
        dropped = moved = drops();
        if (moved || spent()) break;
      }
      if (round < kCutRounds) {
        step = projectOnHalfSpaces(goal, half_spaces_.data(), seen + cuts, 0.01 * tolerance);
        if (!step.solved) break;
        const double far = glm::length(limited(step.y));
        const double back = glm::dot(limited(step.y), limited(last));
        if (round == 0) {
          // The step reverses the last one, as in a bowl narrower than the press is deep, where each step is
          // too long: half of the last length, then slowly more again, so that steps shrink for any
          // curvature.
          const double came = glm::length(limited(last));
          longest = back < 0.0 && -2.0 * back > far * came ? 0.5 * came : std::min(step_, 1.3 * longest);
        }
        part = limit * (far > longest ? longest / far : 1.0);
        slide = slideOf(step);
        glm::dvec3 bent;
        if (round == 0 && go_on.round == 0 && bentStep(step, slide, seen, longest, bent) &&
            length2(limited(bent)) <= longest * longest) {
          const auto shortens = [&] { return length2(goal - bent) < length2(goal); };
          if (shortens()) {
            moved = tryOut(centre_ + bent);
            if (!moved && !refused && !spent() && liftedOut(there, bent) && shortens())
              moved = tryOut(centre_ + bent);
          }
          bent_length2 = length2(bent);
          if (moved) break;
          bent_length2 = -1.0;
          if (spent()) break;
          takeHalfSpaces();
        }
      } else {
        part *= plan_ ? 0.25 : 0.5;
      }
      const glm::dvec3 to = centre_ + part * step.y;
      if (plan_ && !nearer(to)) break;
      moved = tryOut(to);
      if (moved) continue;
      if (!refused) {
        if (round < kCutRounds - 1) cuts = addCuts(to, there, tolerance, seen, cuts);
      } else if (round < kCutRoundsBeforeDrop) {
        round = kCutRoundsBeforeDrop - 1;
      } else if (round < kCutRounds) {
        limit *= 0.25;
      }
      if (round < go_on.round) {  // after the try that a hand that has moved is due
        round = go_on.round - 1;
        limit = go_on.limit;
        if (round + 1 >= kCutRounds) part *= limit;
      }
    }
    if (!moved && steps == 0 && spent()) {
      if (round >= kCutRounds) limit *= std::ldexp(1.0, -2 * (round - kCutRounds));
      unfinished_ = {cuts, std::max(round, 1), drop + (drop_tried ? 1 : 0), limit};
    }
    if (!moved && spent()) break;
    if (!moved) {
      // No step left apart from rounding: the ball stays where it is.
      counters.search_bound_hits += step.solved ? 0 : 1;
      arrival = Arrival::kTouching;
      break;
    }
    here_ = 1 - here_;
    const double before = glm::length(last);
    last = centre_ - start;
    if (dropped) continue;
    const double length_2 = bent_length2 >= 0.0 ? bent_length2 : part * part * length2(step.y);
    const bool newtons = bent_length2 >= 0.0 || (step.count == 3 && part == 1.0);
    if (step.count == 0 && part == 1.0)
      arrival = Arrival::kFree;
    else if (length_2 <= rest * rest || (plan_ && newtons && length_2 <= kNextRests * rest * before))
      arrival = Arrival::kTouching;
    else if (length_2 > 0.01 * step_ * step_)
      cuts = 0;
  }
  counters.longest_search = std::max<std::int64_t>(counters.longest_search, steps);
  counters.search_bound_hits += arrival == Arrival::kBound ? 1 : 0;
  if (arrival == Arrival::kFree) {
    centre_ = endpoint;
    return arrival;
  }
  if (arrival == Arrival::kBound && step.count == 0 && most_searches_ > 0) return Arrival::kUnheldOnItsWay;
  int most = 0;
  for (int k = 1; k < step.count; ++k)
    if (step.share[static_cast<std::size_t>(k)] > step.share[static_cast<std::size_t>(most)]) most = k;
  if (step.count > 0) {
    const int index = step.active[static_cast<std::size_t>(most)];
    pressed_ = index < seen ? lists_[made_from].contacts[static_cast<std::size_t>(index)]
                            : cuts_[static_cast<std::size_t>(index - seen)];
  }
  return arrival;
}

Contact SphereTracker::update(Surface& surface, const glm::dvec3& endpoint, TickCounters& counters) noexcept {
  Contact contact;
  const bool was_placed = placed_;
  searches_ = first_search_ = 0;
  work_ = first_work_ = 0;
  counted_at_ = glm::dvec3(NAN);
  const glm::dvec3 moved = endpoint - previous_;
  previous_ = endpoint;
  placed_ = true;
  if (!touching_ && clearOfAll(surface, was_placed ? centre_ : endpoint, endpoint)) {
    unfinished_ = {};
    centre_ = endpoint;
    CellIndex cell;
    counters.outside += surface.cellUnder(endpoint, cell) ? 0 : 1;
    return contact;
  }
  const int steps = most_searches_ > 0 ? std::min(kSphereSteps, most_searches_) : kSphereSteps;
  const double farthest = steps * step_;
  discardEdited(surface);
  if (!was_placed || !(length2(moved) <= farthest * farthest)) {
    centre_ = endpoint;
    unfinished_ = {};
    lift(surface);
  } else {
    // The contacts of a ball at rest were found by the last tick.
    if (list_centres_[static_cast<std::size_t>(here_)] != centre_)
      findContacts(surface, centre_, lists_[here_]);
    first_search_ = searches_;
    first_work_ = work_;
    if (lists_[here_].below || lists_[here_].nearest_mm < 0.5 * radius_) lift(surface);
  }
  Arrival arrival = walk(surface, endpoint, counters);
  if (lists_[here_].nearest_mm < radius_ - toleranceMm(centre_.z)) lift(surface);  // raised by an edit
  // A hand that pulls out is free at once: up and over at the height of the endpoint, where nothing reaches up to that way.
  if (most_work_ > 0 && arrival != Arrival::kFree &&
      clearOfAll(surface, {centre_.x, centre_.y, endpoint.z}, endpoint)) {
    centre_ = endpoint;
    unfinished_ = {};
    arrival = Arrival::kFree;
  }
  touching_ = arrival != Arrival::kFree;
  if (!touching_) return contact;
  if (arrival == Arrival::kUnheldOnItsWay) {
    SphereContactList& there = lists_[1 - here_];
    const bool found = dearAndInTheWay(surface, endpoint, radius_);
    if (!found) findContacts(surface, endpoint, there);
    if (!found && !there.below && there.nearest_mm >= radius_) return contact;
  }

  contact.touching = true;
  contact.penetration_mm = centre_ - endpoint;
  const glm::dvec3 away = pressed_.point_mm - endpoint;
  contact.proxy = {pressed_.cell, pressed_.u, pressed_.v, pressed_.point_mm, length2(away)};
  return contact;
}

}  // namespace fettle::haptic
