// How smoothing fades towards the brush's rim, and how far apart its touches lie.
#include <cmath>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/tick/brush.h"
#include "haptic/tick/replay.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::randomField;
using tests::uniform;

TEST(Falloff, ShapesFallFromOneToNothingAndNeverRise) {
  for (const FalloffRow& row : kFalloffRows) {
    EXPECT_EQ(row.weight(0.0), 1.0) << row.word;
    double before = 1.0;
    for (int i = 1; i <= 1000; ++i) {
      const double weight = row.weight(i / 1000.0);
      EXPECT_LE(weight, before) << row.word << ' ' << i;
      before = weight;
    }
    EXPECT_EQ(before, row.falloff == Falloff::kFlat ? 1.0 : 0.0) << row.word;
  }
  // By their names: at half the way the ball's cap is above the cubic, that on the cone, the square below it.
  EXPECT_NEAR(rowOf(Falloff::kSphere).weight(0.5), std::sqrt(0.75), 1e-15);
  EXPECT_EQ(rowOf(Falloff::kSmooth).weight(0.5), 0.5);
  EXPECT_EQ(rowOf(Falloff::kLinear).weight(0.25), 0.75);
  EXPECT_EQ(rowOf(Falloff::kSharp).weight(0.5), 0.25);
}

TEST(Falloff, ASampleTakesItsShareOfTheChangeOverHolesBordersAndMarks) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 300; ++i) {
    const engine::Version start = randomField(random, 70, 12, i % 4, 1.0, 1.0, 0.1);
    const auto falloff = static_cast<Falloff>(i % static_cast<int>(Falloff::kCount));
    const double radius = uniform(random, 0.0, 6.0), strength = uniform(random, 0.0, 1.0);
    const int c = static_cast<int>(uniform(random, 0, 69)), r = static_cast<int>(uniform(random, 0, 11));
    engine::LiveField whole(start, engine::Growth::kAllowed), part(start, engine::Growth::kAllowed);
    for (engine::LiveField* field : {&whole, &part}) ASSERT_TRUE(field->setMark(64, 5, true));
    ASSERT_TRUE(Brush(radius, std::nullopt, start).apply(whole, c, r, strength));
    ASSERT_TRUE(Brush(radius, std::nullopt, start, falloff).apply(part, c, r, strength));
    if (falloff == Falloff::kFlat || radius < 1.0) {
      ASSERT_TRUE(whole.snapshot() == part.snapshot() ||
                  engine::contentHash(whole.snapshot()) == engine::contentHash(part.snapshot()));
      continue;
    }
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 70; ++x) {
        const float was = start.reader().heightAt(x, y), all = whole.reader().heightAt(x, y),
                    now = part.reader().heightAt(x, y);
        if (std::isnan(was)) {
          ASSERT_TRUE(std::isnan(now));
          continue;
        }
        if (was == all) {
          ASSERT_EQ(was, now);
          continue;
        }
        const double way = std::hypot(x - c, y - r) / (radius + 1.0);
        const double want = was + rowOf(falloff).weight(way) * (static_cast<double>(all) - was);
        // Two roundings to float, of `all` and of the result.
        ASSERT_NEAR(now, want, (std::abs(want) + std::abs(all)) * 6.0e-8 + 1e-13) << rowOf(falloff).word;
      }
  }
}

TEST(Falloff, TheLargestChangeHoldsAndFlatsStayFlatToTheBit) {
  const engine::Version flat = tests::fieldOf(19, 19, [](int, int) { return 0.1F; });
  std::mt19937_64 random(8);
  const engine::Version rough = randomField(random, 19, 19, 1, 1.0, 1.0, 0.0);
  for (const FalloffRow& row : kFalloffRows) {
    engine::LiveField level(flat, engine::Growth::kAllowed);
    ASSERT_TRUE(Brush(5.0, std::nullopt, flat, row.falloff).apply(level, 9, 9, 0.37));
    EXPECT_TRUE(level.snapshot() == flat) << row.word;
    engine::LiveField field(rough, engine::Growth::kAllowed);
    Brush brush(5.0, 0.001, rough, row.falloff);
    for (int i = 0; i < 50; ++i) ASSERT_TRUE(brush.apply(field, 9, 9, 1.0));
    for (int y = 0; y < 19; ++y)
      for (int x = 0; x < 19; ++x)
        ASSERT_LE(std::abs(double{field.reader().heightAt(x, y)} - double{rough.reader().heightAt(x, y)}),
                  0.001);
  }
}

