// The yardstick of a tick does the work it stands for: on a surface with one way down it ends where the tick
// does.
#include "bench/plain_search.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "engine/field/live_field.h"
#include "haptic/scene/scene.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::bench {
namespace {

TEST(PlainSearch, PushesAsTheTickDoesOnASmoothPart) {
  const engine::Version field = trials::workpiece(200, 0.05, 0.0);
  trials::HandMotion motion;
  motion.ticks = 20'000;
  motion.press_mm = 0.1;
  const haptic::Scene scene = haptic::defaultScene();
  engine::LiveField live(field, engine::Growth::kAllowed);
  haptic::Tick tick(scene, live, field);
  PlainSearch plain(field);
  int contacts = 0;
  int same = 0;
  for (const haptic::StrokeSample& sample : trials::handStroke(field, motion)) {
    const haptic::ForceSample ours = tick.run(sample);
    const glm::dvec3 theirs = plain.tick(sample.tip_mm, scene.stiffness_n_per_mm);
    if (!ours.contact) continue;
    ++contacts;
    same += glm::length(ours.force_n - theirs) <= 1e-6 ? 1 : 0;
  }
  EXPECT_GT(contacts, 10'000);
  // Ridges have two sides: where a hand comes down next to one the two may differ until it leaves.
  EXPECT_GT(same, 0.97 * contacts) << contacts;
  RecordProperty("same", same);
}

}  // namespace
}  // namespace fettle::bench
