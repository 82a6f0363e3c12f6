// One tick after the other on fields with known answers: collision, closest point, contact test, force.
#include "haptic/tick/tick.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/contact/certified.h"
#include "haptic/contact/collision.h"
#include "haptic/contact/descent.h"
#include "haptic/contact/normal.h"
#include "haptic/contact/patch.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::fieldOf;
using tests::kHole;
using tests::randomField;
using tests::uniform;

// A scene, a field and a tick together.
struct Bench {
  explicit Bench(const engine::Version& start, const Scene& settings = {})
      : scene(settings), field(start, engine::Growth::kAllowed), tick(scene, field, start) {}
  ForceSample at(double x, double y, double z, Tool tool = Tool::kFeel) {
    return tick.run({0.0, {x, y, z}, tool});
  }

  Scene scene;
  engine::LiveField field;
  Tick tick;
};

Scene stiff(double stiffness, double limit) {
  Scene scene;
  scene.stiffness_n_per_mm = stiffness;
  scene.force_limit_n = limit;
  return scene;
}

TEST(Tick, PressingAFlatGivesStiffnessTimesDepthStraightUp) {
  Bench bench(fieldOf(20, 20, [](int, int) { return 2.0; }), stiff(0.5, 8.0));
  EXPECT_FALSE(bench.at(7.3, 6.6, 3.0).contact);
  const ForceSample f = bench.at(7.3, 6.6, 1.5);
  ASSERT_TRUE(f.contact);
  // Every number here is exact in binary but the coordinates 7.3 and 6.6, which Newton must give back.
  EXPECT_NEAR(f.proxy_mm.x, 7.3, 1e-14);
  EXPECT_NEAR(f.proxy_mm.y, 6.6, 1e-14);
  EXPECT_EQ(f.proxy_mm.z, 2.0);
  EXPECT_NEAR(f.force_n.x, 0.0, 1e-14);
  EXPECT_NEAR(f.force_n.z, 0.25, 1e-14);
}

TEST(Tick, TiltedPlaneInAnisotropicMillimetresPushesAlongItsNormal) {
  // z = 0.5 x + 0.25 y mm with 0.5 mm by 2 mm cells: per sample 0.25 and 0.5, exact in float.
  Bench bench(fieldOf(
                  60, 20, [](int c, int r) { return 0.25 * c + 0.5 * r; }, 0.5, 2.0),
              stiff(2.0, 100.0));
  const glm::dvec3 normal = glm::normalize(glm::dvec3(-0.5, -0.25, 1.0));
  const glm::dvec3 foot{11.1, 17.2, 0.5 * 11.1 + 0.25 * 17.2};
  const glm::dvec3 e = foot - 1.3 * normal;
  const ForceSample f = bench.at(e.x, e.y, e.z);
  ASSERT_TRUE(f.contact);
  // A plane across cells: each cell rounds on its own, a few 1e-16 of coordinates near 20.
  EXPECT_LT(glm::length(f.proxy_mm - foot), 1e-12);
  EXPECT_LT(glm::length(f.force_n - 2.6 * normal), 1e-11);
}

TEST(Tick, EndpointExactlyOnTheSurfaceIsNoContact) {
  Bench bench(fieldOf(5, 5, [](int, int) { return 1.0; }));
  EXPECT_FALSE(bench.at(2.0, 2.0, 1.0).contact);
  EXPECT_FALSE(bench.at(2.25, 2.0, 1.0).contact);
  EXPECT_TRUE(bench.at(2.25, 2.0, std::nextafter(1.0, 0.0)).contact);
}

TEST(Tick, ForceIsCutToTheLimitAlongItsDirection) {
  Bench bench(fieldOf(9, 9, [](int, int) { return 0.0; }), stiff(1.0, 3.0));
  EXPECT_NEAR(bench.at(4.4, 4.4, -50.0).force_n.z, 3.0, 1e-14);
  EXPECT_EQ(bench.tick.counters().force_clamped, 1);
}

