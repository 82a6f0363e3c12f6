#include "haptic/tick/brush.h"

#include <gtest/gtest.h>

#include "haptic/effects/effect.h"
#include "haptic/tick/replay.h"
#include "haptic/trials/hand_stroke.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::fieldOf;
using tests::kHole;
using tests::randomField;
using tests::uniform;

// The smoothing of one sample, in long double, straight from its definition.
long double smoothed(const engine::FieldReader& f, int c, int r, double strength) {
  long double gauss = 0, gauss_weight = 0, box = 0, box_weight = 0;
  for (int dr = -1; dr <= 1; ++dr)
    for (int dc = -1; dc <= 1; ++dc) {
      if (!f.grid().contains(c + dc, r + dr) || std::isnan(f.heightAt(c + dc, r + dr))) continue;
      const long double w = (2 - std::abs(dc)) * (2 - std::abs(dr));
      gauss += w * f.heightAt(c + dc, r + dr);
      gauss_weight += w;
      box += f.heightAt(c + dc, r + dr);
      box_weight += 1;
    }
  return (1 - strength) * gauss / gauss_weight + strength * box / box_weight;
}

TEST(Brush, EqualsItsDefinitionOverHolesBordersMarksAndRadii) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 300; ++i) {
    const engine::Version start = randomField(random, 70, 12, i % 4, 1.0, 1.0, 0.1);
    engine::LiveField field(start, engine::Growth::kAllowed);
    ASSERT_TRUE(field.setMark(64, 5, true));
    const double radius = (i % 5) * 0.7;
    const double strength = uniform(random, 0.0, 1.0);
    const int c = i % 3 == 0 ? 63 : static_cast<int>(uniform(random, 0, 69));
    const int r = static_cast<int>(uniform(random, 0, 11));
    Brush brush(radius, std::nullopt, start);
    ASSERT_TRUE(brush.apply(field, c, r, strength));
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 70; ++x) {
        const float was = start.reader().heightAt(x, y);
        const float now = field.reader().heightAt(x, y);
        const bool inside = (x - c) * (x - c) + (y - r) * (y - r) <= radius * radius;
        if (std::isnan(was)) {
          ASSERT_TRUE(std::isnan(now));
        } else if (!inside || (x == 64 && y == 5)) {
          ASSERT_EQ(was, now);
        } else {
          // Double sums of nine floats up to 20, then one rounding to float: half an ulp, and a hair.
          const auto want = static_cast<double>(smoothed(start.reader(), x, y, strength));
          ASSERT_NEAR(now, want, std::abs(want) * 6.0e-8 + 1e-13);
        }
      }
  }
}

// A straight edge line through (x, y), `angle` from the columns, beyond the field at both ends.
engine::EdgeLines straightLine(double x, double y, double angle) {
  engine::EdgeLine line;
  for (int i = -100; i <= 100; ++i) {
    engine::EdgePoint point;
    point.position = {x + i * std::cos(angle), y + i * std::sin(angle)};
    point.located = true;
    line.points.push_back(point);
  }
  return std::make_shared<const std::vector<engine::EdgeLine>>(1, line);
}

TEST(Brush, NeverReachesOverAnEdgeLine) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 200; ++i) {
    const double x = uniform(random, 20, 50), y = uniform(random, 15, 35);
    const double angle = uniform(random, 0, 3.1416);
    const engine::Version plain = fieldOf(
        70, 50,
        [&](int c, int r) {
          if (random() % 40 == 0) return static_cast<double>(kHole);
          return (c - x) * std::sin(angle) - (r - y) * std::cos(angle) > 0.0 ? 1.5 : -0.25;
        },
        1.0, 1.0);
    const engine::Version lined = plain.withLines(straightLine(x, y, angle));
    const engine::Version start = i % 2 == 0 ? lined : lined.inverted();
    Brush brush((i % 3) * 2.0, std::nullopt, start);
    engine::LiveField field(start, engine::Growth::kAllowed);
    for (int k = 0; k < 40; ++k) {
      const double along = uniform(random, -12, 12), off = uniform(random, -3, 3);
      ASSERT_TRUE(brush.apply(field, static_cast<int>(x + along * std::cos(angle) - off * std::sin(angle)),
                              static_cast<int>(y + along * std::sin(angle) + off * std::cos(angle)), 0.5));
    }
    // Both sides are flat and remain so, to the last bit.
    for (int r = 0; r < 50; ++r)
      for (int c = 0; c < 70; ++c) {
        const float was = start.reader().heightAt(c, r), now = field.reader().heightAt(c, r);
        ASSERT_TRUE(was == now || (std::isnan(was) && std::isnan(now))) << i << ": " << c << ", " << r;
      }
    // Without the line both are blended.
    if (i % 2 != 0) continue;
    engine::LiveField over(plain, engine::Growth::kAllowed);
    ASSERT_TRUE(brush.apply(over, static_cast<int>(x), static_cast<int>(y), 0.5));
    ASSERT_TRUE(brush.apply(over, static_cast<int>(x) + 1, static_cast<int>(y) + 1, 0.5));
    if (i % 3 != 0) {
      EXPECT_FALSE(over.snapshot() == plain);
    }
  }
}

