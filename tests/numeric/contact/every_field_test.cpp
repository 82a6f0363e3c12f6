// What must hold at every tick on every hard field, whichever way it is touched.
//
// A ball next to a needle is the one exception: all of the needle's valley lies within a small part of a cell, of slope 1e6
// within a millionth, where the pieces of SphereValley find no minimum, so that the ball enters it, by up to its radius
// (docs/decisions/ball-tip.md). That is measured, in
// long double, and told; what must hold there is that a tick ends no farther from the endpoint than one that reached in by
// the tolerance could.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/contact/certified.h"
#include "haptic/tick/tick.h"
#include "tests/haptic/support/fields.h"
#include "tests/numeric/support/hard_fields.h"

namespace fettle::haptic {
namespace {

using tests::Choice;
using tests::HardField;
using tests::Jumps;
using tests::ulps;

constexpr double kNeedle = 1e5;  // slope

struct Case {
  std::string field;
  Choice choice;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.field << ' ' << tests::choiceName(c.choice);
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const std::string& field : tests::hardFieldNames())
    for (const Choice choice : tests::kChoices) all.push_back({field, choice});
  return all;
}

class EveryField : public ::testing::TestWithParam<Case> {
 protected:
  const HardField& hard() const { return hard_; }
  Choice choice() const { return GetParam().choice; }
  bool ball() const { return choice() == Choice::kSphere; }
  Scene scene() const { return tests::sceneFor(choice(), hard().field.grid()); }
  double cellMm() const {
    return std::min(hard().field.grid().spacingXMm(), hard().field.grid().spacingYMm());
  }
  std::string name() const { return hard().name + " " + tests::choiceName(choice()); }

  // Error of a distance: coordinates and heights as large as `size` are rounded when they are read, scaled,
  // subtracted, squared and summed (some 16 roundings), and a search may lose kSame, 1e-15, of the squared
  // distance in each of a few dozen rounds. A ball also reaches in by its tolerance, 1e-6 of a cell.
  double heightError(const glm::dvec3& at) const;

  double distanceError(double distance_mm, double tip_size_mm) const {
    const double rounding = ulps(64, std::max(hard().size_mm, tip_size_mm)) + 64e-15 * distance_mm;
    return ball() ? 1e-6 * cellMm() + 4.0 * rounding : rounding;
  }

  // By how much a ball's centre may come to lie farther from an endpoint because it reached into the material at `centre`,
  // by the tolerance at most, and is pushed out. What touches it there are planes whose normals have a z of at least
  // 1 / sqrt(1 + slope^2), so that it is free by as much times that root above where it was; and where it goes is the
  // nearest free point. In a groove of slope 30 that is 30 tolerances, next to a needle of slope 1e6 a cell.
  double pushedOut(const glm::dvec3& centre);
  double deepest_ = 0.0;  // that pushedOut() measured [mm]

  // How far a ball with this centre reaches into the material, by the closest points of all cells near in long double; the
  // radius and more where its centre is below the surface. And the steepest slope of these cells.
  struct ReachIn {
    double mm = 0.0, slope = 0.0;
  };
  ReachIn reachIn(const glm::dvec3& centre) const;
  double ballTolerance() const {
    return 1e-6 * std::min(scene().tip_radius_mm, cellMm()) + ulps(64, hard().size_mm);
  }