TEST(Tick, NormalOnARidgeIsTheMeanOfItsCells) {
  const engine::Version field = fieldOf(9, 9, [](int c, int) { return -std::abs(c - 4.0); });
  Surface surface(field.reader());
  SurfacePoint edge{{4, 3}, 0.0, 0.5, {4.0, 3.5, 0.0}, 0.0};
  SurfaceNormal normal = surfaceNormal(surface, edge);
  EXPECT_EQ(normal.cells, 2);
  EXPECT_NEAR(glm::length(normal.direction - glm::dvec3(0, 0, 1)), 0.0, 1e-15);
  edge.v = 0.0;
  normal = surfaceNormal(surface, edge);
  EXPECT_EQ(normal.cells, 4);
  EXPECT_NEAR(normal.direction.z, 1.0, 1e-15);
  edge.cell = {0, 0};
  edge.u = 0.0;
  EXPECT_EQ(surfaceNormal(surface, edge).cells, 1);  // the field's corner
}

TEST(Tick, ConcaveCornerEndsAtItsEdgeAndHolds) {
  // A V-groove along y at column 5: from below, its closest point is the edge itself.
  Bench bench(fieldOf(11, 11, [](int c, int) { return std::abs(c - 5.0); }), stiff(1.0, 50.0));
  for (const double x : {4.3, 4.9, 5.0, 5.2, 5.9}) {
    const ForceSample f = bench.at(x, 5.3, -2.0);
    ASSERT_TRUE(f.contact);
    // Under the groove the feet on both flanks lie beyond the edge while |x - 5| <= depth.
    EXPECT_NEAR(f.proxy_mm.x, 5.0, 1e-12);
    EXPECT_NEAR(f.proxy_mm.z, 0.0, 1e-12);
  }
  EXPECT_EQ(bench.tick.counters().search_bound_hits, 0);
}

TEST(Tick, FastHandDoesNotFallThroughAStepOrAWall) {
  // A wall one sample wide and 5 high at column 10.
  Bench bench(fieldOf(30, 10, [](int c, int) { return c == 10 ? 5.0 : 0.0; }), stiff(1.0, 50.0));
  EXPECT_FALSE(bench.at(6.0, 4.5, 2.0).contact);
  const ForceSample f = bench.at(14.0, 4.5, 1.0);  // through it in one tick, above the floor behind
  ASSERT_TRUE(f.contact);
  EXPECT_LT(f.proxy_mm.x, 10.0);
  EXPECT_LT(f.force_n.x, 0.0);
  EXPECT_TRUE(bench.at(14.5, 4.5, 1.0).contact);  // and is held there
}

TEST(Tick, RayThatClearsAWallIsNotHeldByIt) {
  Bench bench(fieldOf(30, 10, [](int c, int) { return c == 10 ? 5.0 : 0.0; }));
  EXPECT_FALSE(bench.at(6.0, 4.5, 9.5).contact);
  EXPECT_FALSE(bench.at(14.0, 4.5, 1.5).contact);  // 5.5 high at the wall
}

TEST(Tick, EndpointDeepBelowIsFoundWhateverTheRayWas) {
  Bench bench(fieldOf(40, 40, [](int c, int r) { return 0.1 * ((c * 7 + r * 5) % 3); }));
  EXPECT_FALSE(bench.at(-5.0, 20.0, -3.0).contact);  // outside the field
  const ForceSample f = bench.at(20.2, 20.1, -3.0);  // in through its side
  EXPECT_TRUE(f.contact);
  EXPECT_GT(f.force_n.z, 0.0);
  EXPECT_EQ(bench.tick.counters().side_entries, 1);
  EXPECT_EQ(bench.tick.counters().outside, 1);
}

TEST(Tick, HolesFieldsWithoutCellsAndBadInputGiveNoContact) {
  Bench holes(
      fieldOf(9, 9, [](int c, int r) { return c == 4 && r == 4 ? static_cast<double>(kHole) : 0.0; }));
  EXPECT_FALSE(holes.at(4.5, 4.5, -1.0).contact);
  EXPECT_EQ(holes.tick.counters().over_hole, 1);
  EXPECT_TRUE(holes.at(6.5, 4.5, -1.0).contact);
  for (const double bad : {static_cast<double>(NAN), HUGE_VAL, -HUGE_VAL}) {
    const ForceSample f = holes.at(6.5, 4.5, bad);
    EXPECT_FALSE(f.contact);
    EXPECT_EQ(f.force_n, glm::dvec3(0.0));
  }
  EXPECT_EQ(holes.tick.counters().bad_input, 3);
  EXPECT_TRUE(holes.at(6.5, 4.5, -1.0).contact);  // comes back by itself
  EXPECT_FALSE(holes.at(1e300, -1e300, 1e300).contact);
  for (const auto& [w, h] : {std::pair{9, 1}, {1, 9}, {1, 1}}) {
    Bench bench(fieldOf(w, h, [](int, int) { return 1.0; }));
    EXPECT_FALSE(bench.at(0.0, 0.0, 0.0).contact);
  }
}

