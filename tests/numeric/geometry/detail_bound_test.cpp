// How far a coarse surface may lie from the fine one, on fields made to defeat it: spikes of one sample at
// any place, steps next to the borders of patches, waves that every vertex of a level meets at the same
// height. The twin is both surfaces themselves in double precision (tests/render/support/drawn_surface.h); on
// the screen the same two, projected.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <glm/geometric.hpp>

#include "engine/field/live_field.h"
#include "render/detail/patches.h"
#include "tests/numeric/geometry/pebbles.h"
#include "tests/numeric/support/rare.h"
#include "tests/render/support/drawn_surface.h"
#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

constexpr double kAnyTightness = 1e300;

std::string differing(const DetailMeasure& kept, const DetailMeasure& fresh) {
  std::string wrong;
  for (int level = 1; level <= fresh.topLevel(); ++level)
    for (int y = 0; y < fresh.patches(level).y; ++y)
      for (int x = 0; x < fresh.patches(level).x; ++x) {
        const DetailMeasure::Error a = kept.error(level, x, y), b = fresh.error(level, x, y);
        if (a.deviation != b.deviation || a.excess != b.excess)
          wrong += fmt::format("level {} patch {} {}: {} {} for {} {}\n", level, x, y, a.deviation, a.excess,
                               b.deviation, b.excess);
      }
  return wrong;
}

TEST(DetailBound, HoldsForASpikeOfOneSampleAnywhere) {
  // Closed form. A spike between vertices is its whole height above the coarse surface, in every patch whose
  // rectangle has it (on a border: two or four). At a vertex it is a cone to the next vertices, and one
  // sample next to it the coarse surface is too high by 1 - 1 / stride of it. Rounding: four last bits of
  // 1e6.
  const int width = 200, height = 140;
  const float high = 1e6F;
  engine::LiveField live(fieldOf(gridOf(width, height), [](int, int) { return 0.0; }),
                         engine::Growth::kAllowed);
  DetailMeasure measure;
  measure.measure(live.reader());
  std::set<std::pair<int, int>> places;
  for (const int c : {0, 1, 15, 16, 17, 31, 32, 33, 48, 63, 64, 65, 127, 128, 129, 160, 198, 199})
    for (const int r : {0, 1, 16, 33, 63, 64, 65, 127, 128, 138, 139}) places.insert({c, r});
  std::mt19937 random(4);
  for (int i = 0; i < 200; ++i)
    places.insert({static_cast<int>(random() % 200), static_cast<int>(random() % 140)});
  const double slack = 4.0 * std::numeric_limits<float>::epsilon() * 1e6;
  for (const auto& [c, r] : places) {
    ASSERT_TRUE(live.setHeight(c, r, high));
    const glm::ivec2 tile(c / 64, r / 64);
    measure.refresh(live.reader(), {&tile, 1});
    for (int level = 1; level <= measure.topLevel(); ++level) {
      const int stride = 1 << level, side = DetailMeasure::side(level);
      const auto vertex = [&](int s, int last) { return s % stride == 0 || s == last; };
      const bool at_vertex = vertex(c, width - 1) && vertex(r, height - 1);
      const double least = high * (at_vertex ? 1.0 - 1.0 / stride : 1.0) - slack;
      for (int y = 0; y < measure.patches(level).y; ++y)
        for (int x = 0; x < measure.patches(level).x; ++x) {
          const bool has = c >= x * side && c <= (x + 1) * side && r >= y * side && r <= (y + 1) * side;
          const double deviation = measure.error(level, x, y).deviation;
          // In cells cut short by the end of the field the two diagonals part, and the last stride is
          // shorter.
          const bool cut = (c / stride + 1) * stride > width - 1 || (r / stride + 1) * stride > height - 1;
          if (has && !(cut && at_vertex)) {
            ASSERT_GE(deviation, least) << "level " << level << " spike at " << c << " " << r;
          }
          ASSERT_LE(deviation, 2.0 * high) << "level " << level << " spike at " << c << " " << r;
        }
    }
    ASSERT_TRUE(live.setHeight(c, r, 0.0F));
    measure.refresh(live.reader(), {&tile, 1});
  }
  DetailMeasure flat;
  flat.measure(live.reader());
  EXPECT_EQ(differing(measure, flat), "");
}