 private:
  HardField hard_ = tests::hardField(GetParam().field);
};

// Every number is finite, the force is K times the penetration or cut to the limit, and bad input gives none.
TEST_P(EveryField, ForceIsFiniteAndProportionalAndNaNAndInfinityGiveNone) {
  engine::LiveField live(hard().field, engine::Growth::kAllowed);
  Tick tick(scene(), live, hard().field);
  std::int64_t contacts = 0;
  int bad = 0;
  for (StrokeSample sample : tests::wander(hard(), 4000, 1, Jumps::kYes)) {
    if (++bad % 53 == 0)
      sample.tip_mm[bad / 53 % 3] = bad % 2 == 0 ? NAN : (bad % 3 == 0 ? HUGE_VAL : -HUGE_VAL);
    if (bad % 401 == 0) sample.tip_mm[bad % 3] = bad % 2 == 0 ? 1e300 : -5e-324;
    const ForceSample felt = tick.run(sample);
    const double force = glm::length(felt.force_n);
    ASSERT_TRUE(std::isfinite(force));
    // 3 roundings of scaling by the limit.
    ASSERT_LE(force, 1000.0 * (1 + 1e-15));
    const bool finite = std::isfinite(sample.tip_mm.x + sample.tip_mm.y + sample.tip_mm.z);
    if (!finite || !felt.contact) {
      ASSERT_EQ(felt.force_n, glm::dvec3(0.0));
      continue;
    }
    ++contacts;
    ASSERT_TRUE(std::isfinite(felt.proxy_mm.x + felt.proxy_mm.y + felt.proxy_mm.z));
    // K = 1 N/mm: one multiplication, exact.
    const double depth = glm::length(tick.contact().penetration_mm);
    if (depth < 999.0) {
      ASSERT_EQ(felt.force_n, tick.contact().penetration_mm);
    }
  }
  EXPECT_GT(contacts, 200);
  EXPECT_GT(tick.counters().bad_input, 50);
  tests::tellRare(name(), tick.counters());
}

// How far a point is above or below the surface. A point on the rim of a hole or on the field's side may be
// rounded over it: the nearest of it and its neighbours by a few last bits counts. HUGE_VAL far from any.
double EveryField::heightError(const glm::dvec3& at) const {
  double least = HUGE_VAL;
  for (const double dx : {0.0, -4.0, 4.0})
    for (const double dy : {0.0, -4.0, 4.0}) {
      const auto error = static_cast<double>(
          std::abs(tests::heightAt(hard().field, at.x + ulps(dx, at.x), at.y + ulps(dy, at.y)) - at.z));
      if (error < least) least = error;
    }
  return least;
}

EveryField::ReachIn EveryField::reachIn(const glm::dvec3& centre) const {
  const double radius = scene().tip_radius_mm;
  Surface surface(hard().field.reader());
  long double nearest2 = HUGE_VALL;
  double slope = 0.0;
  const auto near = [&](double x, double spacing, int cells, int& first, int& last) {
    first = static_cast<int>(std::clamp(std::floor((x - radius) / spacing), 0.0, cells - 1.0));
    last = static_cast<int>(std::clamp(std::floor((x + radius) / spacing), 0.0, cells - 1.0));
  };
  int c0 = 0, c1 = 0, r0 = 0, r1 = 0;
  near(centre.x, surface.spacingX(), surface.cellColumns(), c0, c1);
  near(centre.y, surface.spacingY(), surface.cellRows(), r0, r1);
  for (int r = r0; r <= r1; ++r)
    for (int c = c0; c <= c1; ++c) {
      Patch patch;
      if (!surface.patch({c, r}, patch)) continue;
      nearest2 = std::min(nearest2, tests::bruteDistance2(patch, centre));
      const double along_x = std::max(std::abs(patch.b), std::abs(patch.b + patch.d)) / patch.sx;
      const double along_y = std::max(std::abs(patch.c), std::abs(patch.c + patch.d)) / patch.sy;
      slope = std::max(slope, std::hypot(along_x, along_y));
    }
  const auto above = static_cast<double>(tests::heightAt(hard().field, centre.x, centre.y) - centre.z);
  const auto distance = static_cast<double>(std::sqrt(nearest2));
  return {above > 0.0 ? radius + distance : std::max(radius - distance, 0.0), slope};
}

double EveryField::pushedOut(const glm::dvec3& centre) {
  const ReachIn in = reachIn(centre);
  // sphere_tip.h: 1e-6 of the smaller of radius and spacing, and roundings.
  if (hard().slope < kNeedle) {
    EXPECT_LE(in.mm, ballTolerance());
  }
  deepest_ = std::max(deepest_, in.mm);
  return ballTolerance() * std::hypot(1.0, in.slope);
}

// The point tip's proxy lies on the surface: interpolated by a twin in long double from the samples.
TEST_P(EveryField, ProxyLiesOnTheSurface) {
  engine::LiveField live(hard().field, engine::Growth::kAllowed);
  Tick tick(scene(), live, hard().field);
  std::int64_t walls = 0, looked = 0;
  double worst = 0.0;
  for (const StrokeSample& sample : tests::wander(hard(), 4000, 2, Jumps::kYes)) {
    const ForceSample felt = tick.run(sample);
    if (!felt.contact) continue;
    // x = column sx + u sx is rounded twice, which the slope turns into height; the patch's height sums four
    // products of heights, each rounded.
    const double tolerance = ulps(8, std::hypot(felt.proxy_mm.x, felt.proxy_mm.y)) * (1.0 + hard().slope) +
                             ulps(16, hard().size_mm);
    const double error = heightError(felt.proxy_mm);
    if (ball() && !(error <= tolerance)) {
      // Holds against the wall of a hole or the field's side, level with the centre: no point of the surface,
      // but below its rim.
      ++walls;
      continue;
    }
    ASSERT_LE(error, tolerance) << felt.proxy_mm.x << ' ' << felt.proxy_mm.y << ' ' << felt.proxy_mm.z;
    worst = std::max(worst, error / tolerance);
    ++looked;
  }
  EXPECT_GT(looked + walls, 200);
  tests::tellRare(name(), tick.counters(),
                  fmt::format("worst {:.2g} of the tolerance, {} on walls", worst, walls));
}

// A point's proxy is a local minimum of the distance: of points 1e-6 of a cell around it, in whichever cells,
// none is nearer; of those in the cells that share it, since beyond a crease that it does not touch a point may be, however
// near the crease is. (1e-3 around it there are: along the twist of a patch.) Newton's last
// step, 1e-7 of a cell, leaves a slope of its square, times curvature, at most 1 + slope^2: nothing compared
// with the step of 1e-7 itself, which is allowed here.
TEST_P(EveryField, NoPointAroundTheProxyIsNearer) {
  if (ball()) GTEST_SKIP() << "a ball is held by several points: tests/haptic/contact/sphere_tip_test.cpp";
  if (hard().slope > 100.0) GTEST_SKIP() << "rounding of a place is more than 1e-6 of what a wall rises";
  engine::LiveField live(hard().field, engine::Growth::kAllowed);
  Tick tick(scene(), live, hard().field);
  const double sx = hard().field.grid().spacingXMm();
  const double sy = hard().field.grid().spacingYMm();
  const double steep = 1.0 + hard().slope * hard().slope;
  // Whether a place along u or v is in a cell that does not share the proxy.
  const auto beyond = [](double proxy, double place) {
    return (place < 0.0 && proxy != 0.0) || (place > 1.0 && proxy != 1.0);
  };
  std::int64_t looked = 0;
  for (const StrokeSample& sample : tests::wander(hard(), 4000, 7, Jumps::kYes)) {
    const ForceSample felt = tick.run(sample);
    if (!felt.contact) continue;
    ++looked;
    const glm::dvec3& e = sample.tip_mm;
    const double distance = glm::length(felt.proxy_mm - e);
    const double slack = 2.0 * distanceError(distance, glm::length(e)) * distance +
                         1e-13 * steep * std::max(sx, sy) * std::max(sx, sy);
    for (int k = 0; k < 16; ++k) {
      glm::dvec3 q =
          felt.proxy_mm + 1e-6 * glm::dvec3(sx * std::cos(k * 0.3927), sy * std::sin(k * 0.3927), 0.0);
      q.z = static_cast<double>(tests::heightAt(hard().field, q.x, q.y));
      if (std::isnan(q.z)) continue;  // a hole or outside the field
      const SurfacePoint& at = tick.contact().proxy;
      if (beyond(at.u, q.x / sx - at.cell.column) || beyond(at.v, q.y / sy - at.cell.row)) continue;
      ASSERT_GE(glm::dot(q - e, q - e), distance * distance - slack)
          << "tip " << e.x << ' ' << e.y << ' ' << e.z << ", proxy " << felt.proxy_mm.x << ' '
          << felt.proxy_mm.y;
    }
  }
  EXPECT_GT(looked, 200);
  tests::tellRare(name(), tick.counters());
}

// Nothing falls through: below the surface there is contact.
TEST_P(EveryField, BelowTheSurfaceThereIsContact) {
  engine::LiveField live(hard().field, engine::Growth::kAllowed);
  Tick tick(scene(), live, hard().field);
  std::int64_t below_ticks = 0;
  for (const StrokeSample& sample : tests::wander(hard(), 6000, 3, Jumps::kYes)) {
    const bool touching = tick.run(sample).contact;
    const glm::dvec3& e = sample.tip_mm;
    const auto depth = static_cast<double>(tests::heightAt(hard().field, e.x, e.y) - e.z);
    // Where rounding decides which side a tip is on, either is right.
    const double tolerance = ulps(8, std::hypot(e.x, e.y)) * (1.0 + hard().slope) + ulps(16, hard().size_mm);
    if (!(depth > tolerance)) continue;
    ++below_ticks;
    ASSERT_TRUE(touching) << "tip " << e.x << ' ' << e.y << ' ' << e.z << ", " << depth << " below";
  }
  EXPECT_GT(below_ticks, 300);
  EXPECT_EQ(tick.counters().below_without_contact, 0);
  tests::tellRare(name(), tick.counters());
}

// A tip that stays in contact goes to a proxy that is no farther than the one it had: both tracking searches
// start there and only go down, and the certified one finds the closest of all. From that alone follows that
// the spring gives back no more than was put in (tests/numeric/loop), whatever the surface.
TEST_P(EveryField, TheProxyIsNeverFartherThanTheOneBefore) {
  engine::LiveField live(hard().field, engine::Growth::kAllowed);
  Tick tick(scene(), live, hard().field);
  bool was_touching = false;
  // The ball was stopped on its way last, by the bound of its steps: free, it is where no tick tells.
  bool on_its_way = false;
  glm::dvec3 proxy{0.0}, before{0.0};
  std::int64_t held = 0, entries = 0, far_entries = 0, handed_over = 0, side_entries = 0, pushed = 0,
               placed = 0;
  double most_pushed = 0.0;
  for (const StrokeSample& sample : tests::wander(hard(), 6000, 4, Jumps::kNo)) {
    const std::int64_t bounds_hit = tick.counters().search_bound_hits;
    const ForceSample felt = tick.run(sample);
    const glm::dvec3& e = sample.tip_mm;
    if (felt.contact) {
      const double distance = glm::length(tick.contact().penetration_mm);
      const double allowed = glm::length((was_touching ? proxy : before) - e);
      const double more = distance - allowed - distanceError(distance, glm::length(e));
      bool farther = more > 0.0;
      // A hand that moves farther than the steps of a tick reach, each a cell at most, places the ball again.
      const bool is_placed = ball() && glm::length(e - before) > kBallSearches * 0.5 * cellMm();
      placed += is_placed ? 1 : 0;
      if (was_touching) {
        ++held;
        handed_over += farther ? 1 : 0;
        if (farther && ball() && !is_placed) {
          ++pushed;
          const double out = pushedOut(proxy);
          most_pushed = std::max(most_pushed, more / out);
          farther = more > out;
        }
        if (ball() ? !is_placed : choice() == Choice::kCertified || hard().slope < 1.0) {
          ASSERT_FALSE(farther) << distance << " > " << allowed << " at " << e.x << ' ' << e.y << ' ' << e.z;
        }
      } else if (tick.counters().side_entries == side_entries) {
        // Comes in through the surface, so a point of it lies on the way. The local search may start on the
        // wrong side of a steep cell, and end farther: counted.
        ++entries;
        far_entries += farther ? 1 : 0;
        if (choice() == Choice::kCertified ||
            (ball() && hard().slope < kNeedle && !is_placed && !on_its_way)) {
          ASSERT_FALSE(farther) << distance << " > " << allowed << " at " << e.x << ' ' << e.y << ' ' << e.z;
        }
      }
      proxy = e + tick.contact().penetration_mm;
    }
    on_its_way = !felt.contact && (tick.counters().search_bound_hits > bounds_hit);
    was_touching = felt.contact;
    side_entries = tick.counters().side_entries;
    before = e;
  }
  EXPECT_GT(held, 100);
  tests::tellRare(
      name(), tick.counters(),
      fmt::format(
          "{} of {} ticks handed over to a farther proxy, {} of {} entries far, {} pushed out by {:.2f} "
          "of what may be at most, from {:.1e} mm deep, {} placed again",
          handed_over, held, far_entries, entries, pushed, most_pushed, deepest_, placed));
}

// A tip at rest has a proxy at rest. It never goes farther from the endpoint again, so that it cannot dither
// between two minima; and after 8 ticks a point's proxy moves by no more than rounding makes of it. Certified
// is a function of the endpoint: the same bits. Newton's last step leaves the gradient at a few roundings e
// of its summands, which the flatness of the minimum turns into parameters: at most e / (1 - coupling), 500 e
// by kLargestCoupling. A ball takes steps of 1e-4 of a cell for rest, and may slide on by such a step per tick.
// On a needle it may enter it and be free: counted.
TEST_P(EveryField, ATipAtRestHasAProxyAtRest) {
  engine::LiveField live(hard().field, engine::Growth::kAllowed);
  Tick tick(scene(), live, hard().field);
  const std::vector<StrokeSample> path = tests::wander(hard(), 3000, 5, Jumps::kYes);
  std::int64_t rests = 0, late = 0, entered = 0;
  double worst = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    ForceSample felt = tick.run(path[i]);
    if (i % 25 != 0 || !felt.contact) continue;
    ++rests;
    bool moves_late = false;
    for (int k = 0; k < 40; ++k) {
      const glm::dvec3 before = tick.contact().penetration_mm;
      felt = tick.run(path[i]);
      if (!felt.contact && ball() && hard().slope > kNeedle) {
        ++entered;
        break;
      }
      ASSERT_TRUE(felt.contact);
      const glm::dvec3 now = tick.contact().penetration_mm;
      double allowed = glm::length(before) + distanceError(glm::length(now), glm::length(path[i].tip_mm));
      if (ball() && glm::length(now) > allowed) allowed += pushedOut(path[i].tip_mm + before);
      ASSERT_LE(glm::length(now), allowed);
      if (choice() == Choice::kCertified) {
        ASSERT_EQ(now, before);
      }
      if (k < 8) continue;
      moves_late = moves_late || now != before;
      worst = std::max(worst, glm::length(now - before));
    }
    late += moves_late ? 1 : 0;
  }
  EXPECT_GT(rests, 20);
  if (!ball()) {
    EXPECT_LE(worst, ulps(500 * 4, hard().size_mm));
  }
  tests::tellRare(
      name(), tick.counters(),
      fmt::format("{} rests, {} moved after 8 ticks, by {:.1e} cells at most, {} entered a needle", rests,
                  late, worst / cellMm(), entered));
}