TEST(Tick, MeanNormalThatPointsTheWrongWayIsOverruled) {
  // A pit at (4, 4): slopes of 1 on two sides, of 1000 on the others.
  const engine::Version field = fieldOf(9, 9, [](int c, int r) {
    return (c > 4 ? 1000.0 * (c - 4) : 4.0 - c) + (r > 4 ? 1000.0 * (r - 4) : 4.0 - r);
  });
  Surface surface(field.reader());
  TickCounters counters;
  Contact contact;
  // Below the pit, where the penetration is the gentle cell's own normal.
  const SurfacePoint pit{{3, 3}, 1.0, 1.0, {4.0, 4.0, 0.0}, 0.0};
  EXPECT_TRUE(contactTest(surface, pit, {3.0, 3.0, -1.0}, counters, contact));
  EXPECT_LT(glm::dot(contact.penetration_mm, surfaceNormal(surface, pit).direction), 0.0);
  EXPECT_EQ(counters.mean_normal_overruled, 1);
}

TEST(Search, MoreRoundsNeverEndFartherAndEnoughOfThemEndWhereAllDo) {
  std::mt19937_64 random(22);
  int stopped = 0;
  for (int i = 0; i < 500; ++i) {
    const engine::Version field = randomField(random, 16, 16, i % 6, 0.5, 1.0, 0.0);
    Surface surface(field.reader());
    const glm::dvec3 e{uniform(random, 0, 7.5), uniform(random, 0, 15), uniform(random, -6, 6)};
    CellIndex own;
    ASSERT_TRUE(surface.cellUnder(e, own));
    const SearchResult all = searchDownhill(surface, e, own, 0.5, 0.5);
    double before = HUGE_VAL;
    for (const int rounds : {2, 3, 5, 8, 13, 100, kMaxRounds}) {
      const SearchResult some = searchDownhill(surface, e, own, 0.5, 0.5, rounds);
      // The point of the last round but one is kept where the last went astray, so equal is legal.
      EXPECT_LE(some.point.distance2_mm2, before * (1 + 1e-9));
      before = some.point.distance2_mm2;
      stopped += some.end == SearchEnd::kBound;
    }
    EXPECT_EQ(before, all.point.distance2_mm2);
  }
  EXPECT_GT(stopped, 500);
}

TEST(Search, ProxyIsOnTheSurfaceAndNoSharingCellIsNearer) {
  std::mt19937_64 random(21);
  for (int i = 0; i < 1500; ++i) {
    const int kind = i % 6;
    const engine::Version field = randomField(random, 16, 16, kind, 0.5, 1.0, i % 4 == 0 ? 0.05 : 0.0);
    Surface surface(field.reader());
    const glm::dvec3 e{uniform(random, 0, 7.5), uniform(random, 0, 15), uniform(random, -6, 6)};
    CellIndex own;
    Patch patch;
    ASSERT_TRUE(surface.cellUnder(e, own));
    const SearchResult found = searchDownhill(surface, e, own, 0.5, 0.5);
    ASSERT_EQ(found.end == SearchEnd::kHole, !surface.patch(own, patch));
    if (found.end == SearchEnd::kHole) continue;
    ASSERT_EQ(found.end, SearchEnd::kAtRest);
    const double size = kind == 4 ? 1e6 : 50.0;
    const glm::dvec3 p = found.point.position_mm;
    CellIndex under;
    ASSERT_TRUE(surface.cellUnder(p, under));
    // Strictly nearer than where it started, or there.
    ASSERT_TRUE(surface.patch(own, patch));
    EXPECT_LE(found.point.distance2_mm2, std::pow(glm::length(patch.at(0.5, 0.5) - e), 2) * (1 + 1e-12));
    ASSERT_TRUE(surface.patch(found.point.cell, patch));
    EXPECT_NEAR(patch.heightAt(found.point.u, found.point.v), p.z, 1e-15 * size);
    if (kind == 4) continue;
    // No point of a ring around it, in whichever cells, is nearer, beyond the ring's own curvature in
    // rounding.
    for (int k = 0; k < 12; ++k) {
      glm::dvec3 q = p + 1e-6 * glm::dvec3(std::cos(k * 0.5236), std::sin(k * 0.5236), 0.0);
      CellIndex cell;
      Patch near;
      if (!surface.cellUnder(q, cell) || !surface.patch(cell, near)) continue;
      q.z = near.heightAt((q.x - near.x0) / near.sx, (q.y - near.y0) / near.sy);
      // The descent stops within 1e-7 of a patch's minimum: 1e-7 * 1e-6 * curvature(<= 4e3) of slack.
      ASSERT_GE(glm::dot(q - e, q - e), found.point.distance2_mm2 - 1e-9) << "field " << i;
    }
  }
}