TEST(DetailBound, HoldsForWavesThatEveryVertexOfALevelMeetsAtOneHeight) {
  // 2^k samples a wave: from level k up all vertices are on the same phase and the coarse surface is flat.
  for (const int k : {1, 2, 3, 4})
    for (const int phase : {0, 1}) {
      SCOPED_TRACE(k);
      const int wave = 1 << k;
      expectBound(fieldOf(gridOf(100, 83),
                          [&](int c, int r) {
                            const double x = std::cos(2.0 * M_PI * (c + phase) / wave);
                            return 5.0 * x * std::cos(2.0 * M_PI * r / wave);
                          }),
                  2.5);
    }
}

TEST(DetailBound, HoldsForCheckerboardsAndForStepsBesideTheBordersOfPatches) {
  expectBound(fieldOf(gridOf(81, 97), [](int c, int r) { return (c + r) % 2 == 0 ? 1.0 : -1.0; }), 2.5);
  expectBound(fieldOf(gridOf(81, 97), [](int c, int r) { return (c / 2 + r / 2) % 2 == 0 ? 1e6 : -1e6; }),
              kAnyTightness);
  for (const int at : {15, 16, 17, 31, 32, 33, 63, 64, 65}) {
    SCOPED_TRACE(at);
    expectBound(fieldOf(gridOf(83, 70), [&](int c, int r) { return c >= at || r >= at ? 1e6 : 0.1 * c; }),
                kAnyTightness);
  }
}

TEST(DetailBound, HoldsForFieldsThatHolesLeaveLittleOf) {
  constexpr double hole = kNan;
  // Samples left only where no vertex of any level is; not at the first ones next to them; single rows
  // between holes.
  expectBound(
      fieldOf(gridOf(90, 80), [&](int c, int r) { return c % 8 == 0 || r % 8 == 0 ? hole : pebble(c, r); }),
      kAnyTightness);
  expectBound(
      fieldOf(gridOf(90, 80), [&](int c, int r) { return c % 4 == 1 && r % 4 == 1 ? hole : pebble(c, r); }),
      kAnyTightness);
  expectBound(fieldOf(gridOf(90, 80), [&](int, int r) { return r % 3 == 2 ? hole : 1e5 * r; }),
              kAnyTightness);
}

// Measures, raises one sample, measures its tile again and all again.
std::string afterRaising(const engine::Version& start, int column, int row) {
  DetailMeasure kept;
  kept.measure(start.reader());
  engine::LiveField live(start, engine::Growth::kAllowed);
  EXPECT_TRUE(live.setHeight(column, row, 700.0F));
  const glm::ivec2 tile(column / 64, row / 64);
  kept.refresh(live.reader(), {&tile, 1});
  DetailMeasure fresh;
  fresh.measure(live.reader());
  return differing(kept, fresh);
}

