#include "engine/scanner/part.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string_view>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

double distance(glm::dvec2 a, glm::dvec2 b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

const Outline kShapes[] = {
    Outline::circle({3, -2}, 4),
    Outline{{1, 2}, 5, 2, 0.0, {1.0, 0.0}},
    Outline{{1, 2}, 5, 2, 1.5, {1.0, 0.0}}.rotated(33),
    Outline{{0, 0}, 6, 1, 1.0, {1.0, 0.0}}.rotated(-71),
};

TEST(Outline, DistanceEqualsTheNearestOfManyPointsOnTheLine) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-9.0, 9.0);
  for (const Outline& shape : kShapes) {
    const double step = 1e-3;
    const auto line = shape.points(step);
    for (int i = 0; i < 200; ++i) {
      const glm::dvec2 p{place(random), place(random)};
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& q : line) nearest = std::min(nearest, distance(p, q.position));
      // The nearest point listed is at most half a step along the line from the nearest there is, so at most
      // that much farther away.
      EXPECT_LE(std::abs(shape.distance(p)), nearest + 1e-12);
      EXPECT_GE(std::abs(shape.distance(p)), nearest - 0.5 * step);
    }
  }
}

TEST(Outline, PointsLieOnTheLineCloseTogetherCounterClockwiseWithNormalsOutward) {
  for (const Outline& shape : kShapes) {
    const auto line = shape.points(0.05);
    double area = 0.0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const auto& p = line[i];
      const auto& q = line[(i + 1) % line.size()];
      EXPECT_NEAR(shape.distance(p.position), 0.0, 1e-12);
      EXPECT_GT(shape.distance(p.position + p.outward * 1e-3), 0.0);
      EXPECT_LT(shape.distance(p.position - p.outward * 1e-3), 0.0);
      EXPECT_LE(distance(p.position, q.position), 0.05 + 1e-12);
      EXPECT_GT(distance(p.position, q.position), 1e-9) << "a point twice at " << i << " of " << line.size();
      area += 0.5 * (p.position.x * q.position.y - q.position.x * p.position.y);
    }
    EXPECT_GT(area, 0.0);
  }
}

TEST(Outline, InsetLiesThatFarInside) {
  for (const Outline& shape : kShapes) {
    if (shape.radius < 0.5) continue;  // sharper corners are cut off by their parallel: exact only inside
    for (const auto& p : shape.inset(0.5).points(0.1)) EXPECT_NEAR(shape.distance(p.position), -0.5, 1e-12);
  }
}

Part only(Feature feature) {
  return Part{{"test", "", 40.0, 40.0}, {feature}};
}

TEST(Part, HeightsOfEachFeatureAreTheFormulasOnes) {
  Feature boss;
  boss.outline = Outline::circle({0, 0}, 10);
  boss.level = 5;
  boss.rim = Rim::kChamfer;
  boss.rim_mm = 2;
  boss.foot_mm = 3;
  EXPECT_EQ(only(boss).heightAt({0, 0}), 5.0);
  EXPECT_NEAR(only(boss).heightAt({9, 0}), 4.0, 1e-12);         // half way down the bevel
  EXPECT_NEAR(only(boss).heightAt({10, 0}), 3.0, 1e-12);        // the outline belongs to the inside
  EXPECT_NEAR(only(boss).heightAt({10 + 1e-9, 0}), 3.0, 1e-3);  // the foot is upright where it meets the wall
  EXPECT_NEAR(only(boss).heightAt({11.5, 0}), 3.0 - std::sqrt(9.0 - 2.25), 1e-12);
  EXPECT_EQ(only(boss).heightAt({13, 0}), 0.0);

  Feature round = boss;
  round.rim = Rim::kFillet;
  EXPECT_NEAR(only(round).heightAt({9, 0}), 5.0 - (2.0 - std::sqrt(3.0)), 1e-12);

  Feature hole;
  hole.kind = FeatureKind::kThrough;
  hole.outline = Outline::circle({0, 0}, 3);
  hole.rim_mm = 1;
  EXPECT_NEAR(only(hole).heightAt({2.5, 0}), -0.5, 1e-12);
  EXPECT_TRUE(std::isnan(only(hole).heightAt({1.9, 0})));

  Feature ridge;
  ridge.kind = FeatureKind::kRoof;
  ridge.outline = Outline{{0, 0}, 8, 4, 0.0, {1.0, 0.0}};
  ridge.slope_v = 0.5;
  EXPECT_NEAR(only(ridge).heightAt({3, 0}), 2.0, 1e-12);
  EXPECT_NEAR(only(ridge).heightAt({3, -3}), 0.5, 1e-12);

  Feature bump;
  bump.kind = FeatureKind::kBump;
  bump.outline = Outline::circle({0, 0}, 4);
  bump.level = 2;
  EXPECT_NEAR(only(bump).heightAt({0, 0}), 2.0, 1e-12);
  EXPECT_NEAR(only(bump).heightAt({2, 0}), 2.0 * 0.75 * 0.75 * 0.75, 1e-12);
}