// The search as the source describes it: the bounded closest point of the cell, then of every cell that
// shares it, moving to the nearest until none is nearer.
double distanceOfTheSourcesSearch(Surface& surface, const glm::dvec3& e, CellIndex cell, double u, double v) {
  Patch patch;
  EXPECT_TRUE(surface.patch(cell, patch));
  PatchPoint best = closestOnPatch(patch, e, u, v);
  for (bool moved = true; moved;) {
    moved = false;
    PatchPoint nearest = best;
    CellIndex nearest_cell = cell;
    forEachSharing(surface, cell, best.u, best.v, [&](const SharingCell& other) {
      if (!surface.patch(other.cell, patch)) return;
      const PatchPoint p = closestOnPatch(patch, e, other.u, other.v);
      if (!(p.distance2_mm2 < nearest.distance2_mm2)) return;
      nearest = p;
      nearest_cell = other.cell;
      moved = true;
    });
    best = nearest;
    cell = nearest_cell;
  }
  return std::sqrt(best.distance2_mm2);
}

TEST(Search, EndsAsNearAsTheSourcesOwnOverManyNoisyStarts) {
  std::mt19937_64 random(57);
  double ours = 0.0;
  double sources = 0.0;
  double closest = 0.0;
  int same = 0;
  int farther = 0;
  int nearer = 0;
  for (int i = 0; i < 40; ++i) {
    const engine::Version field = randomField(random, 40, 40, i % 4, 0.5, 0.5);
    Surface surface(field.reader());
    for (int k = 0; k < 100; ++k) {
      const glm::dvec3 e{uniform(random, 6, 14), uniform(random, 6, 14), uniform(random, -3, 0)};
      CellIndex start;
      ASSERT_TRUE(
          surface.cellUnder(e + glm::dvec3(uniform(random, -1, 1), uniform(random, -1, 1), 0), start));
      const double a = std::sqrt(searchDownhill(surface, e, start, 0.5, 0.5).point.distance2_mm2);
      const double b = distanceOfTheSourcesSearch(surface, e, start, 0.5, 0.5);
      SurfacePoint truth;
      ASSERT_TRUE(certifiedClosest(surface, e, 12.0, truth));
      ours += a;
      sources += b;
      closest += std::sqrt(truth.distance2_mm2);
      same += std::abs(a - b) <= 1e-9 * b ? 1 : 0;
      farther += a > b * (1 + 1e-9) ? 1 : 0;
      nearer += b > a * (1 + 1e-9) ? 1 : 0;
    }
  }
  // The source's rule looks at more ways down and so ends nearer a little more often; what counts is how far
  // either stays from the truth.
  EXPECT_GE(ours, closest);
  EXPECT_LE(farther, 200);
  EXPECT_LE(ours - closest, 1.05 * (sources - closest));
  RecordProperty("same", same);
  RecordProperty("farther", farther);
  RecordProperty("nearer", nearer);
  std::printf("of 4000: same %d, nearer %d, farther %d; mean excess %.4f mm, of the source's %.4f mm\n", same,
              nearer, farther, (ours - closest) / 4000, (sources - closest) / 4000);
}