// A tip that presses on a rough field, and what each tick leaves of it.
struct PressedTip {
  explicit PressedTip(const Scene& settings)
      : scene(settings),
        start([] {
          std::mt19937_64 random(9);
          return randomField(random, 64, 64, 0, 0.5, 0.5, 0.0);
        }()),
        field(start, engine::Growth::kAllowed),
        tick(scene, field, start) {}
  // Whether the tick changed the field.
  bool pressAt(double x) {
    const std::uint64_t before = engine::contentHash(field.snapshot());
    EXPECT_TRUE(tick.run({0.0, {x, 12.0, -30.0}, Tool::kSmooth}).contact);
    return engine::contentHash(field.snapshot()) != before;
  }
  void lift(double x) { EXPECT_FALSE(tick.run({0.0, {x, 12.0, 90.0}, Tool::kSmooth}).contact); }

  Scene scene;
  engine::Version start;
  engine::LiveField field;
  Tick tick;
};

TEST(Spacing, ATipAtRestActsOnceAndAgainWhenItHasMovedOrWasLifted) {
  Scene scene;
  scene.brush_radius_samples = 4.0;
  scene.brush_spacing = 0.5;  // 1 mm
  PressedTip tip(scene);
  EXPECT_TRUE(tip.pressAt(10.0));
  const auto here_mm = [&] { return glm::dvec2(tip.tick.contact().proxy.position_mm); };
  glm::dvec2 acted_mm = here_mm();
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(tip.pressAt(10.0));
  // A slow way: as soon as the proxy is a millimetre away, and not before.
  int acted = 0;
  for (int i = 1; i <= 800; ++i) {
    const bool changed = tip.pressAt(10.0 + 0.01 * i);
    const double moved_mm = glm::length(here_mm() - acted_mm);
    ASSERT_EQ(changed, moved_mm >= 1.0) << i << ' ' << moved_mm;
    if (!changed) continue;
    acted_mm = here_mm();
    ++acted;
  }
  EXPECT_GE(acted, 4);
  const double end_mm = 18.0;
  EXPECT_FALSE(tip.pressAt(end_mm));
  tip.lift(end_mm);
  EXPECT_TRUE(tip.pressAt(end_mm));
  // After an undo it acts at once, too.
  EXPECT_FALSE(tip.pressAt(end_mm));
  tip.tick.fieldChanged();
  EXPECT_TRUE(tip.pressAt(end_mm));
}

TEST(Spacing, WithoutOneEveryTickActs) {
  Scene scene;
  scene.brush_radius_samples = 4.0;
  PressedTip tip(scene);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(tip.pressAt(10.0));
}

TEST(Replay, SameStrokesGiveTheSameBitsWithFalloffAndSpacingAndOtherOnesThanWithout) {
  const engine::Version field = trials::workpiece(200, 0.05);
  trials::HandMotion motion;
  motion.ticks = 8000;
  motion.tool = Tool::kSmooth;
  const std::vector<StrokeSample> strokes = trials::handStroke(field, motion);
  Scene scene;
  scene.brush_radius_samples = 3.0;
  const auto hashOf = [&] {
    engine::JobControl job;
    const auto result = replay(field, field, strokes, scene, {}, job);
    EXPECT_TRUE(result);
    return result ? engine::contentHash(result->field) : 0;
  };
  const std::uint64_t plain = hashOf();
  scene.brush_falloff = Falloff::kSmooth;
  const std::uint64_t fading = hashOf();
  scene.brush_spacing = 0.3;
  const std::uint64_t spaced = hashOf();
  EXPECT_NE(plain, fading);
  EXPECT_NE(fading, spaced);
  EXPECT_EQ(spaced, hashOf());
}

TEST(SceneFile, FalloffAndSpacingAreOnlyWrittenWhereTheyAreUsed) {
  Scene scene;
  EXPECT_EQ(sceneText(scene).find("falloff"), std::string::npos);
  EXPECT_EQ(sceneText(scene).find("spacing"), std::string::npos);
  for (const FalloffRow& row : kFalloffRows) {
    scene.brush_falloff = row.falloff;
    scene.brush_spacing = 0.1 * static_cast<double>(row.falloff);
    const auto back = parseScene(sceneText(scene), "text");
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(*back, scene);
  }
  for (const char* wrong :
       {"brush = { falloff = \"round\" }", "brush = { falloff = 1 }", "brush = { spacing = 2.5 }",
        "brush = { spacing = -1 }", "brush = { spacing = nan }"})
    EXPECT_FALSE(parseScene(wrong, "text")) << wrong;
  for (const double spacing : {-0.1, 2.1, std::nan("")}) {
    scene.brush_spacing = spacing;
    EXPECT_TRUE(sceneProblem(scene)) << spacing;
  }
}

}  // namespace
}  // namespace fettle::haptic
