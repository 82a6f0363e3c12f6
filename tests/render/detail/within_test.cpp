// What a rectangle of samples holds, against a look at every one of them.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "engine/field/live_field.h"
#include "render/config.h"
#include "render/detail/damage.h"
#include "render/detail/patches.h"
#include "tests/render/support/fields.h"
#include "tests/render/support/patch_query.h"

namespace fettle::render {
namespace {

constexpr int kWidth = 600, kHeight = 200;

// Corners of rectangles of up to `most` steps between first and last, many of them on borders of tiles.
class Rectangles {
 public:
  explicit Rectangles(int most) : size_(0, most) {}
  void next(glm::ivec2& first, glm::ivec2& last) {
    const auto from = [&](int end) {
      const int at = std::uniform_int_distribution(0, end - 1)(random_);
      return random_() % 4 == 0 ? at / 64 * 64 : at;
    };
    first = {from(kWidth), from(kHeight)};
    last = glm::min(first + glm::ivec2(size_(random_), size_(random_)), glm::ivec2(kWidth - 1, kHeight - 1));
  }

 private:
  std::mt19937 random_{11};
  std::uniform_int_distribution<int> size_;
};

TEST(HoleWithin, IsWhatALookAtEverySampleSays) {
  const engine::Version field = fieldOf(
      gridOf(kWidth, kHeight), [](int c, int r) { return (c * 31 + r * 1009) % 2003 == 0 ? kNan : 1.0; });
  const engine::FieldReader reader = field.reader();
  Rectangles rectangles(70);
  int holed = 0;
  for (int k = 0; k < 2000; ++k) {
    glm::ivec2 first, last;
    rectangles.next(first, last);
    bool any = false;
    for (int r = first.y; r <= last.y; ++r)
      for (int c = first.x; c <= last.x; ++c) any = any || std::isnan(reader.heightAt(c, r));
    ASSERT_EQ(holeWithin(reader, first, last), any)
        << first.x << ' ' << first.y << " to " << last.x << ' ' << last.y;
    holed += any ? 1 : 0;
  }
  EXPECT_GT(holed, 500);
  EXPECT_LT(holed, 1500);
}

TEST(HeightsWithin, OfASmallRectangleAreThoseOfTheBlocksThatItTouches) {
  const engine::Version field = fieldOf(gridOf(kWidth, kHeight), [](int c, int r) {
    return std::sin(c * 0.11) * 30 + ((c * 2654435 + r * 40503) % 977) * 0.1;
  });
  const engine::FieldReader reader = field.reader();
  Rectangles rectangles(4 * engine::kBlockSide);
  for (int k = 0; k < 500; ++k) {
    glm::ivec2 first, last;
    rectangles.next(first, last);
    if (k % 5 == 0) last.x = std::min(first.x + 4 * engine::kBlockSide, kWidth - 1);
    float low = HUGE_VALF, high = -HUGE_VALF;
    const glm::ivec2 from = first / engine::kBlockSide * engine::kBlockSide;
    const glm::ivec2 to = glm::min(last / engine::kBlockSide * engine::kBlockSide + engine::kBlockSide - 1,
                                   glm::ivec2(kWidth - 1, kHeight - 1));
    for (int r = from.y; r <= to.y; ++r)
      for (int c = from.x; c <= to.x; ++c) {
        low = std::min(low, reader.heightAt(c, r));
        high = std::max(high, reader.heightAt(c, r));
      }
    const engine::HeightBounds found = heightsWithin(reader, first, last);
    ASSERT_EQ(found.min, low) << first.x << ' ' << first.y << " to " << last.x << ' ' << last.y;
    ASSERT_EQ(found.max, high) << first.x << ' ' << first.y << " to " << last.x << ' ' << last.y;
  }
}

// Edges of patches are lines of samples, without width: seams and walls are still drawn.
TEST(Within, TheWholePlotKeepsEveryPatchSeamAndWallAndBesideItNone) {
  const engine::Version field = fieldOf(gridOf(400, 300, 0.1, 0.1), [](int c, int r) {
    return c < 100 ? 0.3 * std::sin(1.9 * c) * std::cos(2.3 * r) : 0.0;  // fine patches beside coarse ones
  });
  DetailMeasure measure;
  measure.measure(field.reader());
  View view;
  view.elevation_deg = 40.0;
  const PatchQuery q = queryOver(field, measure, view);
  const PatchChoice choice = choosePatches(q);
  ASSERT_FALSE(choice.seams.empty());
  ASSERT_FALSE(choice.walls.empty());
  const PatchChoice all = within(choice, q, kQueryPlot);
  EXPECT_EQ(all.patches.size(), choice.patches.size());
  EXPECT_EQ(all.seams.size(), choice.seams.size());
  EXPECT_EQ(all.walls.size(), choice.walls.size());
  EXPECT_EQ(all.whole, choice.whole);
  // In four quarters each is in one at least.
  std::size_t patches = 0, seams = 0, walls = 0;
  for (const Rectangle& quarter :
       {Rectangle{0, 0, 450, 300}, {450, 0, 450, 300}, {0, 300, 450, 300}, {450, 300, 450, 300}}) {
    const PatchChoice part = within(choice, q, quarter);
    EXPECT_LT(part.patches.size(), choice.patches.size());
    patches += part.patches.size(), seams += part.seams.size(), walls += part.walls.size();
  }
  EXPECT_GE(patches, choice.patches.size());
  EXPECT_GE(seams, choice.seams.size());
  EXPECT_GE(walls, choice.walls.size());
  EXPECT_TRUE(within(choice, q, {}).patches.empty());
}

// A row of samples that changed across all tiles but one; as many as may be, and one less.
TEST(Damage, OfManyTilesIsTheWholePictureAndOfFewerWhatTheyCover) {
  constexpr auto kTiles = static_cast<int>(kManyTiles);
  const engine::Version before =
      fieldOf(gridOf(kTiles * 64, 4, 0.1, 0.1), [](int c, int) { return c % 2 * 0.01; });
  DetailMeasure measure;
  measure.measure(before.reader());
  View view;
  view.elevation_deg = 90.0;
  PatchQuery q = queryOver(before, measure, view);
  for (const int changed : {kTiles, kTiles - 1}) {
    engine::LiveField live(before, engine::Growth::kAllowed);
    for (int tile = 0; tile < changed; ++tile) ASSERT_TRUE(live.setHeight(tile * 64 + 20, 2, 0.5F));
    const engine::Version after = live.snapshot();
    const std::vector<engine::TileChange> tiles = engine::changedTiles(before, after);
    ASSERT_EQ(tiles.size(), static_cast<std::size_t>(changed));
    q.reader = after.reader();
    const PatchChoice choice = choosePatches(q);
    const Rectangle damage = damageOf({q, before.reader(), tiles, &choice, &choice, kQueryPlot});
    EXPECT_EQ(damage.width == kQueryPlot.width && damage.height == kQueryPlot.height, changed == kTiles)
        << damage.width << " x " << damage.height;
    EXPECT_FALSE(empty(damage));
  }
}

}  // namespace
}  // namespace fettle::render
