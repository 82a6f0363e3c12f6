// The mesh, its topmost surface and its distances, beside a search through all triangles in long double.

#include "engine/nominal/nominal_mesh.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "engine/nominal/nominal_surface.h"
#include "tests/engine/nominal/meshes.h"

namespace fettle::engine {
namespace {

using Long = long double;
using LongPoint = std::array<Long, 3>;

LongPoint wide(const glm::dvec3& p) {
  return {p.x, p.y, p.z};
}
LongPoint less(const LongPoint& a, const LongPoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Long product(const LongPoint& a, const LongPoint& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The highest of all triangles over a place; NaN without one.
Long plainTop(const Triangles& triangles, Long x, Long y) {
  Long top = std::numeric_limits<Long>::quiet_NaN();
  for (const TriangleCorners& t : triangles) {
    const LongPoint a = wide(t[0]), u = less(wide(t[1]), a), v = less(wide(t[2]), a);
    const Long area = u[0] * v[1] - u[1] * v[0];
    if (area == 0) continue;
    const Long s = ((x - a[0]) * v[1] - (y - a[1]) * v[0]) / area,
               w = (u[0] * (y - a[1]) - u[1] * (x - a[0])) / area;
    if (s < 0 || w < 0 || s + w > 1) continue;
    const Long z = a[2] + s * u[2] + w * v[2];
    if (!(z <= top)) top = z;
  }
  return top;
}

// The shortest distance to all triangles: to the foot where it lies inside, to the sides.
Long plainDistance(const Triangles& triangles, const glm::dvec3& point) {
  Long best = std::numeric_limits<Long>::infinity();
  const LongPoint p = wide(point);
  for (const TriangleCorners& t : triangles) {
    const LongPoint a = wide(t[0]), u = less(wide(t[1]), a), v = less(wide(t[2]), a), q = less(p, a);
    const Long uu = product(u, u), uv = product(u, v), vv = product(v, v), uq = product(u, q),
               vq = product(v, q);
    const Long determinant = uu * vv - uv * uv;
    const auto squareAt = [&](Long s, Long w) {
      const LongPoint off{q[0] - s * u[0] - w * v[0], q[1] - s * u[1] - w * v[1], q[2] - s * u[2] - w * v[2]};
      return product(off, off);
    };
    if (determinant > 0) {
      const Long s = (vv * uq - uv * vq) / determinant, w = (uu * vq - uv * uq) / determinant;
      if (s >= 0 && w >= 0 && s + w <= 1) best = std::min(best, squareAt(s, w));
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const LongPoint from = wide(t[k]), along = less(wide(t[(k + 1) % 3]), from), r = less(p, from);
      const Long s = std::min(std::max(product(r, along) / product(along, along), Long{0}), Long{1});
      const LongPoint off{r[0] - s * along[0], r[1] - s * along[1], r[2] - s * along[2]};
      best = std::min(best, product(off, off));
    }
  }
  return std::sqrt(best);
}

// Triangles anywhere: over each other, slivers a millionth as wide as long, vertical ones, spikes 1e6 high.
Triangles anyTriangles(std::uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(0.0, 100.0), small(-8.0, 8.0), share(0.0, 1.0);
  Triangles out;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 a(place(random), place(random), small(random));
    glm::dvec3 u(small(random), small(random), small(random)), v(small(random), small(random), small(random));
    const double kind = share(random);
    if (kind < 0.1)
      v = u + 1e-6 * v;
    else if (kind < 0.2)
      v = glm::dvec3(0.5 * u.x, 0.5 * u.y, v.z);
    else if (kind < 0.22)
      u.z = 1e6;
    out.push_back({a, a + u, a + v});
  }
  return out;
}

TEST(NominalMesh, HasTheTopAndTheDistanceOfASearchThroughAllTriangles) {
  double worst_top = 0.0, worst_distance = 0.0;
  int tops = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Triangles triangles = anyTriangles(seed, 700);
    const NominalMesh mesh = meshOf(triangles);
    ASSERT_EQ(mesh.triangles().size() + mesh.withoutArea(), triangles.size());
    RigidMotion back;
    back.shift = mesh.corner();
    const NominalSurface surface(mesh, back, 0.0);
    std::mt19937_64 random(seed + 10);
    std::uniform_real_distribution<double> place(-5.0, 105.0), height(-30.0, 30.0);
    for (int i = 0; i < 1500; ++i) {
      const glm::dvec3 p(place(random), place(random), height(random));
      const NominalSurface::Top top = surface.topAt(p.x, p.y);
      const Long plain_top = plainTop(triangles, p.x, p.y);
      ASSERT_EQ(std::isnan(top.z), std::isnan(plain_top)) << i;
      if (!std::isnan(top.z)) {
        ++tops;
        // Of spikes the error counts beside their height.
        worst_top =
            std::max(worst_top, static_cast<double>(std::abs(plain_top - top.z)) / (1.0 + std::abs(top.z)));
      }
      const auto distance = mesh.distanceTo(p - mesh.corner(), 1e9);
      ASSERT_TRUE(distance);
      worst_distance = std::max(
          worst_distance, static_cast<double>(std::abs(plainDistance(triangles, p) - std::abs(*distance))));
    }
  }
  EXPECT_GT(tops, 1500);
  std::printf("topmost surface within %.1e of the plain search, distance within %.1e mm\n", worst_top,
              worst_distance);
  // Places of slivers and of walls: slopes to 1e6 times the rounding of 100 mm, 1.4e-14.
  EXPECT_LT(worst_top, 1e-7);
  // Coordinates round to 1.4e-14 mm; the foot on a spike 1e6 high to 1.2e-10.
  EXPECT_LT(worst_distance, 1e-9);
}

TEST(NominalMesh, NoPlaceFallsBetweenItsTriangles) {
  // Corners anywhere near those of a lattice, so that places lie on sides, on corners and on the border; then turned.
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> off(-0.3, 0.3);
  std::vector<glm::dvec3> corners;
  constexpr int kSide = 40;
  for (int r = 0; r <= kSide; ++r)
    for (int c = 0; c <= kSide; ++c) {
      const bool rim = r == 0 || c == 0 || r == kSide || c == kSide;
      corners.emplace_back(c + (rim || c % 3 == 0 ? 0.0 : off(random)),
                           r + (rim || r % 2 == 0 ? 0.0 : off(random)), off(random));
    }
  Triangles triangles;
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      const auto at = [&](int i, int j) {
        return corners[static_cast<std::size_t>((r + j) * (kSide + 1) + c + i)];
      };
      triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
      triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  const NominalMesh mesh = meshOf(triangles);
  EXPECT_EQ(mesh.openSides(), 4U * kSide);
  EXPECT_EQ(mesh.oddSides(), 0U);
  Grid grid;
  grid.width = 4 * kSide + 1;
  grid.height = kSide + 1;
  grid.spacing_x = 0.25;
  grid.spacing_y = 1.0;
  const NominalSurface surface(mesh, {}, slackOn(grid));
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const auto top = surface.topAt(0.25 * c, r);
      ASSERT_FALSE(std::isnan(top.z)) << c << ' ' << r;
      ASSERT_TRUE(top.up);
      ASSERT_LE(std::abs(top.z), 0.3);
    }
  // Places on the sides themselves, as far as doubles go, of the mesh turned and far away.
  RigidMotion turned;
  turned = turned.then({5e6, -5e6, 3.0}, {0.0, 0.0, 0.7});
  const NominalSurface away(mesh, turned, 0.0);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < 20000; ++i) {
    const auto& t = triangles[static_cast<std::size_t>(random() % triangles.size())];
    const double s = i % 2 == 0 ? 0.0 : share(random);
    glm::dvec3 p = t[0] + s * (t[2] - t[0]);
    if (p.x <= 0.0 || p.y <= 0.0 || p.x >= kSide || p.y >= kSide) continue;
    p = turned.moved(p);
    ASSERT_FALSE(std::isnan(away.topAt(p.x, p.y).z)) << i;
  }
}

