// The tick under an allocator that counts: none with every tool, brush and level once the pool is filled.
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/live_field.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"

namespace {
// Relaxed: one thread counts and reads.
std::atomic<long> g_allocations{0};
void* counted(std::size_t size) {
  g_allocations.fetch_add(1, std::memory_order_relaxed);
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
}  // namespace

void* operator new(std::size_t size) {
  return counted(size);
}
void* operator new[](std::size_t size) {
  return counted(size);
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete[](void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  std::free(p);
}

namespace fettle::haptic {
namespace {

// Each effect alone on the spring, then all of them: times both levels, more than a million ticks.
TEST(NeverAllocate, ATickDoesNotWithAnyToolLevelOrEffect) {
  const engine::Version field = trials::workpiece(300, 0.05);
  ASSERT_TRUE(field.memory()->tiles.reserve(200));
  ASSERT_TRUE(field.memory()->nodes.reserve(50));
  // Edge lines across the field, for the brush.
  std::vector<engine::EdgeLine> lines(30);
  for (std::size_t k = 0; k < lines.size(); ++k)
    for (int i = 0; i < 300; ++i) {
      engine::EdgePoint point;
      point.position = {10.0 * static_cast<double>(k) + 0.3 * i, 1.0 * i};
      point.located = true;
      lines[k].points.push_back(point);
    }
  const engine::Version lined =
      field.withLines(std::make_shared<const std::vector<engine::EdgeLine>>(std::move(lines)));
  trials::HandMotion motion;
  motion.ticks = 60000;
  std::vector<StrokeSample> strokes = trials::handStroke(field, motion);
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    strokes[i].tool = static_cast<Tool>(i / 500 % kTools);
    if (i % 7001 == 0) strokes[i].tip_mm.x = std::nan("");
    if (i % 7001 == 3000) strokes[i].tip_mm.z = -1e6;
  }
  long ticks = 0;
  for (const ContactLevel level : {ContactLevel::kPaper, ContactLevel::kDescent, ContactLevel::kCertified})
    for (int listed = 1; listed <= kEffectKinds; ++listed) {
      Scene scene;
      scene.level = level;
      scene.brush_radius_samples = 2.0;
      scene.mark_radius_samples = 1.0;
      scene.max_change = 0.5;
      scene.brush_falloff = static_cast<Falloff>(listed % static_cast<int>(Falloff::kCount));
      scene.brush_spacing = listed % 3 == 0 ? 0.25 : 0.0;
      scene.params.viscosity.medium = ViscousMedium::kEverywhere;
      for (int k = 0; k < kEffectKinds; ++k) {
        const auto kind = static_cast<EffectKind>(k);
        const bool there = k == listed || listed == kEffectKinds;
        if (there && kind != EffectKind::kSpring && kind != EffectKind::kSmoothing)
          scene.effects.push_back(kind);
      }
      ASSERT_FALSE(sceneProblem(scene));
      engine::LiveField live(listed % 2 == 0 ? field : lined, engine::Growth::kNever);
      Tick tick(scene, live, field);
      const long before = g_allocations.load(std::memory_order_relaxed);
      long contacts = 0;
      for (std::size_t i = 0; i < strokes.size(); ++i) {
        if (i % 9000 == 8999) tick.fieldChanged();
        contacts += tick.run(strokes[i]).contact ? 1 : 0;
      }
      EXPECT_EQ(g_allocations.load(std::memory_order_relaxed), before) << listed;
      EXPECT_GT(contacts, 30000);
      EXPECT_EQ(tick.counters().refused_edits, 0);
      ticks += static_cast<long>(strokes.size());
    }
  EXPECT_GE(ticks, 1000000);
}

}  // namespace
}  // namespace fettle::haptic
