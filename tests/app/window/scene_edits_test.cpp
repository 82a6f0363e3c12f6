#include "app/window/scene_edits.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/app/work/loop_client_bench.h"
#include "tests/haptic/support/fields.h"

namespace fettle::app {
namespace {

using haptic::EffectKind;
using haptic::sceneNumber;
using tests::LoopClientBench;

// The mouse is the stylus: nothing is refused for a device's sake, and what no known device holds is said.
class SceneEdits : public ::testing::Test {
 protected:
  [[nodiscard]] LoopClient& client() { return bench.client(); }
  [[nodiscard]] std::vector<Notice>& notices() { return bench.noticesToFill(); }

  LoopClientBench bench{tests::fieldOf(
      64, 64, [](int c, int) { return 0.01 * c; }, 0.1, 0.1)};
};

TEST_F(SceneEdits, a_number_out_of_its_range_becomes_the_nearest_in_it_and_that_is_said) {
  constexpr const haptic::SceneNumber& number = sceneNumber("friction", "static");
  EXPECT_EQ(numberProblem(client(), number, 0.5), "");
  EXPECT_EQ(numberProblem(client(), number, 3.0), "must be 0 to 2: 2 is taken");
  EXPECT_EQ(number.of(client().scene()), 0.4) << "typing changes nothing";
  setNumber(client(), number, 0.5, notices());
  EXPECT_EQ(number.of(client().scene()), 0.5);
  EXPECT_TRUE(notices().empty());
  setNumber(client(), number, 3.0, notices());
  EXPECT_EQ(number.of(client().scene()), 2.0);
  ASSERT_EQ(notices().size(), 1U);
  EXPECT_EQ(notices()[0].what, "static: 2 is taken, it must be 0 to 2");
  EXPECT_TRUE(notices()[0].passes);
}

TEST_F(SceneEdits, where_there_is_no_nearest_the_number_before_stays) {
  constexpr const haptic::SceneNumber& number = sceneNumber("edge_snap", "reach_mm");
  EXPECT_EQ(numberProblem(client(), number, 0.0), "must be above 0, at most 1000000000 mm");
  setNumber(client(), number, 0.0, notices());
  EXPECT_EQ(number.of(client().scene()), 1.0);
  ASSERT_EQ(notices().size(), 1U);
  EXPECT_EQ(notices()[0].remedy, "1 mm stays");
}

TEST_F(SceneEdits, numbers_at_odds_with_each_other_are_said_and_refused) {
  constexpr const haptic::SceneNumber& number = sceneNumber("friction", "dynamic");
  const std::string problem = numberProblem(client(), number, 0.9);
  EXPECT_NE(problem.find("must not be above the static one"), std::string::npos) << problem;
  setNumber(client(), number, 0.9, notices());
  EXPECT_EQ(number.of(client().scene()), 0.3);
  EXPECT_EQ(notices().size(), 1U);
}

TEST_F(SceneEdits, what_no_known_device_holds_is_said_and_taken_by_the_mouse) {
  listEffect(client(), EffectKind::kFriction, true, notices());
  constexpr const haptic::SceneNumber& number = sceneNumber("friction", "stiffness_n_per_mm");
  EXPECT_EQ(numberProblem(client(), number, 0.5), "");
  EXPECT_NE(numberProblem(client(), number, 900.0), "");
  setNumber(client(), number, 900.0, notices());
  EXPECT_EQ(number.of(client().scene()), 900.0);
  EXPECT_EQ(notices().size(), 1U);
  EXPECT_EQ(largestHeld(client(), number), std::nullopt) << "a mouse holds all of it";
}

TEST_F(SceneEdits, effects_come_and_go_with_the_spring_before_those_that_need_it) {
  listEffect(client(), EffectKind::kFriction, true, notices());
  EXPECT_TRUE(client().scene().lists(EffectKind::kFriction));
  listEffect(client(), EffectKind::kSpring, false, notices());
  EXPECT_TRUE(client().scene().lists(EffectKind::kSpring)) << "friction needs it";
  EXPECT_EQ(notices().size(), 1U);
  listEffect(client(), EffectKind::kFriction, false, notices());
  listEffect(client(), EffectKind::kSpring, false, notices());
  EXPECT_FALSE(client().scene().lists(EffectKind::kSpring));
  listEffect(client(), EffectKind::kSpring, true, notices());
  EXPECT_EQ(client().scene().effects.front(), EffectKind::kSpring);
  EXPECT_EQ(notices().size(), 1U);
}

}  // namespace
}  // namespace fettle::app
