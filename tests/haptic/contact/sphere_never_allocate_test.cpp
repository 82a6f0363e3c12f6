// The ball's tick under an allocator that fails.
#include <gtest/gtest.h>

#include "engine/field/live_field.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"
#include "tests/haptic/loop/allocation_guard.h"

namespace fettle::haptic {
namespace {

TEST(SphereNeverAllocates, ATickWithAnyToolAndTwoRunsAreTheSameBits) {
  if (!tests::allocationGuardWorks()) GTEST_SKIP() << "the sanitizer brings its own allocator";
  const engine::Version field = trials::workpiece(300, 0.05);
  ASSERT_TRUE(field.memory()->tiles.reserve(200));
  ASSERT_TRUE(field.memory()->nodes.reserve(50));
  trials::HandMotion motion;
  motion.ticks = 5000;
  std::vector<StrokeSample> strokes = trials::handStroke(field, motion);
  for (std::size_t i = 0; i < strokes.size(); ++i) strokes[i].tool = static_cast<Tool>(i / 500 % kTools);
  Scene scene;
  scene.tip = TipShape::kSphere;
  scene.tip_radius_mm = 0.1;
  std::vector<glm::dvec3> first;
  for (int round = 0; round < 2; ++round) {
    engine::LiveField live(field, engine::Growth::kNever);
    Tick tick(scene, live, field);
    std::vector<glm::dvec3> forces(strokes.size());
    long contacts = 0;
    const std::uint64_t before = tests::AllocationGuard::calls();
    {
      const tests::AllocationGuard guard;
      for (std::size_t i = 0; i < strokes.size(); ++i) {
        const ForceSample force = tick.run(strokes[i]);
        forces[i] = force.force_n;
        contacts += force.contact ? 1 : 0;
      }
    }
    EXPECT_EQ(tests::AllocationGuard::calls(), before);
    EXPECT_GT(contacts, 2500);
    EXPECT_LE(tick.counters().longest_search, kSphereSteps);
    EXPECT_EQ(tick.counters().refused_edits, 0);
    if (round == 0)
      first = forces;
    else
      EXPECT_EQ(forces, first);
  }
}

}  // namespace
}  // namespace fettle::haptic
