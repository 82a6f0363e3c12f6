// Whether there is anything to save of a scene.
#include "app/window/scene_files.h"

#include <memory>

#include <gtest/gtest.h>

#include "app/window/scene_edits.h"
#include "haptic/scene/scene_numbers.h"
#include "tests/haptic/support/fields.h"

namespace fettle::app {
namespace {

// On the desk, with force, and not plugged in: the fit to it is known without it.
constexpr const char* kDesk = "woodenhaptics";

std::unique_ptr<LoopClient> startedOn(const std::string& device, double side_mm) {
  const engine::Version plate = tests::fieldOf(
      65, 65, [](int, int) { return 0.0; }, side_mm / 64.0, side_mm / 64.0);
  LoopClientOptions options;
  options.device = device;
  auto client = LoopClient::start(engine::History(plate, std::size_t{1} << 20), plate, haptic::defaultScene(),
                                  options, nullptr);
  EXPECT_TRUE(client) << client.error().line();
  return client ? std::move(*client) : nullptr;
}

TEST(SceneFilesTest, AFitToAnotherDeviceIsNoChangeAndWhatTheUserChangedIsOneOnEveryDevice) {
  const auto client = startedOn("mouse", 5e-3);
  ASSERT_TRUE(client);
  SceneFiles files;
  files.begin(*client, "");
  const haptic::Scene before = client->scene();
  ASSERT_TRUE(client->setDevice(kDesk));
  ASSERT_NE(client->scene().stiffness_n_per_mm, before.stiffness_n_per_mm);
  EXPECT_FALSE(files.changed(*client));
  EXPECT_EQ(files.title(*client), "no file");
  haptic::Scene edited = client->scene();
  edited.params.edge_snap.reach_mm *= 2.0;
  ASSERT_TRUE(client->setScene(edited));
  EXPECT_TRUE(files.changed(*client));
  ASSERT_TRUE(client->setDevice("mouse"));
  EXPECT_TRUE(files.changed(*client));
  // Listed on another device than that of the beginning.
  edited = client->scene();
  edited.params.edge_snap.reach_mm = client->fit()->fitted.params.edge_snap.reach_mm;
  ASSERT_TRUE(client->setScene(edited));
  EXPECT_FALSE(files.changed(*client));
  edited.effects.push_back(haptic::EffectKind::kGravity);
  ASSERT_TRUE(client->setScene(edited));
  EXPECT_TRUE(files.changed(*client));
  files.leave(*client);
  EXPECT_FALSE(files.changed(*client));
}

// The tip of a number says what it is without a word of a scene.
TEST(SceneFilesTest, ANumberThatWasFittedIsSaidAsTheFitHasIt) {
  const auto client = startedOn(kDesk, 5e-3);
  ASSERT_TRUE(client);
  const haptic::Scene fitted = client->scene();
  constexpr const haptic::SceneNumber& reach = haptic::sceneNumber("edge_snap", "reach_mm");
  constexpr const haptic::SceneNumber& pull = haptic::sceneNumber("edge_snap", "force_n");
  EXPECT_NE(reach.of(fitted), reach.of(haptic::defaultScene()));
  haptic::Scene edited = fitted;
  edited.params.edge_snap.reach_mm *= 2.0;
  edited.params.edge_snap.force_n = 0.3;
  ASSERT_TRUE(client->setScene(edited));
  EXPECT_EQ(unlessSaid(*client, reach), reach.of(fitted));
  EXPECT_EQ(unlessSaid(*client, pull), pull.of(haptic::defaultScene()));
  // A scene of the user is not fitted.
  ASSERT_TRUE(client->openScene(haptic::defaultScene()));
  EXPECT_EQ(unlessSaid(*client, reach), reach.of(haptic::defaultScene()));
}

}  // namespace
}  // namespace fettle::app