TEST(Part, SubsetOfNearFeaturesGivesTheSameHeights) {
  std::mt19937 random(3);
  for (const PartInfo& info : parts()) {
    const Part& part = *findPart(info.name);
    std::uniform_real_distribution<double> place(-0.55 * info.width_mm, 0.55 * info.width_mm);
    std::uniform_real_distribution<double> aside(-1.0, 1.0);
    for (int i = 0; i < 300; ++i) {
      const glm::dvec2 centre{place(random), place(random)};
      const auto features = part.near(centre, 1.5);
      for (int k = 0; k < 10; ++k) {
        const glm::dvec2 p = centre + glm::dvec2{aside(random), aside(random)};
        const double z = part.heightAt(p);
        const double near = Part::heightAt(p, features);
        EXPECT_TRUE(z == near || (std::isnan(z) && std::isnan(near))) << info.name;
      }
    }
  }
}

TEST(PartEdges, AreWhereTheSurfaceJumpsOrBreaksAndNameTheHighSide) {
  for (const PartInfo& info : parts()) {
    const Part& part = *findPart(info.name);
    const glm::dvec2 shift{0.5 * info.width_mm, 0.5 * info.height_mm};
    const auto edges = edgesOf(part, 0.2, shift, shift * 2.0);
    EXPECT_EQ(edges.empty(), info.name == "plate");
    for (const Edge& edge : edges) {
      ASSERT_GE(edge.points_mm.size(), 2U);
      ASSERT_EQ(edge.strength.size(), edge.points_mm.size());
      // Away from its ends, where a line may run into another: the jump is there, of the stated size.
      for (std::size_t i = 2; i + 2 < edge.points_mm.size(); ++i) {
        const glm::dvec2 p = edge.points_mm[i] - shift;
        const glm::dvec2 along = edge.points_mm[i + 1] - edge.points_mm[i - 1];
        const double l = std::hypot(along.x, along.y);
        if (l < 1e-9) continue;
        const glm::dvec2 left{-along.y / l, along.x / l};
        if (edge.kind == EdgeKind::kCrease) continue;
        // 1e-4 mm aside, past the chord's sagitta at a corner; a fillet falls sqrt(2 * 3 * 1e-4) = 0.025 mm
        // there, twice at most, and any slope far less.
        const double step = part.heightAt(p + left * 1e-3) - part.heightAt(p - left * 1e-3);
        EXPECT_NEAR(step * (edge.high_side_left ? 1.0 : -1.0), edge.strength[i], 0.2)
            << info.name << ' ' << p.x << ' ' << p.y;
      }
    }
  }
}

TEST(PartEdges, NoJumpOfTheSurfaceIsLeftOutOfTheList) {
  // Every pair of points 0.02 mm apart between which the height jumps by 0.5 mm (no slope of any part makes
  // more than 0.02 * tan(87 degrees) = 0.4 out of it, fillets at their upright ends aside, which are edges)
  // must have an edge within reach.
  for (const PartInfo& info : parts()) {
    const Part& part = *findPart(info.name);
    const double half = 0.5 * info.width_mm;
    const auto edges = edgesOf(part, 0.1, {half, half}, {2 * half, 2 * half});
    std::set<std::pair<int, int>> near;  // cells of 0.5 mm that hold an edge point, and their neighbours
    for (const Edge& edge : edges)
      for (const glm::dvec2& p : edge.points_mm)
        for (int dx = -1; dx <= 1; ++dx)
          for (int dy = -1; dy <= 1; ++dy)
            near.insert({static_cast<int>(p.x / 0.5) + dx, static_cast<int>(p.y / 0.5) + dy});
    int jumps = 0;
    for (double y = -half; y < half; y += 0.73)
      for (double x = -half; x < half; x += 0.02) {
        const double step = std::abs(part.heightAt({x + 0.02, y}) - part.heightAt({x, y}));
        if (!(step > 0.5)) continue;
        ++jumps;
        EXPECT_TRUE(near.contains({static_cast<int>((x + half) / 0.5), static_cast<int>((y + half) / 0.5)}))
            << info.name << ' ' << x << ' ' << y;
      }
    if (info.name != "plate" && info.name != "wedges") {
      EXPECT_GT(jumps, 50) << info.name;
    }
  }
}