TEST(DetailBound, AfterAnEditTwoTilesAwayFromAHoleEqualsAFreshOne) {
  // At the stride of a tile a hole's vertex looks at every eighth sample up to a tile away, and from 896 on
  // these are all missing but a few. So the vertex (1024, 64) of tile (15, 1), a sample of tile (16, 1),
  // takes its height from (1088, 0) of tile (17, 0); the other three vertices of that tile are there. All of
  // tile 15 is of another patch than tile 17, whose own deviation would hide it.
  const auto lattice = [](std::set<std::pair<int, int>> there, int width, int height) {
    return fieldOf(gridOf(width, height), [there = std::move(there)](int c, int r) {
      const bool missing = std::max(c, r) >= 896 && c % 8 == 0 && r % 8 == 0 && !there.contains({c, r});
      return missing ? static_cast<double>(kNan) : 1.0 + 0.01 * (c % 5);
    });
  };
  EXPECT_EQ(afterRaising(lattice({{960, 64}, {960, 128}, {1024, 128}, {1088, 0}}, 1200, 200), 1088, 0), "");
  // And the vertex (0, 1024) of tile (0, 15) from (64, 1088) of tile (1, 17).
  EXPECT_EQ(afterRaising(lattice({{64, 1024}, {128, 896}, {64, 1088}}, 200, 1200), 64, 1088), "");
}

TEST(DetailBound, AfterAnEditBesideATileWithoutHolesEqualsAFreshOne) {
  // Tile (1, 0) has no hole, but its upper left vertex is the one hole of tile (1, 1) and takes its height
  // from (63, 63), of tile (0, 0).
  const engine::Version start = fieldOf(
      gridOf(300, 300), [](int c, int r) { return c == 64 && r == 64 ? static_cast<double>(kNan) : 1.0; });
  EXPECT_EQ(afterRaising(start, 63, 63), "");
}

RC_GTEST_PROP(DetailBound, AfterAnyEditOfAFieldWithManyHolesEqualsAFreshOne, ()) {
  // Which samples are there is decided by residues, so that whole sets of vertices can be missing; the edits
  // are rectangles, some of holes.
  const int every = *rc::gen::element(2, 4, 8, 16, 32, 64).as("samples at multiples of this are missing");
  const int gap = *rc::gen::inRange(0, 130).as("columns missing from 64 on");
  const auto height = [&](int c, int r) -> double {
    if (c >= 64 && c < 64 + gap && r < 70) return kNan;
    return c % every == 0 && r % every == 0 ? kNan : pebble(c, r);
  };
  const engine::Version start = fieldOf(gridOf(530, 70), height);
  engine::LiveField live(start, engine::Growth::kAllowed);
  DetailMeasure kept;
  kept.measure(start.reader());
  const auto edits = *rc::gen::container<std::vector<std::tuple<int, int, int, int>>>(
                          rc::gen::tuple(rc::gen::inRange(0, 530), rc::gen::inRange(0, 70),
                                         rc::gen::inRange(1, 70), rc::gen::inRange(0, 4)))
                          .as("edits: column, row, side, height (0 a hole)");
  for (const auto& [c, r, wanted, value] : edits) {
    const int w = std::min(wanted, 530 - c), h = std::min(wanted, 70 - r);
    const std::vector<float> block(static_cast<std::size_t>(w * h),
                                   value == 0 ? kNan : 10.0F * static_cast<float>(value));
    RC_ASSERT(live.writeHeights(c, r, w, h, block.data(), w));
    std::vector<glm::ivec2> tiles;
    for (int tr = r / 64; tr <= (r + h - 1) / 64; ++tr)
      for (int tc = c / 64; tc <= (c + w - 1) / 64; ++tc) tiles.emplace_back(tc, tr);
    kept.refresh(live.reader(), tiles);
  }
  DetailMeasure fresh;
  fresh.measure(live.reader());
  const std::string wrong = differing(kept, fresh);
  if (!wrong.empty()) RC_FAIL(wrong);
}

// ---- on the screen ----

