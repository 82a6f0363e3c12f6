// What a scene lists is there, what it does not list is not.
#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/tick/replay.h"
#include "haptic/trials/hand_stroke.h"
#include "tests/haptic/effects/touch.h"

namespace fettle::haptic {
namespace {

using tests::fieldOf;
using tests::sceneOf;
using tests::Touch;

std::vector<EffectKind> every() {
  std::vector<EffectKind> kinds;
  for (int k = 0; k < kEffectKinds; ++k) kinds.push_back(static_cast<EffectKind>(k));
  return kinds;
}

TEST(Compose, WhatASceneDoesNotListDoesNotExist) {
  const engine::Version field = fieldOf(300, 300, [](int, int) { return 0.0; });
  for (int leave_out = 0; leave_out < kEffectKinds; ++leave_out) {
    std::vector<EffectKind> kinds = every();
    kinds.erase(kinds.begin() + leave_out);
    const EffectList list = composeEffects(sceneOf(kinds), field, field);
    EXPECT_EQ(list.data.size(), kinds.size());
    for (int k = 0; k < kEffectKinds; ++k)
      EXPECT_EQ(list.bytesOf(static_cast<EffectKind>(k)) == 0, k == leave_out) << k;
  }
  const EffectList none = composeEffects(sceneOf({}), field, field);
  EXPECT_TRUE(none.in_contact.empty() && none.always.empty() && none.finishing.empty() &&
              none.upkeep.empty());
  EXPECT_TRUE(none.resets.empty() && none.data.empty());
  EXPECT_FALSE(none.motion);
  EXPECT_EQ(none.bytes(), 0U);
  EXPECT_TRUE(none.onlyInContact());
}

TEST(Compose, VelocityIsEstimatedOnlyForThoseThatNeedIt) {
  const engine::Version field = fieldOf(9, 9, [](int, int) { return 0.0; });
  for (const EffectKind kind : every()) {
    const bool needs =
        kind == EffectKind::kViscosity || kind == EffectKind::kCoupling || kind == EffectKind::kPassivity;
    EXPECT_EQ(composeEffects(sceneOf({EffectKind::kSpring, kind}), field, field).motion.has_value(), needs)
        << effectName(kind);
  }
}

TEST(Compose, TheBigTablesAreThoseOfTextureAndEdgeSnap) {
  const engine::Version field = fieldOf(300, 300, [](int, int) { return 0.0; });
  const EffectList list = composeEffects(sceneOf(every()), field, field);
  EXPECT_GE(list.bytesOf(EffectKind::kTexture), 256U * 256U * 4U);
  EXPECT_GE(list.bytesOf(EffectKind::kEdgeSnap), 128U * 4096U * 4U);
  for (const EffectKind kind : every()) {
    if (kind != EffectKind::kTexture && kind != EffectKind::kEdgeSnap) {
      EXPECT_LT(list.bytesOf(kind), 1024U) << effectName(kind);
    }
  }
}

TEST(Compose, StrengthOfTheBrushIsThePressAloneWhateverElseIsFelt) {
  // Pressed the same way, with and without effects that do not press: the same bits of the field.
  const engine::Version field = trials::workpiece(200, 0.05);
  trials::HandMotion motion;
  motion.ticks = 5000;
  motion.tool = Tool::kSmooth;
  const std::vector<StrokeSample> strokes = trials::handStroke(field, motion);
  const auto hashOf = [&](std::vector<EffectKind> effects) {
    engine::JobControl job;
    const auto result = replay(field, field, strokes, sceneOf(std::move(effects)), {}, job);
    EXPECT_TRUE(result);
    return engine::contentHash(result->field);
  };
  const std::uint64_t plain = hashOf({EffectKind::kSpring, EffectKind::kSmoothing});
  EXPECT_EQ(hashOf({EffectKind::kSpring, EffectKind::kSmoothing, EffectKind::kFriction,
                    EffectKind::kViscosity, EffectKind::kEdgeSnap, EffectKind::kGravity,
                    EffectKind::kCoupling, EffectKind::kPassivity, EffectKind::kSound}),
            plain);
  EXPECT_NE(hashOf({EffectKind::kSpring, EffectKind::kSmoothing, EffectKind::kTexture}), plain);
}

TEST(Compose, ReplayOfEverythingGivesTheSameBitsTwiceAndForcesWithinTheLimit) {
  const engine::Version field = trials::workpiece(200, 0.05);
  trials::HandMotion motion;
  motion.ticks = 20000;
  std::vector<StrokeSample> strokes = trials::handStroke(field, motion);
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    strokes[i].tool = static_cast<Tool>(i / 700 % kTools);
    if (i % 3001 == 5) strokes[i].tip_mm.y = std::nan("");
    if (i % 3001 == 900) strokes[i].tip_mm.z = 1e6;
    if (i % 3001 == 1500) strokes[i].t = HUGE_VAL;
  }
  Scene scene = sceneOf(every());
  scene.params.viscosity.medium = ViscousMedium::kEverywhere;
  scene.params.gravity.stylus_kg = 0.2;
  engine::JobControl job;
  const auto a = replay(field, field, strokes, scene, {RecordForces::kYes, MeasureContact::kNo}, job);
  const auto b = replay(field, field, strokes, scene, {RecordForces::kYes, MeasureContact::kNo}, job);
  ASSERT_TRUE(a && b);
  // Their positions are NaN where the input's are.
  for (std::size_t i = 0; i < strokes.size(); ++i) ASSERT_EQ(a->forces[i].force_n, b->forces[i].force_n) << i;
  EXPECT_EQ(engine::contentHash(a->field), engine::contentHash(b->field));
  for (const ForceSample& f : a->forces) ASSERT_LE(glm::length(f.force_n), 8.0 * (1 + 1e-12));
  EXPECT_GT(a->report.marked, 0);
}

TEST(Compose, AnOriginFarAwayAndOtherUnitsChangeNoForce) {
  engine::Grid grid;
  grid.width = grid.height = 40;
  grid.spacing_x = grid.spacing_y = 0.1;
  std::vector<float> z(1600);
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = static_cast<float>(0.25 * static_cast<double>(i % 7));
  const engine::Version here = engine::makeField(grid, z);
  grid.origin_x = 5e6;
  grid.origin_y = -5e6;
  const engine::Version there = engine::makeField(grid, z);
  Scene scene = sceneOf(every());
  Touch one(here, scene), two(there, scene);
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 e{2.0 + 1.7 * std::sin(0.01 * i), 2.0 + 1.7 * std::cos(0.013 * i),
                       0.5 * std::sin(0.05 * i)};
    const auto tool = static_cast<Tool>(i / 100 % kTools);
    ASSERT_EQ(one.at(e, tool), two.at(e, tool));
  }
}

}  // namespace
}  // namespace fettle::haptic