TEST(NominalMesh, KnowsInsideFromOutside) {
  const glm::dvec3 centre(3.0, -2.0, 7.0);
  const NominalMesh sphere = meshOf(sphereOf(centre, 5.0, 40));
  EXPECT_EQ(sphere.openSides(), 0U);
  EXPECT_EQ(sphere.oddSides(), 0U);
  const NominalMesh turned = meshOf(turnedRound(sphereOf(centre, 5.0, 40)));
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 1.0);
  // Flat triangles lie inside the sphere by at most the rise of their arcs: 5 (1 - cos(pi / 80)) along each of two.
  const double flat = 2.0 * 5.0 * (1.0 - std::cos(std::numbers::pi / 80.0));
  for (int i = 0; i < 3000; ++i) {
    glm::dvec3 direction(normal(random), normal(random), normal(random));
    direction /= std::sqrt(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z);
    const double radius = 5.0 * (0.05 + 0.0006 * i);
    const glm::dvec3 p = centre + radius * direction - sphere.corner();
    const auto distance = sphere.distanceTo(p, 1e9), other = turned.distanceTo(p, 1e9);
    ASSERT_TRUE(distance && other);
    ASSERT_GE(*distance, radius - 5.0 - 1e-9);
    ASSERT_LE(*distance, radius - 5.0 + flat + 1e-9);
    ASSERT_EQ(*other, -*distance);
  }
  // A wedge of 10 degrees: near its edge the plane of the nearest face alone gives the wrong side.
  const double rise = std::tan(5.0 * std::numbers::pi / 180.0);
  const glm::dvec3 a(0, 0, 0), b(0, 10, 0), c(10, 0, 10 * rise), d(10, 10, 10 * rise), e(10, 0, -10 * rise),
      f(10, 10, -10 * rise);
  const NominalMesh wedge =
      meshOf({{a, c, d}, {a, d, b}, {a, b, f}, {a, f, e}, {c, e, f}, {c, f, d}, {a, e, c}, {b, d, f}});
  EXPECT_EQ(wedge.openSides(), 0U);
  EXPECT_EQ(wedge.oddSides(), 0U);
  for (const double z : {-0.3, -0.01, 0.0, 0.01, 0.3})
    for (const double x : {-1.0, -0.1, -0.03})  // beyond |z| tan(5 degrees) a face is nearer
      EXPECT_NEAR(*wedge.distanceTo({x, 5.0, z}, 1e9), std::hypot(x, z), 1e-12) << x << ' ' << z;
  EXPECT_LT(*wedge.distanceTo({1.0, 5.0, 0.0}, 1e9), 0.0);
}

TEST(NominalMesh, SaysWhatIsWrongWithAMesh) {
  Triangles flat = surfaceOver(10, 10, 4, 4, [](double, double) { return 0.0; });
  std::swap(flat[5][1], flat[5][2]);                     // wound the other way
  flat.push_back({flat[0][0], flat[0][1], flat[0][0]});  // no area
  flat.push_back(flat[8]);                               // twice
  const NominalMesh mesh = meshOf(flat);
  EXPECT_EQ(mesh.withoutArea(), 1U);
  EXPECT_GE(mesh.oddSides(), 5U);
  JobControl job;
  for (const Triangles& none : {Triangles(), Triangles{{glm::dvec3(0), glm::dvec3(1), glm::dvec3(2)}}}) {
    const auto refused = NominalMesh::create(none, "n.stl", job);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().line().find("no triangle that has an area, n.stl"), std::string::npos);
  }
  JobControl stopped;
  stopped.cancel();
  const auto none =
      NominalMesh::create(surfaceOver(1, 1, 9, 9, [](double, double) { return 0.0; }), "", stopped);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
