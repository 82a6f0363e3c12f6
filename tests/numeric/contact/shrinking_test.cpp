// Properties of any small field and any hand. What breaks one is shrunk and written as a scene that
// `fettle replay` plays (tests/end_to_end/numeric_case_test.cpp plays one with the built program).
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "engine/formats/formats.h"
#include "haptic/tick/replay.h"
#include "haptic/tick/tick.h"
#include "tests/numeric/support/touch_case.h"
#include "tests/support/temp_folder.h"

namespace fettle::haptic {
namespace {

using tests::Choice;
using tests::TouchCase;
using tests::ulps;

// Where a broken case is kept: the test's working folder, which outlives it.
std::string keptFolder(const std::string& name) {
  return (std::filesystem::current_path() / ("broken_" + name)).string();
}

class AnySmallField : public ::testing::TestWithParam<Choice> {};

TEST_P(AnySmallField, BelowTheSurfaceThereIsContactAndTheProxyIsOnIt) {
  const auto broken = tests::findBroken(
      "below the surface there is contact", GetParam(),
      [](const TouchCase& touch) -> std::optional<std::string> {
        const engine::Version field = touch.field();
        engine::LiveField live(field, engine::Growth::kAllowed);
        Tick tick(touch.scene(), live, field);
        for (const StrokeSample& row : touch.strokes()) {
          const ForceSample felt = tick.run(row);
          const glm::dvec3& e = row.tip_mm;
          // Endpoints and heights are small binary fractions: the depth is exact but for the last product.
          const auto depth = static_cast<double>(tests::heightAt(field, e.x, e.y) - e.z);
          if (depth > 1e-12 && !felt.contact) return fmt::format("no contact {} mm below the surface", depth);
          if (!felt.contact) continue;
          if (!(glm::length(felt.force_n - tick.contact().penetration_mm) == 0.0))
            return "the force is not the way";
          if (touch.choice == Choice::kSphere) continue;
          // 8 roundings of coordinates up to 6 mm, times slopes up to 4 and 1.
          double error = HUGE_VAL;
          for (const double dx : {0.0, -1e-14, 1e-14})
            for (const double dy : {0.0, -1e-14, 1e-14}) {
              const auto off = static_cast<double>(std::abs(
                  tests::heightAt(field, felt.proxy_mm.x + dx, felt.proxy_mm.y + dy) - felt.proxy_mm.z));
              if (off < error) error = off;
            }
          if (!(error < 1e-13)) return fmt::format("the proxy is {} mm off the surface", error);
        }
        return std::nullopt;
      },
      keptFolder("contact_" + tests::choiceName(GetParam())));
  EXPECT_FALSE(broken) << broken->command;
}

// See energy_test.cpp: no farther than the proxy before, whatever the surface and the move. At levels paper and
// descent a tip that tracking loses may be handed to a farther point, so there the slope has to be below 1: not asked.
TEST_P(AnySmallField, TheProxyIsNeverFartherThanTheOneBefore) {
  if (tests::searchesLocally(GetParam())) GTEST_SKIP() << "holds on gentle slopes only: Numeric/EveryField";
  const auto broken = tests::findBroken(
      "the proxy is never farther than the one before", GetParam(),
      [](const TouchCase& touch) -> std::optional<std::string> {
        const engine::Version field = touch.field();
        engine::LiveField live(field, engine::Growth::kAllowed);
        Tick tick(touch.scene(), live, field);
        std::optional<glm::dvec3> proxy;
        for (const StrokeSample& row : touch.strokes()) {
          const bool contact = tick.run(row).contact;
          const glm::dvec3 way = tick.contact().penetration_mm;
          // A ball is let to within 1e-6 of a cell, and 4 times that where three faces hold it.
          const double tolerance = touch.choice == Choice::kSphere ? 4e-6 : 1e-11;
          if (contact && proxy && glm::length(way) > glm::length(*proxy - row.tip_mm) + tolerance)
            return fmt::format("{} mm away, but the proxy before was {}", glm::length(way),
                               glm::length(*proxy - row.tip_mm));
          proxy = contact ? std::optional(row.tip_mm + way) : std::nullopt;
        }
        return std::nullopt;
      },
      keptFolder("farther_" + tests::choiceName(GetParam())));
  EXPECT_FALSE(broken) << broken->command;
}

INSTANTIATE_TEST_SUITE_P(Numeric, AnySmallField, ::testing::ValuesIn(tests::kChoices),
                         [](const auto& one) { return tests::choiceName(one.param); });

// A property that is wrong on purpose: the smallest case is one tick on one raised sample, and what is
// written plays to the same forces.
TEST(Shrinking, AWrongPropertyComesDownToATickOrTwoThatReplay) {
  const tests::TempFolder folder;
  const auto broken = tests::findBroken(
      "no proxy is higher than 0.5 mm", Choice::kPaper,
      [](const TouchCase& touch) -> std::optional<std::string> {
        const engine::Version field = touch.field();
        engine::LiveField live(field, engine::Growth::kAllowed);
        Tick tick(touch.scene(), live, field);
        for (const StrokeSample& row : touch.strokes())
          if (const ForceSample felt = tick.run(row); felt.contact && felt.proxy_mm.z > 0.5)
            return fmt::format("a proxy {} mm high", felt.proxy_mm.z);
        return std::nullopt;
      },
      folder.file("case"));
  ASSERT_TRUE(broken);
  // Which way shrinking goes depends on the case it starts from: mostly one tick on 2 x 2 samples.
  EXPECT_LE(broken->touch.moves.size(), 3U);
  EXPECT_LE(broken->touch.heights.size(), 18U);
  EXPECT_EQ(broken->command.rfind("fettle replay ", 0), 0U);

  engine::JobControl job;
  const auto scan = engine::importField(folder.file("case/scan.tif"), {}, job);
  ASSERT_TRUE(scan) << scan.error().line();
  const auto strokes = readStrokes(folder.file("case/strokes.csv"));
  ASSERT_TRUE(strokes);
  const auto scene = loadScene(folder.file("case/scene.toml"));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(*scene, broken->touch.scene());
  const ReplayOptions options{.record_forces = RecordForces::kYes};
  const auto played = replay(scan->field, scan->field, *strokes, *scene, options, job);
  ASSERT_TRUE(played) << played.error().line();
  const engine::Version field = broken->touch.field();
  const auto meant = replay(field, field, broken->touch.strokes(), broken->touch.scene(), options, job);
  ASSERT_TRUE(meant);
  EXPECT_EQ(played->forces, meant->forces);
  ASSERT_EQ(played->forces.size(), broken->touch.moves.size());
  EXPECT_GT(played->forces.back().proxy_mm.z, 0.5);
}

}  // namespace
}  // namespace fettle::haptic
