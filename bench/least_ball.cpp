#include "bench/least_ball.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include <glm/geometric.hpp>

#include "haptic/contact/patch.h"
#include "haptic/contact/sphere_solve.h"
#include "haptic/contact/sphere_tip.h"

namespace fettle::bench {

using haptic::CellIndex;
using haptic::Patch;

namespace {

// A step shorter than this part of a cell ends a tick, as in SphereTracker.
constexpr double kRestCells = 1e-4;
// How near the centre of the tracker is the same rest, in cells: it may stop ten rests before.
constexpr double kSameCells = 1e-2;
constexpr int kMostSteps = 12;
constexpr int kMostHalvings = 4;

// A place's distance from a centre and what curves it.
struct Distance {
  glm::dvec3 normal;
  double mm;
  glm::dvec3 su, sv;  // derivatives of the place along u and v
  double twist;
  bool along_u, along_v;

  // Second derivative of the distance for two directions square to the normal, as SphereWindow::bend.
  [[nodiscard]] double bend(const glm::dvec3& a, const glm::dvec3& b) const noexcept {
    double foot = 0.0;
    const double uu = glm::dot(su, su);
    const double vv = glm::dot(sv, sv);
    if (along_u && along_v) {
      const double au = glm::dot(a, su), av = glm::dot(a, sv), bu = glm::dot(b, su), bv = glm::dot(b, sv);
      const double uv = glm::dot(su, sv) - mm * normal.z * twist;
      foot = (au * bu * vv + av * bv * uu - (au * bv + av * bu) * uv) / (uu * vv - uv * uv);
    } else if (along_u) {
      foot = glm::dot(a, su) * glm::dot(b, su) / uu;
    } else if (along_v) {
      foot = glm::dot(a, sv) * glm::dot(b, sv) / vv;
    }
    return (glm::dot(a, b) - foot) / mm;
  }
};

bool isAlong(double x) noexcept {
  return x > 0.0 && x < 1.0;
}

// The distance of a patch's sample, edge or inside; u and v become those of its nearest point.
Distance distanceOf(const Patch& s, const glm::dvec3& centre, double& u, double& v) noexcept {
  const bool along_u = isAlong(u);
  const bool along_v = isAlong(v);
  if (along_u && along_v) {
    const haptic::PatchPoint at = haptic::closestOnPatch(s, centre, u, v);
    u = at.u;
    v = at.v;
  } else if (along_u || along_v) {
    const glm::dvec3 from = along_u ? s.at(0.0, v) : s.at(u, 0.0);
    const glm::dvec3 edge = (along_u ? s.at(1.0, v) : s.at(u, 1.0)) - from;
    (along_u ? u : v) = glm::dot(centre - from, edge) / glm::dot(edge, edge);
  }
  const glm::dvec3 away = centre - s.at(u, v);
  const double mm = glm::length(away);
  return {away / mm, mm, {s.sx, 0.0, s.b + s.d * v}, {0.0, s.sy, s.c + s.d * u}, s.d, along_u, along_v};
}

// Newton's step for the distance to the goal on one surface, two or three; bentStep of SphereTracker without its choices.
glm::dvec3 stepOnOne(const glm::dvec3& goal, const Distance& at, double lack) noexcept {
  const glm::dvec3 slide = goal - glm::dot(goal, at.normal) * at.normal;
  const glm::dvec3 onto = (lack + glm::dot(goal, at.normal)) * at.normal;
  const double length = glm::length(slide);
  if (!(length > 0.0)) return onto;
  const glm::dvec3 a = slide / length;
  const glm::dvec3 b = glm::cross(at.normal, a);
  const double aa = at.bend(a, a), ab = at.bend(a, b), bb = at.bend(b, b);
  const double m00 = 1.0 - lack * aa, m01 = -lack * ab, m11 = 1.0 - lack * bb;
  const double det = m00 * m11 - m01 * m01;
  const double sa = length * m11 / det;
  const double sb = -length * m01 / det;
  return onto + sa * a + sb * b - 0.5 * (sa * sa * aa + 2.0 * sa * sb * ab + sb * sb * bb) * at.normal;
}

glm::dvec3 stepOnTwo(const glm::dvec3& goal, const Distance& one, const Distance& two, double lack_one,
                     double lack_two) noexcept {
  const glm::dvec3 across = glm::cross(one.normal, two.normal);
  const double det = glm::dot(across, across);
  const double g = glm::dot(one.normal, two.normal);
  const double share_one = (lack_one - g * lack_two) / det;
  const double share_two = (lack_two - g * lack_one) / det;
  const glm::dvec3 plain = goal + share_one * one.normal + share_two * two.normal;
  const glm::dvec3 slide = across * (glm::dot(across, plain) / det);
  const glm::dvec3 a = across / std::sqrt(det);
  const double bend_one = one.bend(a, a), bend_two = two.bend(a, a);
  const glm::dvec3 along = slide / (1.0 - share_one * bend_one - share_two * bend_two);
  const double long2 = glm::dot(along, along);
  const double rise_one = -0.5 * bend_one * long2, rise_two = -0.5 * bend_two * long2;
  return plain - slide + along + ((rise_one - g * rise_two) / det) * one.normal +
         ((rise_two - g * rise_one) / det) * two.normal;
}

glm::dvec3 stepOnThree(const glm::dvec3& goal, const std::array<Distance, 3>& at,
                       const std::array<double, 3>& lack) noexcept {
  const glm::dvec3 across = glm::cross(at[0].normal, at[1].normal);
  return goal + (lack[0] * glm::cross(at[1].normal, at[2].normal) +
                 lack[1] * glm::cross(at[2].normal, at[0].normal) + lack[2] * across) /
                    glm::dot(across, at[2].normal);
}

}  // namespace

LeastBall::LeastBall(const engine::Version& field, double radius_mm,
                     std::span<const haptic::StrokeSample> strokes)
    : heights_(field), radius_(radius_mm) {
  haptic::Surface surface(field.reader());
  haptic::SphereTracker ball(radius_mm, field.grid());
  const auto window = std::make_unique<haptic::SphereWindow>(haptic::BallMinima::kAll);
  const auto near = std::make_unique<haptic::SphereContactList>();
  std::array<haptic::HalfSpace, haptic::SphereContactList::kMost> half_spaces;
  haptic::TickCounters counters;
  const double cell = std::min(heights_.spacing_x_mm, heights_.spacing_y_mm);
  bool touching = false;
  for (const haptic::StrokeSample& sample : strokes) {
    const glm::dvec3 before = ball.centre();
    const bool touched = std::exchange(touching, ball.update(surface, sample.tip_mm, counters).touching);
    if (!touching || !touched) continue;
    const glm::dvec3 centre = ball.centre();
    window->load(surface, centre, radius_ + 0.01 * cell, 0.0);
    window->contacts(centre, radius_ + 0.01 * cell, 0.0, *near);
    for (int k = 0; k < near->count; ++k) {
      const haptic::SphereContact& touch = near->contacts[static_cast<std::size_t>(k)];
      half_spaces[static_cast<std::size_t>(k)] = {touch.normal, radius_ - touch.distance_mm};
    }
    const haptic::Projection rest =
        haptic::projectOnHalfSpaces(sample.tip_mm - centre, half_spaces.data(), near->count, 1e-8 * cell);
    // On its way and held by nothing: no contact to be computed.
    if (near->below || !rest.solved || rest.count == 0) continue;
    Tick tick;
    tick.endpoint_mm = sample.tip_mm;
    tick.from_mm = before;
    for (int k = 0; k < rest.count; ++k) {
      const haptic::SphereContact& touch =
          near->contacts[static_cast<std::size_t>(rest.active[static_cast<std::size_t>(k)])];
      tick.places[static_cast<std::size_t>(tick.count++)] = {touch.cell, touch.u, touch.v};
    }
    // From as far back on its way as its places at the end lead there.
    tick.steps = 0;
    for (int halvings = 0; halvings <= kMostHalvings && tick.steps == 0; ++halvings) {
      tick.from_mm = centre + std::ldexp(1.0, -halvings) * (before - centre);
      tick.steps = stepsTo(centre, tick);
    }
    if (tick.steps == 0) {
      ++ends_alone_;
      tick.steps = 1;
      tick.from_mm = centre;
    }
    addSamples(tick, centre);
    steps_ += static_cast<std::size_t>(tick.steps);
    solved_ += static_cast<std::size_t>(tick.steps * tick.count);
    for (int k = 0; k < tick.count; ++k) {
      const Place& place = tick.places[static_cast<std::size_t>(k)];
      if (isAlong(place.u) && isAlong(place.v)) solved_inside_ += static_cast<std::size_t>(tick.steps);
    }
    ticks_.push_back(tick);
  }
}

// The samples in the circle below the ball; with the corners of its places they are what is read.
void LeastBall::addSamples(Tick& tick, const glm::dvec3& centre) {
  std::set<std::pair<std::int32_t, std::int32_t>> read;
  tick.first_below = below_.size();
  const auto first = [&](double x, double s) {
    return static_cast<std::int32_t>(std::ceil((x - radius_) / s));
  };
  for (std::int32_t row = std::max(first(centre.y, heights_.spacing_y_mm), 0);
       row < heights_.height && row * heights_.spacing_y_mm <= centre.y + radius_; ++row)
    for (std::int32_t column = std::max(first(centre.x, heights_.spacing_x_mm), 0);
         column < heights_.width && column * heights_.spacing_x_mm <= centre.x + radius_; ++column) {
      const double dx = column * heights_.spacing_x_mm - centre.x;
      const double dy = row * heights_.spacing_y_mm - centre.y;
      if (!(dx * dx + dy * dy < radius_ * radius_)) continue;
      below_.push_back({column, row});
      read.emplace(column, row);
    }
  tick.end_below = below_.size();
  for (int k = 0; k < tick.count; ++k) {
    const CellIndex cell = tick.places[static_cast<std::size_t>(k)].cell;
    for (const std::int32_t i : {0, 1})
      for (const std::int32_t j : {0, 1}) read.emplace(cell.column + i, cell.row + j);
  }
  read_ += read.size();
}

// How many steps lead from the tick's beginning to `centre`, the last one as short as a rest; 0: they lead elsewhere.
int LeastBall::stepsTo(const glm::dvec3& centre, const Tick& tick) const noexcept {
  const double cell = std::min(heights_.spacing_x_mm, heights_.spacing_y_mm);
  Tick tried = tick;
  glm::dvec3 at = tick.from_mm;
  for (int n = 1; n <= kMostSteps; ++n) {
    const glm::dvec3 moved = step(at, tried);
    at += moved;
    if (!(glm::length(moved) <= kRestCells * cell)) continue;
    return glm::length(at - centre) <= kSameCells * cell ? n : 0;
  }
  return 0;
}

// One step; places move to their nearest points.
glm::dvec3 LeastBall::step(const glm::dvec3& centre, Tick& tick) const noexcept {
  const glm::dvec3 goal = tick.endpoint_mm - centre;
  std::array<Distance, kMostPlaces> at;
  std::array<double, kMostPlaces> lack;
  for (std::size_t k = 0; k < static_cast<std::size_t>(tick.count); ++k) {
    Place& place = tick.places[k];
    at[k] = distanceOf(heights_.patch(place.cell), centre, place.u, place.v);
    lack[k] = radius_ - at[k].mm - glm::dot(at[k].normal, goal);
  }
  if (tick.count == 1) return stepOnOne(goal, at[0], lack[0]);
  if (tick.count == 2) return stepOnTwo(goal, at[0], at[1], lack[0], lack[1]);
  return stepOnThree(goal, at, lack);
}

double LeastBall::run() const noexcept {
  double sum = 0.0;
  for (Tick tick : ticks_) {
    glm::dvec3 centre = tick.from_mm;
    for (int n = 0; n < tick.steps; ++n) centre += step(centre, tick);
    double nearest2 = radius_ * radius_;
    for (std::size_t k = tick.first_below; k < tick.end_below; ++k) {
      const CellIndex at = below_[k];
      const std::size_t i = static_cast<std::size_t>(at.row) * static_cast<std::size_t>(heights_.width) +
                            static_cast<std::size_t>(at.column);
      const glm::dvec3 away =
          centre - glm::dvec3(at.column * heights_.spacing_x_mm, at.row * heights_.spacing_y_mm,
                              heights_.unit_mm * static_cast<double>(heights_.samples[i]));
      nearest2 = std::min(nearest2, glm::dot(away, away));
    }
    sum += centre.z + nearest2;
  }
  return sum;
}

}  // namespace fettle::bench
