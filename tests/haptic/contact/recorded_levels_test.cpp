// Level descent keeps the bits that it had as level "paper": what was recorded then is replayed through it.
#include "haptic/contact/descent.h"

#include <gtest/gtest.h>

#include <bit>

#include "engine/field/live_field.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::haptic {
namespace {

struct Recorded {
  int rounds;
  std::uint64_t felt;   // FNV-1a over the words of forces and proxies
  std::uint64_t field;  // contentHash of the field that the strokes left
};
// Of 20,000 ticks that smooth the workpiece, printed by the program of 2026-11-23.
constexpr Recorded kRecorded[] = {{2, 0x848cb53635338323U, 0x618dfc7ae9986d17U},
                                  {5, 0x267900d561fd1dc1U, 0x5e67adb9848da388U},
                                  {2048, 0x98404b3a80d0d682U, 0x4c1fe90079ae4aeaU}};

TEST(Descent, KeepsTheBitsOfTheFirstContactRevision) {
  const engine::Version field = trials::workpiece(256, 0.05);
  trials::HandMotion motion;
  motion.ticks = 20'000;
  motion.tool = Tool::kSmooth;
  motion.press_mm = 0.3;
  const std::vector<StrokeSample> strokes = trials::handStroke(field, motion);
  for (const Recorded& recorded : kRecorded) {
    Scene scene = defaultScene();
    scene.level = ContactLevel::kDescent;
    scene.search_rounds = recorded.rounds;
    engine::LiveField live(field, engine::Growth::kAllowed);
    Tick tick(scene, live, field);
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const StrokeSample& s : strokes) {
      const ForceSample felt = tick.run(s);
      for (const double x :
           {felt.force_n.x, felt.force_n.y, felt.force_n.z, felt.proxy_mm.x, felt.proxy_mm.y})
        hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0x100000001b3U;
    }
    EXPECT_EQ(hash, recorded.felt) << recorded.rounds << " rounds";
    EXPECT_EQ(engine::contentHash(live.snapshot()), recorded.field) << recorded.rounds << " rounds";
  }
}

}  // namespace
}  // namespace fettle::haptic