TEST(Collision, NeverMissesWhatBruteForceSees) {
  std::mt19937_64 random(9);
  for (int i = 0; i < 400; ++i) {
    const engine::Version field = randomField(random, 90, 80, i, 1.0, 1.0, i % 5 == 0 ? 0.05 : 0.0);
    Surface surface(field.reader());
    const glm::dvec3 from{uniform(random, -10, 100), uniform(random, -10, 90), uniform(random, 0, 12)};
    const glm::dvec3 to{uniform(random, -10, 100), uniform(random, -10, 90), uniform(random, -6, 12)};
    std::vector<RayCell> walked;
    RayWalk walk(surface, from, to);
    RayCell cell;
    while (walk.next(cell)) {
      ASSERT_LE(cell.enter, cell.leave);
      walked.push_back(cell);
    }
    // Every point of the ray that lies below the surface must be in a cell that the walk offered.
    for (int k = 0; k <= 3000; ++k) {
      const glm::dvec3 at = from + (k / 3000.0) * (to - from);
      CellIndex under;
      Patch patch;
      if (!surface.cellUnder(at, under) || !surface.patch(under, patch) || !belowPatch(patch, at)) continue;
      bool offered = false;
      // On a line between two cells either will do.
      for (const RayCell& w : walked)
        offered = offered || (at.x >= w.cell.column - 1e-9 && at.x <= w.cell.column + 1 + 1e-9 &&
                              at.y >= w.cell.row - 1e-9 && at.y <= w.cell.row + 1 + 1e-9);
      ASSERT_TRUE(offered) << "field " << i << " at " << at.x << ' ' << at.y;
    }
  }
}

// Over a plain that squares of the pyramid clear, to a wall at its end: from every place and in every direction it is found, in
// few steps.
TEST(Collision, ALongRayOverClearedSquaresComesToTheWallAtItsEnd) {
  const engine::Version field = tests::fieldOf(
      600, 600, [](int c, int r) { return c < 20 || c >= 580 || r < 20 || r >= 580 ? 50.0 : 0.0; });
  Surface surface(field.reader());
  std::mt19937_64 random(12);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 from{uniform(random, 30, 570), uniform(random, 30, 570), uniform(random, 20, 40)};
    const double angle = uniform(random, 0.0, 6.28);
    const glm::dvec3 to = from + glm::dvec3(700.0 * std::cos(angle), 700.0 * std::sin(angle), -10.0);
    RayWalk walk(surface, from, to);
    RayCell cell;
    bool entered = false;
    while (!entered && walk.next(cell)) {
      Patch patch;
      ASSERT_TRUE(surface.patch(cell.cell, patch));
      entered = entersPatch(patch, from, to, cell.enter, cell.leave);
    }
    ASSERT_TRUE(entered) << i;
    EXPECT_FALSE(walk.stoppedByBound());
    // The wall's foot is within one cell of 20 and 580.
    const glm::dvec3 at = from + cell.enter * (to - from);
    const double margin = std::min(std::min(at.x, 599.0 - at.x), std::min(at.y, 599.0 - at.y));
    EXPECT_NEAR(margin, 19.5, 0.6) << i;
  }
}

TEST(Tick, AHandBelowTheSurfaceIsAlwaysInContactAndItsProxyOnTheSurface) {
  std::mt19937_64 random(31);
  for (int i = 0; i < 60; ++i)
    for (const ContactLevel level :
         {ContactLevel::kPaper, ContactLevel::kDescent, ContactLevel::kCertified}) {
      const engine::Version field = randomField(random, 40, 40, i, 0.3, 0.4);
      Scene scene;
      scene.level = level;
      scene.certified_radius_cells = 3;
      Bench bench(field, scene);
      for (int k = 0; k < 200; ++k) {
        const glm::dvec3 e{uniform(random, 0, 11.7), uniform(random, 0, 15.6), uniform(random, -4, 8)};
        CellIndex under;
        Patch patch;
        ASSERT_TRUE(bench.tick.surface().cellUnder(e, under) && bench.tick.surface().patch(under, patch));
        const ForceSample f = bench.at(e.x, e.y, e.z);
        EXPECT_TRUE(f.contact || !belowPatch(patch, e)) << i << ' ' << levelName(level);
        EXPECT_LE(glm::length(f.force_n), scene.force_limit_n * (1 + 1e-15));
        if (!f.contact) continue;
        const SurfacePoint& p = bench.tick.contact().proxy;
        ASSERT_TRUE(bench.tick.surface().patch(p.cell, patch));
        EXPECT_EQ(patch.at(p.u, p.v), f.proxy_mm);
      }
    }
}

}  // namespace
}  // namespace fettle::haptic