TEST(Brush, AsksNothingOfLinesThatAreElsewhere) {
  std::mt19937_64 random(5);
  const engine::Version plain = randomField(random, 70, 50, 2, 1.0, 1.0, 0.1);
  for (const double radius : {0.0, 3.0}) {
    engine::LiveField without(plain, engine::Growth::kAllowed);
    engine::LiveField with(plain.withLines(straightLine(60.0, 0.0, 1.5708)), engine::Growth::kAllowed);
    Brush brush(radius, std::nullopt, plain);
    for (int c = 5; c < 50; c += 3) {
      ASSERT_TRUE(brush.apply(without, c, 20, 0.7));
      ASSERT_TRUE(brush.apply(with, c, 20, 0.7));
    }
    EXPECT_EQ(engine::contentHash(without.snapshot()), engine::contentHash(with.snapshot()));
  }
}

TEST(Brush, StaysWithinTheLargestChangeAsExactNumbers) {
  std::mt19937_64 random(2);
  const engine::Version start = randomField(random, 20, 20, 2, 1.0, 1.0);
  engine::LiveField field(start, engine::Growth::kAllowed);
  const double limit = 0.1;
  Brush brush(3.0, limit, start);
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(brush.apply(field, 10, 10, 1.0));
  int at_limit = 0;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) {
      const double change = std::abs(static_cast<double>(field.reader().heightAt(x, y)) -
                                     static_cast<double>(start.reader().heightAt(x, y)));
      ASSERT_LE(change, limit);
      at_limit += change > 0.0999 ? 1 : 0;
    }
  EXPECT_GT(at_limit, 10);
}

TEST(Brush, FlatsStayFlatToTheBit) {
  const engine::Version start = fieldOf(9, 9, [](int, int) { return 0.1F; });
  engine::LiveField field(start, engine::Growth::kAllowed);
  Brush brush(2.0, std::nullopt, start);
  ASSERT_TRUE(brush.apply(field, 4, 4, 0.37));
  EXPECT_TRUE(field.snapshot() == start);
}

ReplayResult mustReplay(const engine::Version& start, const std::vector<StrokeSample>& strokes,
                        const Scene& scene, MeasureContact measure = MeasureContact::kNo) {
  engine::JobControl job;
  engine::Result<ReplayResult> result =
      replay(start, start, strokes, scene, {RecordForces::kYes, measure}, job);
  EXPECT_TRUE(result.has_value());
  return std::move(*result);
}

std::vector<StrokeSample> shortStroke(const engine::Version& field, Tool tool) {
  trials::HandMotion motion;
  motion.ticks = 20000;
  motion.tool = tool;
  return trials::handStroke(field, motion);
}

TEST(Replay, SameStrokesGiveTheSameBits) {
  const engine::Version field = trials::workpiece(300, 0.05);
  const std::vector<StrokeSample> strokes = shortStroke(field, Tool::kSmooth);
  const ReplayResult a = mustReplay(field, strokes, defaultScene());
  const ReplayResult b = mustReplay(field, strokes, defaultScene());
  EXPECT_EQ(engine::contentHash(a.field), engine::contentHash(b.field));
  EXPECT_EQ(a.forces, b.forces);
  EXPECT_GT(a.report.samples_changed, 1000);
  EXPECT_GT(a.report.contact_ticks, 10000);
  EXPECT_LT(a.report.contact_ticks, a.report.ticks);
  EXPECT_EQ(a.report.counters.below_without_contact, 0);
}

