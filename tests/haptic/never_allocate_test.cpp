// The tick under an allocator that counts: none with every tool, brush and level once the pool is filled.
#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "engine/field/live_field.h"
#include "haptic/tick.h"
#include "bench/hand_stroke.h"

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

TEST(NeverAllocate, ATickDoesNotWithAnyToolOrLevel) {
  const engine::Version field = bench::workpiece(300, 0.05);
  ASSERT_TRUE(field.memory()->tiles.reserve(200));
  ASSERT_TRUE(field.memory()->nodes.reserve(50));
  bench::HandMotion motion;
  motion.ticks = 60000;
  std::vector<StrokeSample> strokes = bench::handStroke(field, motion);
  for (std::size_t i = 0; i < strokes.size(); ++i) strokes[i].tool = static_cast<Tool>(i / 500 % kTools);
  for (const ContactLevel level : {ContactLevel::kPaper, ContactLevel::kCertified}) {
    Scene scene;
    scene.level = level;
    scene.brush_radius_samples = 2.0;
    scene.mark_radius_samples = 1.0;
    scene.max_change = 0.5;
    engine::LiveField live(field, engine::Growth::kNever);
    Tick tick(scene, live, field);
    const long before = g_allocations.load(std::memory_order_relaxed);
    long contacts = 0;
    for (const StrokeSample& sample : strokes) contacts += tick.run(sample).contact ? 1 : 0;
    EXPECT_EQ(g_allocations.load(std::memory_order_relaxed), before);
    EXPECT_GT(contacts, 30000);
    EXPECT_EQ(tick.counters().refused_edits, 0);
  }
}

}  // namespace
}  // namespace fettle::haptic