std::string caseName(const ::testing::TestParamInfo<Case>& info) {
  return info.param.field + "_" + tests::choiceName(info.param.choice);
}
INSTANTIATE_TEST_SUITE_P(Numeric, EveryField, ::testing::ValuesIn(cases()), caseName);

// Certified against brute force in long double over every cell of the field.
class CertifiedOn : public ::testing::TestWithParam<std::string> {};

TEST_P(CertifiedOn, IsTheClosestPointOfAllCells) {
  const HardField hard = tests::hardField(GetParam());
  Surface surface(hard.field.reader());
  const double radius = 1e9 * hard.size_mm;  // all of it
  std::int64_t looked = 0;
  double worst = 0.0;
  const std::vector<StrokeSample> path = tests::wander(hard, 3000, 6, Jumps::kYes);
  for (std::size_t i = 0; i < path.size(); i += 250) {
    const glm::dvec3& e = path[i].tip_mm;
    SurfacePoint found;
    const bool is = certifiedClosest(surface, e, radius, found);
    long double best = HUGE_VALL;
    Patch patch;
    for (int r = 0; r < surface.cellRows(); ++r)
      for (int c = 0; c < surface.cellColumns(); ++c)
        if (surface.patch({c, r}, patch)) {
          // Boxes that cannot be nearer are left out; brute force is slow.
          const auto beyond = [](double x, double low, double high) {
            return std::max({low - x, x - high, 0.0});
          };
          const long double dx = beyond(e.x, patch.x0, patch.x0 + patch.sx);
          const long double dy = beyond(e.y, patch.y0, patch.y0 + patch.sy);
          const long double dz = beyond(e.z, patch.lowest(), patch.highest());
          if (dx * dx + dy * dy + dz * dz < best * (1 + 1e-12L))
            best = std::min(best, tests::bruteDistance2(patch, e));
        }
    ASSERT_EQ(is, std::isfinite(best));
    if (!is) continue;
    ++looked;
    const double brute = static_cast<double>(std::sqrt(best));
    // Newton stops within 1e-7 of the parameters' minimum, where the distance is flat: 1e-14, times what the
    // curvature of a patch can make of it (1e3); and roundings of coordinates.
    const double tolerance =
        1e-11 * brute + ulps(64, hard.size_mm + glm::length(e) * (hard.size_mm < 1.0 ? 0.0 : 1.0));
    ASSERT_NEAR(std::sqrt(found.distance2_mm2), brute, tolerance) << e.x << ' ' << e.y << ' ' << e.z;
    worst = std::max(worst, std::abs(std::sqrt(found.distance2_mm2) - brute) / tolerance);
  }
  EXPECT_GT(looked, 5);
  std::printf("%s: %lld points, worst %.2g of the tolerance\n", hard.name.c_str(),
              static_cast<long long>(looked), worst);
}

INSTANTIATE_TEST_SUITE_P(Numeric, CertifiedOn, ::testing::ValuesIn(tests::hardFieldNames()),
                         [](const auto& one) { return one.param; });

}  // namespace
}  // namespace fettle::haptic
