// Continuity: a bounded move of the hand is a bounded change of the force, and a ridge keeps the proxy on the
// side on which it came in.
//
// How far a force may jump on a surface of slope L < 1. At a local minimum of the distance the penetration p
// lies in the cone of the normals there, so |p_xy| <= L p_z; and the proxy is on the surface, h above or
// below that over the endpoint by at most L |p_xy|. With h the depth of the endpoint below the surface over
// it:
//   h / (1 + L^2) <= p_z <= h / (1 - L^2),   |p_xy| <= L p_z.
// A tick later h is another h', |h' - h| <= |move_z| + L |move_xy|, and p' may be another minimum's: all it
// can differ by is the spread of both intervals. That shrinks with the depth, so contact begins and ends
// without a step. It holds for each way to touch: of a ball's surface, grown by its radius, L is the same,
// and h at most r sqrt(1 + L^2) more.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/tick/tick.h"
#include "tests/haptic/support/fields.h"
#include "tests/numeric/support/hard_fields.h"

namespace fettle::haptic {
namespace {

using tests::Choice;
using tests::HardField;
using tests::Jumps;
using tests::ulps;

class Continuity : public ::testing::TestWithParam<Choice> {};

TEST_P(Continuity, ABoundedMoveOnALipschitzFieldIsABoundedJumpOfForce) {
  for (const char* name : {"flat", "tilted", "waves", "concave_corner", "duplicate_minima", "roof",
                           "pyramid_vertex", "upside_down"}) {
    const HardField hard = tests::hardField(name);
    const double slope = hard.slope;
    ASSERT_LT(slope, 1.0) << name;
    const Scene scene = tests::sceneFor(GetParam(), hard.field.grid());
    const double radius = scene.tip == TipShape::kSphere ? scene.tip_radius_mm : 0.0;
    engine::LiveField live(hard.field, engine::Growth::kAllowed);
    Tick tick(scene, live, hard.field);
    // Well within the field: a ball that came in from outside it is held by its side.
    const double side = hard.field.grid().width - 1.0;
    std::vector<StrokeSample> path = tests::wander(hard, 8000, 21, Jumps::kNo);
    for (StrokeSample& sample : path) {
      sample.tip_mm.x = std::clamp(sample.tip_mm.x, 3.0, side - 3.0);
      sample.tip_mm.y = std::clamp(sample.tip_mm.y, 3.0, side - 3.0);
    }
    const auto depthOf = [&](const glm::dvec3& e) {
      return static_cast<double>(tests::heightAt(hard.field, e.x, e.y)) - e.z +
             radius * std::hypot(1.0, slope);
    };
    std::int64_t looked = 0, jumps = 0;
    double largest = 0.0, nearest = 0.0;
    glm::dvec3 last{0.0};
    double last_depth = NAN;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const glm::dvec3 force = tick.run(path[i]).force_n;
      const double depth = depthOf(path[i].tip_mm);
      const glm::dvec3& e = path[i].tip_mm;
      // A proxy on the field's border is no local minimum of a surface without one: left out.
      const glm::dvec3& proxy = tick.contact().proxy.position_mm;
      const bool inside = !tick.contact().touching || (proxy.x > 1e-6 && proxy.y > 1e-6 &&
                                                       proxy.x < side - 1e-6 && proxy.y < side - 1e-6);
      if (inside && std::isfinite(last_depth) && std::isfinite(depth)) {
        const double up = std::max({depth, last_depth, 0.0}) / (1.0 - slope * slope);
        const double down = std::max(std::min(depth, last_depth), 0.0) / (1.0 + slope * slope);
        const double spread = radius > 0.0 ? up : up - down;  // a ball's own depth is not worked out here
        const glm::dvec3 move = e - path[i - 1].tip_mm;
        // On a plane the force moves exactly as the hand does; else the spread along z and twice it sideways.
        const double bound =
            std::hypot(spread, 2.0 * slope * up) + glm::length(move) + 1e-4 * radius + ulps(64, hard.size_mm);
        const double jump = glm::length(force - last);
        ASSERT_LE(jump, bound) << name << " tick " << i;
        ++looked;
        largest = std::max(largest, jump);
        nearest = std::max(nearest, jump / bound);
        jumps += jump > 2.0 * glm::length(move) + 1e-3 * (1.0 + radius) ? 1 : 0;
      }
      last = force;
      last_depth = inside ? depth : NAN;
    }
    EXPECT_GT(looked, 4000) << name;
    tests::tellRare(std::string(name) + " " + tests::choiceName(GetParam()), tick.counters(),
                    fmt::format("{} of {} jumps to another minimum, largest {:.3g} N, {:.2g} of the bound",
                                jumps, looked, largest, nearest));
  }
}

// A wall one sample wide, H high, its crest at column 20. A hand that comes in on one side below the crest
// stays with that side while the foot of the perpendicular on its face lies below the crest: for (H - z) H
// beyond it. A ball's centre is kept out by the whole wall.
TEST_P(Continuity, AProxyNeverPassesARidgeItEnteredFromOneSide) {
  if (GetParam() == Choice::kCertified)
    GTEST_SKIP() << "has no memory: the closest point changes sides (contact.h)";
  std::int64_t held = 0;
  for (const double height : {1.5, 3.0, 8.0, 200.0})
    for (const int turn : {0, 1, 2, 3})
      for (const double step : {0.01, 0.13, 0.4}) {
        const bool along_y = turn % 2 != 0;
        const engine::Version field =
            tests::fieldOf(41, 41, [&](int c, int r) { return (along_y ? r : c) == 20 ? height : 0.0; });
        Scene scene = tests::sceneFor(GetParam(), field.grid());
        engine::LiveField live(field, engine::Growth::kAllowed);
        Tick tick(scene, live, field);
        const double way = turn < 2 ? 1.0 : -1.0;
        const auto place = [&](double s, double z) {
          const double x = 20.0 + way * s;
          return along_y ? glm::dvec3(20.3, x, z) : glm::dvec3(x, 20.3, z);
        };
        static_cast<void>(tick.run({0.0, place(-8.0, 2.0), Tool::kFeel}));
        const double z = 0.5 * std::min(height, 3.0);
        const double reach = std::min((height - z) * height, 15.0);
        bool touched = false;
        for (double s = -4.0; s < reach; s += step) {
          // Down in front of the wall, where it is free, then level into it.
          const ForceSample felt = tick.run({0.0, place(s, s < -3.0 ? 2.0 : z), Tool::kFeel});
          if (!felt.contact) {
            // A point in front of the face, a ball in front of what it would touch.
            ASSERT_LT(s, 0.0);
            continue;
          }
          touched = true;
          const glm::dvec3 centre = place(s, z) + tick.contact().penetration_mm;
          const double across = way * ((along_y ? centre.y : centre.x) - 20.0);
          // The crest itself is on both sides: a point may come to rest there, within roundings of 20.
          ASSERT_LE(across, ulps(8, 20.0)) << height << ' ' << turn << ' ' << step << " at " << s;
          ++held;
        }
        ASSERT_TRUE(touched);
      }
  EXPECT_GT(held, 1000);
}

INSTANTIATE_TEST_SUITE_P(Numeric, Continuity, ::testing::ValuesIn(tests::kChoices),
                         [](const auto& one) { return tests::choiceName(one.param); });

// Symmetric minima: on the plane of symmetry under a crest two faces are equally near. A tip at rest stays
// with one of them; one that trembles by a last bit across the plane, too, at level paper: it tracks. Level
// certified has no memory and may change sides: its changes are counted.
TEST(SymmetricMinima, ATipUnderACrestDoesNotDitherBetweenItsFaces) {
  for (const char* name : {"roof", "ridge_one_sample_wide", "pyramid_vertex"})
    for (const Choice choice : tests::kChoices) {
      const HardField hard = tests::hardField(name);
      engine::LiveField live(hard.field, engine::Growth::kAllowed);
      Tick tick(tests::sceneFor(choice, hard.field.grid()), live, hard.field);
      const double surface = static_cast<double>(tests::heightAt(hard.field, 12.0, 12.0));
      const bool ball = choice == Choice::kSphere;
      for (double z = surface + 3.0; z > surface - 2.0; z -= 0.1)
        static_cast<void>(tick.run({0.0, {12.0, 12.0, z}, Tool::kFeel}));
      for (int i = 0; i < 20; ++i)
        static_cast<void>(tick.run({0.0, {12.0, 12.0, surface - 2.0}, Tool::kFeel}));
      const glm::dvec3 rest = tick.contact().penetration_mm;
      double moved = 0.0;
      int changes = 0;
      glm::dvec3 last = rest;
      for (int i = 0; i < 10000; ++i) {
        const double tremor = i < 5000 ? 0.0 : (i % 2 == 0 ? 1e-9 : -1e-9);
        const ForceSample felt = tick.run({0.0, {12.0 + tremor, 12.0 - tremor, surface - 2.0}, Tool::kFeel});
        ASSERT_TRUE(felt.contact);
        const glm::dvec3 now = tick.contact().penetration_mm;
        // Faces lie a good part of a millimetre apart.
        changes += glm::length(now - last) > 0.1 ? 1 : 0;
        if (i < 5000) moved = std::max(moved, glm::length(now - rest));
        last = now;
      }
      // A ball may slide on by 1e-4 of a cell a tick while it comes to rest, and is at rest well before.
      EXPECT_LE(moved, ball ? 2e-3 : ulps(64, 24.0)) << name << ' ' << tests::choiceName(choice);
      // A ball balances on the crest and slides off once when it is pushed.
      if (choice != Choice::kCertified) {
        EXPECT_LE(changes, ball ? 1 : 0) << name << ' ' << tests::choiceName(choice);
      }
      tests::tellRare(std::string(name) + " " + tests::choiceName(choice), tick.counters(),
                      fmt::format("{} changes of side in 5000 ticks of 1e-9 mm tremor", changes));
    }
}

// A tip pressed into a vertex, an edge and a ridge of the surface, from above and (a pit) with the feature as
// its closest point over a whole wedge of endpoints.
TEST(Resting, OnAVertexAnEdgeAndARidgeTheProxyIsTheFeatureItself) {
  // A pit at (12, 12) and a groove along y at column 12: below them, the feature is the closest point while
  // the endpoint is within the wedge of the slopes' normals.
  const engine::Version pit =
      tests::fieldOf(25, 25, [](int c, int r) { return std::abs(c - 12.0) + std::abs(r - 12.0); });
  const engine::Version groove = tests::fieldOf(25, 25, [](int c, int) { return std::abs(c - 12.0); });
  for (const Choice choice : {Choice::kPaper, Choice::kDescent, Choice::kCertified}) {
    engine::LiveField in_pit(pit, engine::Growth::kAllowed);
    Tick at_pit(tests::sceneFor(choice, pit.grid()), in_pit, pit);
    engine::LiveField in_groove(groove, engine::Growth::kAllowed);
    Tick at_groove(tests::sceneFor(choice, groove.grid()), in_groove, groove);
    for (int i = 0; i < 200; ++i) {
      const double dx = 0.9 * std::sin(0.37 * i), dy = 0.9 * std::cos(0.23 * i);
      const ForceSample vertex = at_pit.run({0.0, {12.0 + dx, 12.0 + dy, -1.0}, Tool::kFeel});
      ASSERT_TRUE(vertex.contact);
      // u and v are exactly 0 or 1 there, so the vertex is met exactly; K = 1 N/mm: the force is the way.
      ASSERT_EQ(vertex.proxy_mm, glm::dvec3(12.0, 12.0, 0.0)) << i;
      ASSERT_EQ(vertex.force_n, glm::dvec3(12.0 - (12.0 + dx), 12.0 - (12.0 + dy), 1.0)) << i;
      const ForceSample edge = at_groove.run({0.0, {12.0 + dx, 12.0 + dy, -1.0}, Tool::kFeel});
      ASSERT_TRUE(edge.contact);
      ASSERT_EQ(edge.proxy_mm.x, 12.0);
      ASSERT_EQ(edge.proxy_mm.z, 0.0);
      // One division and one product.
      ASSERT_NEAR(edge.proxy_mm.y, 12.0 + dy, ulps(4, 24.0));
    }
  }
}

// A field of one row or one column has no cell, one whose cells all have a hole no surface.
TEST(NothingToFeel, OneRowOneColumnOneSampleAndNothingButHoles) {
  const auto one = [](int, int) { return 1.0; };
  const auto hole = [](int, int) { return static_cast<double>(tests::kHole); };
  for (const engine::Version& field :
       {tests::fieldOf(9, 1, one), tests::fieldOf(1, 9, one), tests::fieldOf(1, 1, one),
        tests::fieldOf(9, 9, hole),
        tests::fieldOf(9, 9, [](int c, int r) { return (c + r) % 2 == 0 ? NAN : 1.0; })})
    for (const Choice choice : tests::kChoices) {
      engine::LiveField live(field, engine::Growth::kAllowed);
      Tick tick(tests::sceneFor(choice, field.grid()), live, field);
      for (const double z : {3.0, 1.0, 0.0, -5.0, -1e9})
        for (double x = -0.5; x < 9.0; x += 0.5) {
          ASSERT_FALSE(tick.run({0.0, {x, 0.5, z}, Tool::kFeel}).contact);
          ASSERT_FALSE(tick.run({0.0, {0.0, x, z}, Tool::kFeel}).contact);
        }
    }
}

}  // namespace
}  // namespace fettle::haptic