// Squared distance from p to the triangle a b c in the plane.
double distance2(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  const auto cross = [](glm::dvec2 u, glm::dvec2 v) { return u.x * v.y - u.y * v.x; };
  const double s1 = cross(b - a, p - a), s2 = cross(c - b, p - b), s3 = cross(a - c, p - c);
  if ((s1 >= 0 && s2 >= 0 && s3 >= 0) || (s1 <= 0 && s2 <= 0 && s3 <= 0)) {
    // Of a triangle seen edge on every point is on all three lines: the sides below decide.
    if (std::abs(cross(b - a, c - a)) > 1e-9) return 0.0;
  }
  const auto side = [&](glm::dvec2 u, glm::dvec2 v) {
    const glm::dvec2 d = v - u;
    const double size = glm::dot(d, d);
    const double t = size > 0.0 ? std::clamp(glm::dot(p - u, d) / size, 0.0, 1.0) : 0.0;
    const glm::dvec2 away = p - (u + t * d);
    return glm::dot(away, away);
  };
  return std::min({side(a, b), side(b, c), side(c, a)});
}

// What is drawn of one patch, and the fine surface over it, cell by cell of the patch's level.
class ScreenTwin {
 public:
  ScreenTwin(const engine::Version& field, const PatchQuery& q) : reader_(field.reader()), q_(q) {}

  // The largest distance from a point of either surface to the other one, over a patch, as far as one cell of
  // its level can measure: an upper bound of the true one. The fine surface's samples are enough, and the
  // coarse one's at samples: each is linear on the other's triangles but for its own kinks.
  [[nodiscard]] double worst(glm::ivec2 first, int level) const {
    const int stride = 1 << level, side = DetailMeasure::side(level);
    const glm::ivec2 end = q_.placing.size - 1, last = glm::min(first + side, end);
    double most = 0.0;
    for (int r = first.y; r < last.y; r += stride)
      for (int c = first.x; c < last.x; c += stride)
        most = std::max(most, cell({c, r}, glm::min(glm::ivec2(c, r) + stride, end), stride));
    return most;
  }

 private:
  using Triangle = std::array<glm::dvec2, 3>;
  [[nodiscard]] glm::dvec2 pixel(double x, double y, double height) const {
    const double z = (std::clamp(height, q_.lowest, q_.highest) - q_.reference) * q_.mm_per_unit;
    const glm::dvec2 xy = q_.placing.first + q_.placing.spacing * glm::dvec2(x, y);
    return q_.camera.pixelOf({xy.x, xy.y, z});
  }
  [[nodiscard]] glm::dvec2 vertex(glm::ivec2 s, int stride) const {
    return pixel(s.x, s.y, drawnHeight(reader_, s, stride));
  }
  static void push(std::vector<Triangle>& out, const glm::dvec2& z00, const glm::dvec2& z10,
                   const glm::dvec2& z01, const glm::dvec2& z11) {
    out.push_back({z00, z10, z01});
    out.push_back({z11, z10, z01});
  }
  [[nodiscard]] double cell(glm::ivec2 a, glm::ivec2 b, int stride) const {
    std::vector<Triangle> coarse, fine;
    push(coarse, vertex(a, stride), vertex({b.x, a.y}, stride), vertex({a.x, b.y}, stride),
         vertex(b, stride));
    std::vector<glm::dvec2> points;
    for (int r = a.y; r < b.y; ++r)
      for (int c = a.x; c < b.x; ++c)
        push(fine, vertex({c, r}, 1), vertex({c + 1, r}, 1), vertex({c, r + 1}, 1),
             vertex({c + 1, r + 1}, 1));
    const auto farthest = [](const std::vector<Triangle>& from, const std::vector<Triangle>& to) {
      double most = 0.0;
      for (const Triangle& t : from)
        for (const glm::dvec2& p : {t[0], t[1], t[2], (t[0] + t[1] + t[2]) / 3.0, (t[0] + t[1]) / 2.0}) {
          double nearest = HUGE_VAL;
          for (const Triangle& u : to) nearest = std::min(nearest, distance2(p, u[0], u[1], u[2]));
          most = std::max(most, nearest);
        }
      return std::sqrt(most);
    };
    return std::max(farthest(fine, coarse), farthest(coarse, fine));
  }

  engine::FieldReader reader_;
  const PatchQuery& q_;
};

