// What DetailMeasure promises, against the two surfaces themselves in double precision.
#include "render/detail/detail.h"

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "engine/field/live_field.h"
#include "render/detail/patch_tree_cache.h"
#include "tests/render/support/drawn_surface.h"
#include "tests/render/support/fields.h"
#include "tests/render/support/patch_query.h"

namespace fettle::render {
namespace {

double rough(int c, int r) {
  std::uint32_t h = static_cast<std::uint32_t>(c) * 2654435761U ^ static_cast<std::uint32_t>(r) * 2246822519U;
  h ^= h >> 15U;
  h *= 2246822519U;
  return 0.3 * std::sin(c * 0.11) * std::cos(r * 0.07) + 0.05 * ((h >> 8U) / 8388608.0 - 1.0);
}

TEST(Detail, NoPointLiesFartherFromACoarseSurfaceThanItsPatchSays) {
  // 257 = whole cells at every level; the others are cut short at some or all. The kink of a cut cell is a
  // bound, not a measurement, hence the slack.
  for (const auto& [w, h] : {std::pair{257, 130}, {150, 203}, {65, 64}, {66, 131}}) {
    SCOPED_TRACE(w);
    expectBound(fieldOf(gridOf(w, h), rough), 2.5);
  }
}

TEST(Detail, FieldsWithoutCellsStepsSpikesAndGiantHeightsAreBounded) {
  expectBound(fieldOf(gridOf(1, 1), rough), 1e9);
  expectBound(fieldOf(gridOf(1, 90), rough), 1e9);
  expectBound(fieldOf(gridOf(140, 1), rough), 1e9);
  expectBound(fieldOf(gridOf(129, 129), [](int c, int r) { return c > 70   ? 12.0
                                                                  : r > 33 ? -4.0
                                                                           : 0.0; }),
              1e9);
  expectBound(fieldOf(gridOf(129, 129), [](int c, int r) { return c == 77 && r == 41 ? 1e6 : rough(c, r); }),
              1e9);
  expectBound(fieldOf(gridOf(100, 100), [](int c, int r) { return 1e7 + rough(c, r); }), 1e9);
  expectBound(fieldOf(gridOf(100, 100), [](int c, int r) { return (c + r) % 2 == 0 ? 3e38 : -3e38; }), 1e9);
}

TEST(Detail, HolesSmallWideAndScatteredAreBounded) {
  expectBound(
      fieldOf(gridOf(130, 140), [](int c, int r) { return (c * 13 + r * 7) % 41 == 0 ? kNan : rough(c, r); }),
      1e9);
  expectBound(fieldOf(gridOf(130, 140),
                      [](int c, int r) { return std::hypot(c - 70, r - 60) < 33 ? kNan : rough(c, r); }),
              1e9);
  // Only a corner and a thin line are there.
  expectBound(
      fieldOf(gridOf(200, 200),
              [](int c, int r) { return c + r < 9 || std::abs(c - r - 31) < 2 ? rough(c, r) : kNan; }),
      1e9);
  expectBound(fieldOf(gridOf(90, 90), [](int, int) { return kNan; }), 1e9);
}

TEST(Detail, LevelsAboveTheTileAreBoundedByWhatLiesBelow) {
  // One patch of level 8 takes 4096 samples at 16 cells: a long thin field reaches the nested levels.
  const engine::Version field = fieldOf(gridOf(3000, 20), [](int c, int r) {
    return c % 701 == 33 ? kNan : 5 * std::sin(c * 0.004) + rough(c, r);
  });
  DetailMeasure measure;
  measure.measure(field.reader());
  ASSERT_GT(measure.topLevel(), DetailMeasure::kTileLevels);
  expectBound(field, 1e9);
}

TEST(Detail, KinkOfACellCutShortIsBoundedAboveTheTilesToo) {
  // The surface of level 6 of a twisted field, at every sample: level 6 draws it as it is. Its vertices lie on what level 7
  // draws, but for the row in the middle, where the diagonals of cells that are 65 rows high part from each other.
  const auto twist = [](double c, double r) { return 1e-3 * c * r; };
  const engine::Version field = fieldOf(gridOf(1100, 66), [&](int c, int r) {
    const int c0 = c / 64 * 64, r0 = std::min(r / 64 * 64, 64), c1 = std::min(c0 + 64, 1099),
              r1 = r0 == 0 ? 64 : 65;
    if (c1 == c0) return twist(c, r);
    const double u = static_cast<double>(c - c0) / (c1 - c0), v = static_cast<double>(r - r0) / (r1 - r0);
    const double z10 = twist(c1, r0), z01 = twist(c0, r1);
    return u + v <= 1.0 ? (1.0 - u - v) * twist(c0, r0) + u * z10 + v * z01
                        : (u + v - 1.0) * twist(c1, r1) + (1.0 - u) * z01 + (1.0 - v) * z10;
  });
  DetailMeasure measure;
  measure.measure(field.reader());
  ASSERT_EQ(measure.topLevel(), DetailMeasure::kTileLevels + 1);
  expectBound(field, 1e9);
}

TEST(Detail, ExcessIsHowFarSamplesReachBeyondTheVerticesOfTheirCell) {
  // A step has none; a spike between vertices has all of its height; a hole makes it unbounded.
  DetailMeasure measure;
  measure.measure(fieldOf(gridOf(129, 129), [](int c, int) { return c > 70 ? 12.0 : 0.0; }).reader());
  for (int level = 1; level <= measure.topLevel(); ++level)
    for (int y = 0; y < measure.patches(level).y; ++y)
      for (int x = 0; x < measure.patches(level).x; ++x) EXPECT_LT(measure.error(level, x, y).excess, 1e-4);
  measure.measure(
      fieldOf(gridOf(129, 129), [](int c, int r) { return c == 35 && r == 35 ? 7.0 : 0.0; }).reader());
  EXPECT_NEAR(measure.error(1, 35 / DetailMeasure::side(1), 35 / DetailMeasure::side(1)).excess, 7.0, 1e-4);
  measure.measure(
      fieldOf(gridOf(129, 129), [](int c, int r) { return c == 35 && r == 35 ? kNan : 0.0; }).reader());
  EXPECT_TRUE(std::isinf(measure.error(2, 35 / DetailMeasure::side(2), 35 / DetailMeasure::side(2)).excess));
}

// One spike on the line between four patches, level by level: whoever has it among its samples, and no other, is off by it.
TEST(Detail, AnErrorIsThatOfThePatchesThatHaveItAlone) {
  for (const glm::ivec2 spike : {glm::ivec2(64, 3), {64, 35}, {31, 63}, {3, 64}, {127, 65}}) {
    DetailMeasure measure;
    measure.measure(fieldOf(gridOf(193, 193), [&](int c, int r) {
                      return c == spike.x && r == spike.y ? 7.0 : 0.0;
                    }).reader());
    for (int level = 1; level <= measure.topLevel(); ++level) {
      const int side = DetailMeasure::side(level);
      for (int y = 0; y < measure.patches(level).y; ++y)
        for (int x = 0; x < measure.patches(level).x; ++x) {
          const glm::ivec2 first = glm::ivec2(x, y) * side, last = first + side;
          const bool has = first.x <= spike.x && spike.x <= last.x && first.y <= spike.y && spike.y <= last.y;
          EXPECT_EQ(measure.error(level, x, y).deviation > 1e-3F, has)
              << "level " << level << ' ' << x << ' ' << y;
        }
    }
  }
}

TEST(Detail, AfterAnEditTheMeasureEqualsAFreshOneBitForBit) {
  std::mt19937 random(7);
  const engine::Version start = fieldOf(gridOf(700, 300), [](int c, int r) {
    return std::hypot(c - 320, r - 128) < 20 || (c * 31 + r * 17) % 997 == 0 ? kNan : rough(c, r);
  });
  engine::LiveField live(start, engine::Growth::kAllowed);
  DetailMeasure cached;
  cached.measure(start.reader());
  for (int edit = 0; edit < 25; ++edit) {
    const int c = static_cast<int>(random() % 690), r = static_cast<int>(random() % 290);
    const std::vector<float> bump(100, edit % 5 == 0 ? kNan : static_cast<float>(edit));
    ASSERT_TRUE(live.writeHeights(c, r, 10, 10, bump.data(), 10));
    std::vector<glm::ivec2> tiles;
    for (int tr = r / 64; tr <= (r + 9) / 64; ++tr)
      for (int tc = c / 64; tc <= (c + 9) / 64; ++tc) tiles.emplace_back(tc, tr);
    cached.refresh(live.reader(), tiles);
    DetailMeasure fresh;
    fresh.measure(live.reader());
    for (int level = 1; level <= fresh.topLevel(); ++level)
      for (int y = 0; y < fresh.patches(level).y; ++y)
        for (int x = 0; x < fresh.patches(level).x; ++x) {
          ASSERT_EQ(cached.error(level, x, y).deviation, fresh.error(level, x, y).deviation)
              << "edit " << edit << " level " << level << ' ' << x << ' ' << y;
          ASSERT_EQ(cached.error(level, x, y).excess, fresh.error(level, x, y).excess);
        }
  }
}

// Every number of `some` is that of `all`, or infinite.
void expectSafe(const DetailMeasure& some, const DetailMeasure& all, int& known) {
  known = 0;
  for (int level = 1; level <= all.topLevel(); ++level)
    for (int y = 0; y < all.patches(level).y; ++y)
      for (int x = 0; x < all.patches(level).x; ++x) {
        const DetailMeasure::Error a = some.error(level, x, y), b = all.error(level, x, y);
        if (std::isinf(a.deviation) && std::isinf(a.excess)) continue;
        ++known;
        ASSERT_EQ(a.deviation, b.deviation) << "level " << level << ' ' << x << ' ' << y;
        ASSERT_EQ(a.excess, b.excess) << "level " << level << ' ' << x << ' ' << y;
      }
}

TEST(Detail, MeasuredInPartsItIsInfiniteUntilItIsTheSameBitForBit) {
  // 12 x 47 tiles; a level above the tile's; holes of all kinds.
  const engine::Version field = fieldOf(gridOf(3000, 700), [](int c, int r) {
    return std::hypot(c - 320, r - 128) < 90 || (c * 31 + r * 17) % 9973 == 0 ? kNan : rough(c, r);
  });
  DetailMeasure all;
  all.measure(field.reader());
  EXPECT_EQ(all.unknown(), 0U);
  DetailMeasure parts;
  parts.begin(field.reader());
  ASSERT_EQ(parts.unknown(), std::size_t{47 * 11});
  int known = -1, before = -1;
  expectSafe(parts, all, known);
  EXPECT_EQ(known, 0);
  while (parts.unknown() > 0) {
    const std::size_t left = parts.unknown();
    ASSERT_EQ(parts.measureSome(field.reader(), 37), std::min<std::size_t>(37, left));
    before = known;
    expectSafe(parts, all, known);
    EXPECT_GE(known, before);
  }
  EXPECT_GT(known, before);

  // An edit meanwhile, of tiles that are known and of such that are not.
  engine::LiveField live(field, engine::Growth::kAllowed);
  parts.begin(field.reader());
  (void)parts.measureSome(field.reader(), 300);
  std::vector<glm::ivec2> tiles;
  for (int i = 0; i < 40; ++i) {
    const int c = i * 71, r = i * 17;
    ASSERT_TRUE(live.setHeight(c, r, i % 4 == 0 ? kNan : static_cast<float>(i)));
    tiles.emplace_back(c / 64, r / 64);
  }
  all.measure(live.reader());
  parts.invalidate(live.reader(), tiles);
  expectSafe(parts, all, known);
  while (parts.unknown() > 0) (void)parts.measureSome(live.reader(), 64);
  int whole = 0;
  expectSafe(parts, all, whole);
  EXPECT_GT(whole, known);
  for (int level = 1; level <= all.topLevel(); ++level)
    for (int y = 0; y < all.patches(level).y; ++y)
      for (int x = 0; x < all.patches(level).x; ++x) {
        ASSERT_EQ(parts.error(level, x, y).deviation, all.error(level, x, y).deviation);
        ASSERT_EQ(parts.error(level, x, y).excess, all.error(level, x, y).excess);
      }
}

// The patches, edges and walls of a tree as plain numbers.
std::vector<int> numbersOf(const PatchTree& tree) {
  const PatchChoice choice = tree.list();
  std::vector<int> numbers{static_cast<int>(choice.whole), choice.within_budget ? 1 : 0};
  for (const auto* list : {&choice.patches, &choice.seams, &choice.walls})
    for (const gpu::Patch& p : *list)
      numbers.insert(numbers.end(), {p.place.x, p.place.y, p.place.z, p.place.w});
  return numbers;
}

// A tower of 10 mm in the picture, of which the camera sees the top alone.
TEST(PatchTree, WhatReachesIntoThePictureIsDrawnHoweverHeightsAreExaggerated) {
  for (const double mm_per_unit : {0.1, 1.0, 10.0}) {
    const double tall = 10.0 / mm_per_unit;
    const engine::Version field = fieldOf(gridOf(400, 300, 0.1, 0.1), [&](int c, int r) {
      return std::abs(c - 200) < 10 && std::abs(r - 150) < 10 ? tall : 0.0;
    });
    DetailMeasure measure;
    measure.measure(field.reader());
    PatchQuery q;
    q.measure = &measure;
    q.reader = field.reader();
    q.placing = placingOf(field.grid());
    q.mm_per_unit = mm_per_unit;
    q.lowest = -tall, q.highest = 2.0 * tall, q.floor_z = -1.0, q.error_px = 0.5;
    const glm::dvec2 half = 0.5 * q.placing.extent();
    View view;
    view.elevation_deg = 3.0;
    const Box top{{-1.0, -1.0, 8.0}, {1.0, 1.0, 10.0}}, all{{-half.x, -half.y, -1.0}, {half.x, half.y, 20.0}};
    q.camera = Camera::fit(view, top, all, {0, 0, 300, 300});
    const std::vector<PatchLeaf> leaves = PatchTree(q).leaves();
    const bool drawn = std::any_of(leaves.begin(), leaves.end(), [](const PatchLeaf& leaf) {
      const int side = DetailMeasure::side(leaf.level);
      const glm::ivec2 first = leaf.patch * side;
      return first.x <= 200 && first.x + side >= 200 && first.y <= 150 && first.y + side >= 150;
    });
    EXPECT_TRUE(drawn) << mm_per_unit;
    EXPECT_LT(leaves.size(), 20U) << "the ground below is not seen";
  }
}

// What is drawn from pages is divided into squares of some samples: together they are the whole surface, each once.
TEST(PatchTree, PartsOfItsLeavesCoverTheSurfaceOnce) {
  const engine::Version field = fieldOf(gridOf(400, 300, 0.1, 0.1), rough);
  DetailMeasure measure;
  measure.measure(field.reader());
  PatchQuery q = queryOver(field, measure);
  q.error_px = 20.0;
  const PatchTree tree(q);
  std::vector<int> covered(399 * 299, 0);  // cells
  for (const PatchLeaf& part : tree.parts(6)) {
    const int side = DetailMeasure::side(part.level);
    ASSERT_LE(side, 64);
    const glm::ivec2 first = part.patch * side;
    for (int r = first.y; r < std::min(first.y + side, 299); ++r)
      for (int c = first.x; c < std::min(first.x + side, 399); ++c)
        ++covered[static_cast<std::size_t>(r * 399 + c)];
  }
  EXPECT_EQ(std::count(covered.begin(), covered.end(), 1), 399 * 299);
}

TEST(PatchChoice, CountsTheVerticesOfAllThatItDraws) {
  PatchChoice choice;
  EXPECT_EQ(choice.vertices(), 0);
  choice.patches.resize(5);
  EXPECT_EQ(choice.vertices(), 5 * gpu::kPatchVertices);
  choice.seams.resize(3);
  choice.walls.resize(2);
  EXPECT_EQ(choice.vertices(), 5 * gpu::kPatchVertices + 3 * gpu::kSeamVertices + 2 * gpu::kWallVertices);
  // Two triangles a cell; a seam joins both sides of its strip.
  EXPECT_EQ(choice.triangles(), (5 * gpu::kPatchCells + 2 * 3 + 2) * 2 * gpu::kPatchCells);
}

TEST(PatchTreeCache, AreWhatChoosingAgainGivesAfterEveryChange) {
  const engine::Version field = fieldOf(gridOf(400, 300, 0.1, 0.1), rough);
  engine::LiveField live(field, engine::Growth::kAllowed);
  DetailMeasure measure;
  measure.begin(field.reader());
  PatchQuery q = queryOver(field, measure);
  PatchTreeCache cached;
  engine::Version shown = field;
  std::vector<int> last;
  int changes = 0;
  const auto expectChosen = [&](const char* what) {
    SCOPED_TRACE(what);
    q.reader = shown.reader();
    const std::vector<int> wanted = numbersOf(PatchTree(q));
    for (int i = 0; i < 2; ++i) {
      PatchTree tree = cached.tree(1, q, shown);
      EXPECT_EQ(numbersOf(tree), wanted);
      // What a frame makes of its own is not cached.
      (void)tree.prune([](const PatchLeaf& leaf) { return leaf.level > 3; });
    }
    changes += wanted != last;
    last = wanted;
  };
  expectChosen("nothing is known");
  while (measure.unknown() > 0) {
    (void)measure.measureSome(shown.reader(), 9);
    expectChosen("more is known");
  }
  const std::vector<float> bump(20 * 20, 0.9F);
  ASSERT_TRUE(live.writeHeights(100, 100, 20, 20, bump.data(), 20));
  shown = live.snapshot();
  const glm::ivec2 tile(1, 1);
  measure.refresh(shown.reader(), std::span(&tile, 1));
  expectChosen("an edit");
  q.vertex_budget = 40000;
  expectChosen("fewer vertices");
  q.error_px = 4.0;
  expectChosen("a larger error");
  View closer;
  closer.zoom = 3.0;
  q.camera = cameraOver(field, closer);
  expectChosen("another view");
  q.mm_per_unit = 5.0;
  expectChosen("exaggerated");
  q.up_to_date = [](glm::ivec2, glm::ivec2) { return false; };
  expectChosen("samples on their way");
  q.up_to_date = {};
  shown = field;
  measure.refresh(shown.reader(), std::span(&tile, 1));
  expectChosen("undone");
  EXPECT_GE(changes, 6);
}

// In any order: what is found to have no holes is listed first.
std::set<std::array<int, 4>> patchesOf(const PatchTree& tree) {
  std::set<std::array<int, 4>> patches;
  for (const gpu::Patch& p : tree.list().patches)
    patches.insert({p.place.x, p.place.y, p.place.z, p.place.w});
  return patches;
}

TEST(PatchTreeCache, ATreeIsKeptWhileFewOfManyTilesBecomeKnown) {
  const engine::Version field = fieldOf(gridOf(2600, 2000, 0.1, 0.1), rough);
  DetailMeasure measure;
  measure.begin(field.reader());
  const std::size_t all = measure.unknown();
  ASSERT_GT(all, 1200U);
  PatchQuery q = queryOver(field, measure);
  q.reader = field.reader();
  PatchTreeCache cached;
  auto drawn = patchesOf(cached.tree(0, q, field));
  std::size_t known_then = all;
  int chosen = 0, frames = 0, others = 0;
  while (measure.unknown() > 0) {
    (void)measure.measureSome(field.reader(), 16);
    ++frames;
    const bool anew = measure.unknown() < 512 || 8 * measure.unknown() <= 7 * known_then;
    const auto now = patchesOf(cached.tree(0, q, field)), wanted = patchesOf(PatchTree(q));
    EXPECT_EQ(now, anew ? wanted : drawn) << measure.unknown();
    others += wanted != drawn;
    if (anew) known_then = measure.unknown();
    chosen += anew && measure.unknown() >= 512;
    drawn = now;
  }
  EXPECT_EQ(numbersOf(cached.tree(0, q, field)), numbersOf(PatchTree(q)));
  EXPECT_GT(chosen, 4);
  EXPECT_LT(chosen, frames / 5);
  EXPECT_GT(others, 10);
}

TEST(PatchTreeCache, ATreeIsNotKeptWhereTilesBecameUnknown) {
  const engine::Version field = fieldOf(gridOf(2600, 2000, 0.1, 0.1), rough);
  DetailMeasure measure;
  measure.begin(field.reader());
  (void)measure.measureSome(field.reader(), 300);
  PatchQuery q = queryOver(field, measure);
  q.reader = field.reader();
  PatchTreeCache cached;
  (void)cached.tree(0, q, field);
  // One that was known, among the 300 measured; and as many more are known.
  std::vector<glm::ivec2> tiles;
  for (int i = 0; i < 10; ++i) tiles.emplace_back(i, 0);
  measure.invalidate(field.reader(), tiles);
  (void)measure.measureSome(field.reader(), 12);
  EXPECT_EQ(numbersOf(cached.tree(0, q, field)), numbersOf(PatchTree(q)));
}

}  // namespace
}  // namespace fettle::render
