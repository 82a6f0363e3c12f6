// What DetailMeasure promises, against the two surfaces themselves in double precision.
#include "render/detail.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "engine/field/live_field.h"
#include "render/patches.h"
#include "tests/render/fields.h"

namespace fettle::render {
namespace {

// The surface of level `level` at any place, by its definition.
class Surface {
 public:
  Surface(const engine::Version& field, int level) : reader_(field.reader()), stride_(1 << level) {
    last_ = glm::ivec2(std::max(2, reader_.width()) - 1, std::max(2, reader_.height()) - 1);
  }
  double vertex(glm::ivec2 s) const { return drawnHeight(reader_, glm::min(s, last_), stride_); }
  double at(double x, double y) const {
    const auto low = [&](double v, int last) {
      return std::min(static_cast<int>(v) / stride_ * stride_, (last - 1) / stride_ * stride_);
    };
    const glm::ivec2 a(low(x, last_.x), low(y, last_.y)), b = glm::min(a + stride_, last_);
    const double u = (x - a.x) / (b.x - a.x), v = (y - a.y) / (b.y - a.y);
    const double z00 = vertex(a), z10 = vertex({b.x, a.y}), z01 = vertex({a.x, b.y}), z11 = vertex(b);
    // A missing vertex counts where it bears on the place.
    const auto part = [](double w, double z) { return w == 0.0 ? 0.0 : w * z; };
    if (u + v <= 1.0) return part(1 - u - v, z00) + part(u, z10) + part(v, z01);
    return part(u + v - 1, z11) + part(1 - u, z01) + part(1 - v, z10);
  }

 private:
  engine::FieldReader reader_;
  int stride_;
  glm::ivec2 last_;
};

// Every patch of every level: points of the fine cells without a hole, on a grid finer than the samples.
void expectBound(const engine::Version& field, double tightness) {
  DetailMeasure measure;
  measure.measure(field.reader());
  const engine::FieldReader reader = field.reader();
  const glm::ivec2 last(std::max(2, reader.width()) - 1, std::max(2, reader.height()) - 1);
  const Surface fine(field, 0);
  const double scale = std::max(std::abs(double{reader.bounds().min}), std::abs(double{reader.bounds().max}));
  const auto sample = [&](int c, int r) {
    return reader.heightAt(std::min(c, reader.width() - 1), std::min(r, reader.height() - 1));
  };
  for (int level = 1; level <= measure.topLevel(); ++level) {
    const Surface coarse(field, level);
    const int side = DetailMeasure::side(level);
    const glm::ivec2 count = measure.patches(level);
    for (int py = 0; py < count.y; ++py)
      for (int px = 0; px < count.x; ++px) {
        const DetailMeasure::Error bound = measure.error(level, px, py);
        double worst = 0.0;
        for (int r = py * side; r < std::min((py + 1) * side, last.y); ++r)
          for (int c = px * side; c < std::min((px + 1) * side, last.x); ++c) {
            if (std::isnan(sample(c, r) + sample(c + 1, r) + sample(c, r + 1) + sample(c + 1, r + 1)))
              continue;
            for (const double fy : {0.0, 0.3, 0.5, 1.0})
              for (const double fx : {0.0, 0.5, 0.7, 1.0}) {
                const double d = std::abs(fine.at(c + fx, r + fy) - coarse.at(c + fx, r + fy));
                // NaN: a vertex without any height bears on it.
                if (std::isnan(d)) worst = HUGE_VAL;
                worst = std::max(worst, d);
              }
          }
        // 1e-12 of the heights: what the twin itself rounds.
        ASSERT_LE(worst, bound.deviation + 1e-12 * scale)
            << "level " << level << " patch " << px << ' ' << py;
        if (std::isfinite(bound.deviation) && level <= DetailMeasure::kTileLevels) {
          ASSERT_LE(bound.deviation, tightness * worst + 1e-3)
              << "level " << level << " patch " << px << ' ' << py;
        }
      }
  }
}

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

TEST(Detail, AfterAnEditTheMeasureEqualsAFreshOneBitForBit) {
  std::mt19937 random(7);
  const engine::Version start = fieldOf(gridOf(700, 300), [](int c, int r) {
    return std::hypot(c - 320, r - 128) < 20 || (c * 31 + r * 17) % 997 == 0 ? kNan : rough(c, r);
  });
  engine::LiveField live(start, engine::Growth::kAllowed);
  DetailMeasure kept;
  kept.measure(start.reader());
  for (int edit = 0; edit < 25; ++edit) {
    const int c = static_cast<int>(random() % 690), r = static_cast<int>(random() % 290);
    const std::vector<float> bump(100, edit % 5 == 0 ? kNan : static_cast<float>(edit));
    ASSERT_TRUE(live.writeHeights(c, r, 10, 10, bump.data(), 10));
    std::vector<glm::ivec2> tiles;
    for (int tr = r / 64; tr <= (r + 9) / 64; ++tr)
      for (int tc = c / 64; tc <= (c + 9) / 64; ++tc) tiles.emplace_back(tc, tr);
    kept.refresh(live.reader(), tiles);
    DetailMeasure fresh;
    fresh.measure(live.reader());
    for (int level = 1; level <= fresh.topLevel(); ++level)
      for (int y = 0; y < fresh.patches(level).y; ++y)
        for (int x = 0; x < fresh.patches(level).x; ++x) {
          ASSERT_EQ(kept.error(level, x, y).deviation, fresh.error(level, x, y).deviation)
              << "edit " << edit << " level " << level << ' ' << x << ' ' << y;
          ASSERT_EQ(kept.error(level, x, y).excess, fresh.error(level, x, y).excess);
        }
  }
}

}  // namespace
}  // namespace fettle::render
