#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/field/builder.h"
#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "tests/support/no_data.h"

namespace fettle::engine {
namespace {

// The field as the plainest thing it could be: what every sequence of edits is checked against.
struct PlainField {
  int width;
  int height;
  std::vector<float> z;
  std::vector<std::uint8_t> marks;
};

PlainField somePlain(int width, int height, unsigned seed) {
  PlainField p{width, height, {}, {}};
  std::mt19937 random(seed);
  for (int i = 0; i < width * height; ++i) {
    p.z.push_back(random() % 13 == 0 ? kNan : static_cast<float>(random() % 1000) * 0.01F);
    p.marks.push_back(random() % 17 == 0);
  }
  return p;
}

Version toVersion(const PlainField& p) {
  Grid grid;
  grid.width = p.width;
  grid.height = p.height;
  return makeField(grid, p.z, p.marks);
}

bool same(float a, float b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

void expectEqual(const Version& version, const PlainField& plain) {
  const FieldReader f = version.reader();
  std::int64_t holes = 0;
  std::int64_t marked = 0;
  for (int r = 0; r < plain.height; ++r)
    for (int c = 0; c < plain.width; ++c) {
      const auto i = static_cast<std::size_t>(r * plain.width + c);
      RC_ASSERT(same(f.heightAt(c, r), plain.z[i]));
      RC_ASSERT(f.markedAt(c, r) == (plain.marks[i] != 0));
      holes += std::isnan(plain.z[i]);
      marked += plain.marks[i];
    }
  const FieldSummary s = summarize(version);
  RC_ASSERT(s.no_data == holes);
  RC_ASSERT(s.marked == marked);
  // Bounds and flags of the tree are exact after any edit.
  for (int level = 0, side = kBlockSide; level <= f.topLevel() + 1; ++level, side *= 8)
    for (int y = 0; y * side < plain.height; ++y)
      for (int x = 0; x * side < plain.width; ++x) {
        float lo = std::numeric_limits<float>::infinity();
        float hi = -lo;
        for (int r = y * side; r < std::min((y + 1) * side, plain.height); ++r)
          for (int c = x * side; c < std::min((x + 1) * side, plain.width); ++c) {
            const float v = plain.z[static_cast<std::size_t>(r * plain.width + c)];
            if (!std::isnan(v)) lo = std::min(lo, v), hi = std::max(hi, v);
          }
        RC_ASSERT(f.bounds(level, x, y) == (HeightBounds{lo, hi}));
      }
  RC_ASSERT((f.root().holed_children != 0) == (holes != 0));
  RC_ASSERT((f.root().marked_children != 0) == (marked != 0));
}

RC_GTEST_PROP(Versions, AnySequenceOfEditsSnapshotsAndUndosEqualsAPlainArray, ()) {
  const int width = *rc::gen::inRange(1, 200);
  const int height = *rc::gen::inRange(1, 150);
  PlainField plain = somePlain(width, height, *rc::gen::arbitrary<unsigned>());
  LiveField live(toVersion(plain), Growth::kAllowed);
  std::vector<std::pair<Version, PlainField>> snapshots;
  struct Step {
    std::vector<TileChange> changes;
    PlainField before;
    PlainField after;
  };
  std::vector<Step> done;
  std::vector<Step> undone;
  const int steps = *rc::gen::inRange(1, 25);
  for (int s = 0; s < steps; ++s) {
    const Version before = live.snapshot();
    const PlainField plain_before = plain;
    switch (*rc::gen::inRange(0, 6)) {
      case 0:
      case 1: {  // a rectangle of heights, some of them holes, over any number of tiles
        const int c = *rc::gen::inRange(0, width);
        const int r = *rc::gen::inRange(0, height);
        const int w = *rc::gen::inRange(1, width - c + 1);
        const int h = *rc::gen::inRange(1, height - r + 1);
        const float z = *rc::gen::element(kNan, 0.0F, -7.5F, 1e6F, 1e-42F);
        const std::vector<float> block(static_cast<std::size_t>(w * h), z);
        RC_ASSERT(live.writeHeights(c, r, w, h, block.data(), w));
        for (int y = r; y < r + h; ++y)
          for (int x = c; x < c + w; ++x) plain.z[static_cast<std::size_t>(y * width + x)] = z;
        break;
      }
      case 2: {
        const int c = *rc::gen::inRange(0, width);
        const int r = *rc::gen::inRange(0, height);
        const bool mark = *rc::gen::arbitrary<bool>();
        RC_ASSERT(live.setMark(c, r, mark));
        plain.marks[static_cast<std::size_t>(r * width + c)] = mark;
        break;
      }
      case 3:
        live.invert();
        for (float& z : plain.z) z = -z;
        break;
      case 4:
        if (!done.empty() && done.back().changes.size() < 1000) {
          RC_ASSERT(undo(live, done.back().changes));
          plain = done.back().before;
          undone.push_back(done.back());
          done.pop_back();
        }
        continue;
      default:
        snapshots.emplace_back(live.snapshot(), plain);
        continue;
    }
    const std::vector<TileChange> changes = changedTiles(before, live.snapshot());
    if (live.snapshot().reader().sign() == before.reader().sign()) {
      done.push_back({changes, plain_before, plain});
    } else {
      RC_ASSERT(changes.empty());  // inversion touches no tile
      done.clear();                // plain copies of earlier steps have the other sign
    }
    undone.clear();
  }
  while (!undone.empty()) {
    RC_ASSERT(redo(live, undone.back().changes));
    plain = undone.back().after;
    undone.pop_back();
  }
  expectEqual(live.snapshot(), plain);
  for (const auto& [version, kept] : snapshots) expectEqual(version, kept);
}

TEST(Versions, AnEditCopiesOneTileAndOneNodeALevelAndSharesTheRest) {
  const Version before = toVersion(somePlain(1300, 600, 1));
  const std::size_t tiles = before.memory()->tiles.liveObjects();
  LiveField live(before, Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(700, 300, 5.5F));
  EXPECT_EQ(before.memory()->tiles.liveObjects(), tiles + 1);
  const std::vector<TileChange> changes = changedTiles(before, live.snapshot());
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].tile_column, 700 / kTileSide);
  EXPECT_EQ(changes[0].tile_row, 300 / kTileSide);
}

TEST(Versions, WritingWhatIsThereCopiesNothing) {
  const Version before = toVersion(somePlain(100, 100, 2));
  LiveField live(before, Growth::kAllowed);
  std::vector<float> z(100 * 100);
  before.reader().readHeights(0, 0, 100, 100, z.data(), 100);
  ASSERT_TRUE(live.writeHeights(0, 0, 100, 100, z.data(), 100));
  EXPECT_TRUE(live.snapshot() == before);
}

TEST(Versions, UnsharedTilesAreWrittenInPlace) {
  LiveField live(toVersion(somePlain(100, 100, 3)), Growth::kNever);
  const Tile* tile = &live.reader().tile(0, 0);
  ASSERT_TRUE(live.setHeight(3, 3, 1.25F));
  EXPECT_EQ(&live.reader().tile(0, 0), tile);
}

TEST(Versions, ADryPoolRefusesTheWholeWriteAndChangesNothing) {
  const Version before = toVersion(somePlain(200, 200, 4));
  LiveField live(before, Growth::kNever);
  // Leave three free tiles and plenty of nodes, then write across four tiles.
  std::vector<TileRef> held;
  while (before.memory()->tiles.freeObjects() > 3)
    held.push_back(TileRef::adopt(before.memory()->tiles.tryAcquire()));
  const std::uint64_t hash = contentHash(before);
  const std::vector<float> z(40 * 40, 9.0F);
  EXPECT_FALSE(live.writeHeights(44, 44, 40, 40, z.data(), 40));
  EXPECT_EQ(live.refusedWrites(), 1U);
  EXPECT_EQ(contentHash(live.snapshot()), hash);
  held.clear();
  EXPECT_TRUE(live.writeHeights(44, 44, 40, 40, z.data(), 40));
}

TEST(Versions, UndoneTilesAreTheVerySameMemory) {
  const Version before = toVersion(somePlain(300, 300, 5));
  LiveField live(before, Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(10, 10, 3.0F));
  ASSERT_TRUE(live.setMark(290, 290, true));
  const std::vector<TileChange> changes = changedTiles(before, live.snapshot());
  ASSERT_TRUE(undo(live, changes));
  EXPECT_TRUE(changedTiles(before, live.snapshot()).empty());
}

TEST(Versions, EdgeLinesGoWithTheStatesThatComeFromAFieldAndDifferentOnesAreAnotherState) {
  const Version plain = toVersion(somePlain(80, 70, 5));
  EXPECT_EQ(plain.lines(), nullptr);
  const auto lines = std::make_shared<std::vector<EdgeLine>>(1);
  const Version field = plain.withLines(lines);
  EXPECT_EQ(field.lines(), lines);
  EXPECT_EQ(plain.lines(), nullptr);
  EXPECT_FALSE(field == plain);
  EXPECT_EQ(contentHash(field), contentHash(plain));
  EXPECT_TRUE(changedTiles(plain, field).empty());
  EXPECT_EQ(field.inverted().lines(), lines);
  EXPECT_EQ(field.withGrid(field.grid()).lines(), lines);
  LiveField live(field, Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(3, 3, 1.0F));
  EXPECT_EQ(live.snapshot().lines(), lines);
  EXPECT_EQ(live.adopt(plain).lines(), lines);
  EXPECT_EQ(live.snapshot().lines(), nullptr);
  EXPECT_EQ(field.withLines(nullptr), plain);
}

TEST(Versions, HaveTheSameHeightsWhateverTheirMarksLinesAndSign) {
  const Version before = toVersion(somePlain(500, 300, 5));
  LiveField live(before, Growth::kAllowed);
  ASSERT_TRUE(live.setMark(499, 299, !before.reader().markedAt(499, 299)));
  const Version marked = live.snapshot();
  EXPECT_FALSE(marked == before);
  EXPECT_TRUE(sameHeights(before, marked));
  EXPECT_TRUE(sameHeights(before, marked.inverted()));
  ASSERT_TRUE(live.setHeight(499, 299, 12345.0F));
  EXPECT_FALSE(sameHeights(before, live.snapshot()));
}

TEST(Versions, KnowTheSamplesInWhichTheyDifferWhileFewTilesDo) {
  const Version before = toVersion(somePlain(500, 300, 5));
  EXPECT_EQ(changedSamples(before, before, 0), SampleRect{});
  LiveField live(before, Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(63, 70, 12345.0F));
  EXPECT_EQ(changedSamples(before, live.snapshot(), 1), (SampleRect{63, 70, 1, 1}));
  // The same height again is no change, though its tile is another one.
  ASSERT_TRUE(live.setHeight(10, 10, before.reader().heightAt(10, 10)));
  EXPECT_EQ(changedSamples(before, live.snapshot(), 2), (SampleRect{63, 70, 1, 1}));
  ASSERT_TRUE(live.setMark(499, 299, !before.reader().markedAt(499, 299)));
  EXPECT_EQ(changedSamples(before, live.snapshot(), 3), (SampleRect{63, 70, 437, 230}));
  EXPECT_EQ(changedSamples(live.snapshot(), before, 3), (SampleRect{63, 70, 437, 230}));
  EXPECT_FALSE(changedSamples(before, live.snapshot(), 1));
}

TEST(Versions, DroppingVersionsGivesEveryTileBack) {
  std::shared_ptr<FieldMemory> memory;
  {
    const Version start = toVersion(somePlain(500, 500, 6));
    memory = start.memory();
    LiveField live(start, Growth::kAllowed);
    std::vector<Version> kept;
    for (int i = 0; i < 50; ++i) {
      ASSERT_TRUE(live.setHeight((i * 37) % 500, (i * 91) % 500, static_cast<float>(i)));
      kept.push_back(live.snapshot());
    }
  }
  EXPECT_EQ(memory->tiles.liveObjects(), 0U);
  EXPECT_EQ(memory->nodes.liveObjects(), 0U);
}

}  // namespace
}  // namespace fettle::engine