TEST(ScreenBound, HoldsForEverySampleOfFieldsMadeToDefeatIt) {
  struct Case {
    const char* name;
    std::function<double(int, int)> height;
  };
  const std::vector<Case> cases = {
      {"noise", [](int c, int r) { return pebble(c, r); }},
      {"a spike", [](int c, int r) { return c == 37 && r == 51 ? 200.0 : 0.0; }},
      {"a step next to a patch", [](int c, int) { return c > 32 ? 30.0 : 0.0; }},
      {"a checkerboard", [](int c, int r) { return (c + r) % 2 == 0 ? 3.0 : -3.0; }},
      {"a wave of 16", [](int c, int r) { return 8.0 * std::cos(M_PI / 8 * c) * std::cos(M_PI / 8 * r); }},
      {"a saddle", [](int c, int r) { return 0.02 * ((c - 60) * (c - 60) - (r - 45) * (r - 45)); }},
      {"a slope of 100", [](int c, int r) { return 100.0 * c + r; }},
  };
  int looked = 0, coarse = 0;
  double nearest = 0.0;
  for (const Case& test : cases)
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective})
      for (const auto& [azimuth, elevation] : {std::pair{315.0, 45.0}, {20.0, 8.0}, {0.0, 90.0}})
        for (const double error_px : {0.7, 6.0})
          for (const auto& [cut, known] : {std::pair{false, 9}, {true, 9}, {false, 2}, {false, 0}}) {
            SCOPED_TRACE(
                fmt::format("{} {} {} {} {} {}", test.name, azimuth, elevation, error_px, cut, known));
            const engine::Version field = fieldOf(gridOf(97, 75, 0.5, 0.8), test.height);
            DetailMeasure measure;
            measure.begin(field.reader());
            // Of four tiles.
            (void)measure.measureSome(field.reader(), static_cast<std::size_t>(known));
            ASSERT_EQ(measure.unknown(), static_cast<std::size_t>(std::max(0, 4 - known)));
            const engine::HeightBounds all = field.reader().bounds();
            PatchQuery q;
            q.measure = &measure;
            q.reader = field.reader();
            q.placing = placingOf(field.grid());
            q.error_px = error_px;
            q.lowest = cut ? all.min + 0.2 * (all.max - all.min) : all.min;
            q.highest = cut ? all.min + 0.7 * (all.max - all.min) : all.max;
            q.reference = 0.5 * (q.lowest + q.highest);
            const glm::dvec2 extent = q.placing.extent();
            const double half_z = 0.5 * (q.highest - q.lowest);
            const Box box{{-0.5 * extent.x, -0.5 * extent.y, -half_z},
                          {0.5 * extent.x, 0.5 * extent.y, half_z}};
            q.floor_z = -half_z;
            View view;
            view.azimuth_deg = azimuth;
            view.elevation_deg = elevation;
            view.projection = projection;
            q.camera = Camera::fit(view, box, box, {0, 0, 300, 200});
            const PatchTree tree(q);
            const PatchChoice choice = tree.list();
            ASSERT_TRUE(choice.within_budget);
            ASSERT_LE(choice.bound_px, error_px);
            const ScreenTwin twin(field, q);
            for (const gpu::Patch& patch : choice.patches) {
              ++looked;
              if (patch.place.z == 0) continue;
              ++coarse;
              const double worst = twin.worst({patch.place.x, patch.place.y}, patch.place.z);
              // 1e-6 px: roundings of the twin, of points some 300 px wide in double, squared and back.
              ASSERT_LE(worst, choice.bound_px + 1e-6)
                  << patch.place.x << " " << patch.place.y << " level " << patch.place.z;
              nearest = std::max(nearest, worst / error_px);
            }
          }
  // The bound is in use, and not by a mile: somewhere half of what is allowed is really there.
  EXPECT_GT(coarse, looked / 10);
  EXPECT_GT(nearest, 0.3);
}

}  // namespace
}  // namespace fettle::render
