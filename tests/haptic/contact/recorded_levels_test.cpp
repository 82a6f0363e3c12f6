// What was recorded at a contact level keeps its bits: the scenes' texts as journals hold them, with the contact revision of
// the program that wrote them. Balls of before revision 4: tests/numeric/contact/ball_search_test.cpp.
#include <bit>
#include <string>

#include <gtest/gtest.h>

#include "engine/field/live_field.h"
#include "haptic/scene/scene.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::haptic {
namespace {

struct Recorded {
  int revision;
  const char* scene;
  std::uint64_t felt;   // FNV-1a over the words of forces and proxies
  std::uint64_t field;  // contentHash of the field that the strokes left
};
// Of 20,000 ticks that smooth the workpiece. Revision 1: printed by the program of 2026-11-23, which had one local search, called
// paper. The others: of 2026-11-26, when contact revision 4 was the newest.
constexpr Recorded kRecorded[] = {
    {1, "[contact]\nlevel = \"paper\"\nsearch_rounds = 2", 0x848cb53635338323U, 0x618dfc7ae9986d17U},
    {1, "[contact]\nlevel = \"paper\"\nsearch_rounds = 5", 0x267900d561fd1dc1U, 0x5e67adb9848da388U},
    {1, "", 0x98404b3a80d0d682U, 0x4c1fe90079ae4aeaU},
    {2, "[contact]\nlevel = \"descent\"\nsearch_rounds = 5", 0x267900d561fd1dc1U, 0x5e67adb9848da388U},
    {2, "", 0x8cfb690a04159a1U, 0xb3d652b11aae19dbU},
    {3, "[contact]\nlevel = \"certified\"\ncertified_radius_cells = 4", 0x3e921acb74a6bf5bU,
     0x1c581a9a0300c072U},
    {4, "tip = \"sphere\"\ntip_radius_mm = 0.1", 0xc05489facc0a0f8fU, 0x40b454641f49e7ddU},
};

TEST(RecordedLevels, KeepTheirBitsInEveryContactRevisionSince) {
  const engine::Version field = trials::workpiece(256, 0.05);
  trials::HandMotion motion;
  motion.ticks = 20'000;
  motion.tool = Tool::kSmooth;
  motion.press_mm = 0.3;
  const std::vector<StrokeSample> strokes = trials::handStroke(field, motion);
  for (const Recorded& recorded : kRecorded) {
    // The first revision alone called another search by the name of a level.
    const int last = recorded.revision == 1 ? 1 : kContactRevision;
    for (int revision = recorded.revision; revision <= last; ++revision) {
      const auto scene = parseScene(recorded.scene, "recorded", revision);
      ASSERT_TRUE(scene) << scene.error().line();
      const double raised_mm = scene->tip == TipShape::kSphere ? scene->tip_radius_mm : 0.0;
      engine::LiveField live(field, engine::Growth::kAllowed);
      Tick tick(*scene, live, field);
      std::uint64_t hash = 0xcbf29ce484222325U;
      for (StrokeSample s : strokes) {
        s.tip_mm.z += raised_mm;
        const ForceSample felt = tick.run(s);
        for (const double x :
             {felt.force_n.x, felt.force_n.y, felt.force_n.z, felt.proxy_mm.x, felt.proxy_mm.y})
          hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0x100000001b3U;
      }
      EXPECT_EQ(hash, recorded.felt) << std::hex << hash << " in " << revision << ": " << recorded.scene;
      EXPECT_EQ(engine::contentHash(live.snapshot()), recorded.field)
          << std::hex << engine::contentHash(live.snapshot()) << " in " << revision << ": " << recorded.scene;
    }
  }
}

}  // namespace
}  // namespace fettle::haptic