TEST(Replay, InvertedSceneEqualsAPhysicallyNegatedFieldBitForBit) {
  const engine::Version field = trials::workpiece(200, 0.05);
  std::vector<float> z(200 * 200);
  field.reader().readHeights(0, 0, 200, 200, z.data(), 200);
  for (float& h : z) h = -h;
  const engine::Version negated = engine::makeField(field.grid(), z);
  std::vector<StrokeSample> strokes = shortStroke(negated, Tool::kSmooth);
  for (std::size_t i = 0; i < 500; ++i) strokes[i + 9000].tool = Tool::kMark;
  Scene scene;
  scene.max_change = 0.01;
  scene.brush_radius_samples = 1.5;
  const ReplayResult plain = mustReplay(negated, strokes, scene);
  scene.invert = true;
  const ReplayResult inverted = mustReplay(field, strokes, scene);
  EXPECT_EQ(plain.forces, inverted.forces);
  EXPECT_EQ(engine::contentHash(plain.field.inverted()), engine::contentHash(inverted.field));
  EXPECT_GT(inverted.report.marked, 0);
}

TEST(Replay, MarksWhereTheTipIsAndUnmarksThemAgain) {
  const engine::Version field = fieldOf(20, 20, [](int c, int) { return c == 7 ? kHole : 0.0F; });
  Scene scene;
  scene.mark_radius_samples = 1.0;
  const ReplayResult marked = mustReplay(field, {{0.0, {12.5, 3.5, -0.5}, Tool::kMark}}, scene);
  EXPECT_EQ(marked.report.marked, 5);
  for (const auto& [c, r] : {std::pair{12, 3}, {11, 3}, {13, 3}, {12, 2}, {12, 4}})
    EXPECT_TRUE(marked.field.reader().markedAt(c, r));
  EXPECT_EQ(mustReplay(field, {{0.0, {8.5, 3.5, -0.5}, Tool::kMark}}, scene).report.marked,
            4);  // not the hole
  EXPECT_EQ(mustReplay(field, {{0.0, {12.5, 3.5, 0.5}, Tool::kMark}}, scene).report.marked,
            0);  // not touching
  EXPECT_EQ(mustReplay(marked.field, {{0.0, {12.5, 3.5, -0.5}, Tool::kUnmark}}, scene).report.marked, 0);
}

TEST(Replay, CountsWherePaperStopsAboveCertifiedAndNeverAtCertified) {
  const engine::Version field = trials::workpiece(200, 0.05);
  const std::vector<StrokeSample> strokes = shortStroke(field, Tool::kFeel);
  Scene scene;
  scene.certified_radius_cells = 4;
  const ReplayReport paper = mustReplay(field, strokes, scene, MeasureContact::kYes).report;
  EXPECT_GT(paper.above_certified, 0);
  EXPECT_LT(paper.above_certified, paper.contact_ticks);
  EXPECT_GT(paper.worst_excess_mm, 0.0);
  scene.level = ContactLevel::kCertified;
  EXPECT_EQ(mustReplay(field, strokes, scene, MeasureContact::kYes).report.above_certified, 0);
}

TEST(Replay, WhatASceneDoesNotListDoesNothing) {
  const engine::Version field = trials::workpiece(100, 0.05);
  Scene scene;
  scene.effects = {};
  const ReplayResult result = mustReplay(field, shortStroke(field, Tool::kSmooth), scene);
  EXPECT_TRUE(result.field == field);
  EXPECT_EQ(result.report.max_force_n, 0.0);
  EXPECT_GT(result.report.contact_ticks, 0);
  EXPECT_TRUE(composeEffects(scene, field, field).in_contact.empty());
}

TEST(Replay, RefusesAScenesOutOfRangeAndAnotherFieldsOriginal) {
  engine::JobControl job;
  const engine::Version field = fieldOf(5, 5, [](int, int) { return 0.0; });
  const engine::Version other = fieldOf(6, 5, [](int, int) { return 0.0; });
  Scene scene;
  EXPECT_FALSE(replay(field, other, {}, scene, {}, job));
  scene.stiffness_n_per_mm = NAN;
  EXPECT_FALSE(replay(field, field, {}, scene, {}, job));
  job.cancel();
  const std::vector<StrokeSample> strokes(1);
  EXPECT_EQ(replay(field, field, strokes, {}, {}, job).error().kind, engine::ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::haptic
