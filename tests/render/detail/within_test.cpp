// What a rectangle of samples holds, against a look at every one of them.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "render/detail/patches.h"
#include "tests/render/support/fields.h"

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

}  // namespace
}  // namespace fettle::render