TEST(PartEdges, ACreasesStrengthIsTheChangeOfSlope) {
  Feature ridge;
  ridge.kind = FeatureKind::kRoof;
  ridge.outline = Outline{{0, 0}, 8, 4, 0.0, {1.0, 0.0}};
  ridge.slope_v = 0.5;
  int creases = 0, points = 0;
  for (const Edge& edge : edgesOf(only(ridge), 0.2, {20, 20}, {40, 40})) {
    if (edge.kind != EdgeKind::kCrease) continue;
    ++creases;
    const bool top = std::abs(edge.points_mm.front().y - 20.0) < 1.0;
    // Differences over a millionth of a millimetre of heights of 2 mm, which are rounded to 4e-16.
    // At a corner the slope is that along the bisector.
    for (std::size_t i = 0; i < edge.strength.size(); ++i) {
      if (std::abs(edge.points_mm[i].x - 20.0) > 7.99) continue;
      EXPECT_NEAR(edge.strength[i], top ? 1.0 : 0.5, 1e-8);
      ++points;
    }
  }
  EXPECT_GE(creases, 2);
  EXPECT_GT(points, 100);
}

TEST(PartEdges, StepHiddenByALaterFeatureIsCutOut) {
  Feature low;
  low.outline = Outline{{0, 0}, 10, 10, 0.0, {1.0, 0.0}};
  low.level = 2;
  Feature cover = low;  // covers the right half of the low square's border and more
  cover.outline.centre = {10, 0};
  const Part part{{"test", "", 60.0, 60.0}, {low, cover}};
  for (const Edge& edge : edgesOf(part, 0.1, {30, 30}, {60, 60}))
    for (const glm::dvec2& p : edge.points_mm) {
      const double x = p.x - 30;
      EXPECT_FALSE(std::abs(x - 10) < 0.05 && std::abs(p.y - 30) < 9.9) << "an edge inside the union";
      EXPECT_FALSE(std::abs(x) < 0.05 && std::abs(p.y - 30) < 9.9);
    }
}

// Figures of docs/accuracy.md are measured on these parts: whoever changes one measures them again. Heights on a lattice that
// goes through no outline, rounded to a nanometre.
TEST(Parts, AreThoseThatFiguresWereMeasuredOn) {
  std::map<std::string_view, std::uint64_t> hashes;
  for (const PartInfo& info : parts()) {
    const Part& part = *findPart(info.name);
    std::uint64_t hash = 0xcbf29ce484222325U;  // FNV-1a
    for (double y = -0.5 * info.height_mm + 0.137; y < 0.5 * info.height_mm; y += 0.31)
      for (double x = -0.5 * info.width_mm + 0.091; x < 0.5 * info.width_mm; x += 0.31) {
        const double z = part.heightAt({x, y});
        const std::int64_t counts = std::isnan(z) ? -1'000'000'000'000 : std::llround(z * 1e6);
        hash = (hash ^ static_cast<std::uint64_t>(counts)) * 0x100000001b3U;
      }
    hashes[info.name] = hash;
  }
  const std::map<std::string_view, std::uint64_t> then{
      {"bracket", 6777982673048393907U}, {"die", 14588561961343591275U},  {"housing", 5454944655736536478U},
      {"plate", 11685743437851446207U},  {"ribs", 13039297739200243957U}, {"steps", 4705602449114357773U},
      {"wedges", 4735066177897901116U},
  };
  EXPECT_EQ(hashes, then);
}

TEST(Parts, NamesAreUniqueAndFound) {
  std::set<std::string_view> names;
  for (const PartInfo& info : parts()) {
    EXPECT_TRUE(names.insert(info.name).second);
    EXPECT_FALSE(info.description.empty());
    ASSERT_NE(findPart(info.name), nullptr);
  }
  EXPECT_TRUE(names.contains("bracket"));
  EXPECT_EQ(findPart("teapot"), nullptr);
}

}  // namespace
}  // namespace fettle::engine
