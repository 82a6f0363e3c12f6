// Whose scene the loop takes: the default one is fitted to every device, one that the user gave is not.
#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>

#include "app/work/loop_client.h"
#include "haptic/devices/known_devices.h"
#include "tests/haptic/support/fields.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

// A device on the desk that gives force, and is not plugged in: all that is asked here is known without it.
constexpr const char* kDesk = "woodenhaptics";

class SceneFitTest : public ::testing::Test {
 protected:
  static engine::Version fieldOf(double side_mm, int samples = 65) {
    const double cell_mm = side_mm / (samples - 1);
    return tests::fieldOf(
        samples, samples, [](int, int) { return 0.0; }, cell_mm, cell_mm);
  }
  static std::unique_ptr<LoopClient> start(double side_mm, const std::string& device,
                                           const SceneFitting& fitting,
                                           const haptic::Scene& scene = haptic::defaultScene(),
                                           int samples = 65) {
    const engine::Version plate = fieldOf(side_mm, samples);
    LoopClientOptions options;
    options.device = device;
    options.fitting = fitting;
    auto client =
        LoopClient::start(engine::History(plate, std::size_t{1} << 20), plate, scene, options, nullptr);
    EXPECT_TRUE(client) << client.error().line();
    return client ? std::move(*client) : nullptr;
  }
  // What the hand feels: the largest stiffness of the field is felt as the device's.
  static double felt(const LoopClient& client) {
    return client.device().profile().max_stiffness_n_per_mm / *client.largestStiffness() *
           client.scene().stiffness_n_per_mm;
  }
  static double reached(const LoopClient& client) {
    const haptic::DeviceProfile& profile = client.device().profile();
    return 2.0 * profile.workspace_radius_mm * profile.max_stiffness_n_per_mm / *client.largestStiffness();
  }
  static bool says(const std::vector<Notice>& notices, const char* what) {
    return std::ranges::any_of(notices,
                               [&](const Notice& n) { return n.what.find(what) != std::string::npos; });
  }
};

TEST_F(SceneFitTest, TheDefaultSceneIsFittedToTheDeviceAtEveryStart) {
  for (const double side_mm : {5e-3, 5e6}) {
    const auto client = start(side_mm, kDesk, {});
    ASSERT_TRUE(client);
    EXPECT_NEAR(felt(*client), 1.0, 2e-3) << side_mm;
    EXPECT_NEAR(reached(*client) / side_mm, 1.0, 2e-3);
    EXPECT_FALSE(client->feltProblem());
    EXPECT_FALSE(says(client->takeNotices(), "of the field"));
    const haptic::Scene fitted = client->scene();
    ASSERT_TRUE(client->setRate(2000.0));
    EXPECT_EQ(client->scene(), fitted) << "fitted again, to the same";
    // A part of the motion is softer and finer, and no other scene.
    DeviceSetup setup = client->deviceSetup();
    setup.motion = 0.5;
    ASSERT_TRUE(client->setDeviceSetup(setup));
    EXPECT_EQ(client->scene(), fitted);
    EXPECT_NEAR(felt(*client), 0.5, 2e-3);
  }
}

TEST_F(SceneFitTest, AnotherDeviceIsFittedAnewAndWhatTheUserChangedStays) {
  const auto client = start(5e-3, "mouse", {});
  ASSERT_TRUE(client);
  haptic::Scene edited = client->scene();
  EXPECT_EQ(edited.level, haptic::ContactLevel::kCertified);
  EXPECT_EQ(edited.force_limit_n, 8.0) << "cells of 0.08 um, on which a stiffness of 1000 N/mm was the most";
  EXPECT_NEAR(edited.stiffness_n_per_mm * 2.0 * 5e-3 / 64.0, 8.0, 1e-9);
  edited.brush_radius_samples = 11.0;
  edited.params.edge_snap.reach_mm = 3e-4;
  ASSERT_TRUE(client->setScene(edited));
  ASSERT_TRUE(client->setDevice(kDesk));
  EXPECT_NEAR(felt(*client), 1.0, 2e-3);
  EXPECT_NEAR(reached(*client), 5e-3, 1e-5);
  EXPECT_EQ(client->scene().level, haptic::ContactLevel::kPaper) << "as at the start with this device";
  EXPECT_EQ(client->scene().brush_radius_samples, 11.0);
  EXPECT_EQ(client->scene().params.edge_snap.reach_mm, 3e-4);
  // As often as the device is changed.
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(client->setDevice("mouse"));
    EXPECT_EQ(client->scene(), edited);
    ASSERT_TRUE(client->setDevice(kDesk));
    EXPECT_EQ(client->scene().params.edge_snap.reach_mm, 3e-4);
  }
}

TEST_F(SceneFitTest, TheUsersSceneStaysAsItIsAndWhatIsWrongWithItIsSaidUntilItIsFitted) {
  haptic::Scene own = haptic::defaultScene();
  own.brush_radius_samples = 5.0;
  own.stiffness_n_per_mm = 0.8;
  for (const double side_mm : {5e-3, 5e6}) {
    const auto client = start(side_mm, kDesk, {.fits = false}, own);
    ASSERT_TRUE(client);
    EXPECT_EQ(client->scene(), own);
    ASSERT_TRUE(client->feltProblem());
    EXPECT_TRUE(says(client->takeNotices(), client->feltProblem()->what.c_str()));
    ASSERT_TRUE(client->fitScene());
    EXPECT_FALSE(client->feltProblem());
    EXPECT_NEAR(felt(*client), 1.0, 2e-3);
    EXPECT_NEAR(reached(*client) / side_mm, 1.0, 2e-3);
    EXPECT_EQ(client->scene().brush_radius_samples, 5.0);
    EXPECT_FALSE(client->finished());
    // And back to the file.
    ASSERT_TRUE(client->openScene(own));
    EXPECT_EQ(client->scene(), own);
    EXPECT_TRUE(client->feltProblem());
    EXPECT_FALSE(client->fit());
  }
}

// A stiffer scene is felt at a smaller scale, as at the start with it; with one that the device never holds all stays.
TEST_F(SceneFitTest, AnOpenedSceneIsFeltAsAtTheStartWithIt) {
  const auto client = start(100.0, kDesk, {});
  ASSERT_TRUE(client);
  EXPECT_EQ(client->scene(), haptic::defaultScene());
  EXPECT_NEAR(felt(*client), 0.5, 1e-3) << "a part of ordinary size, as ever";
  haptic::Scene own = haptic::defaultScene();
  own.stiffness_n_per_mm = 4.0;
  ASSERT_TRUE(client->openScene(own));
  EXPECT_EQ(client->scene(), own);
  EXPECT_NEAR(felt(*client), 1.0, 1e-3);
  EXPECT_NEAR(reached(*client), 50.0, 0.1);
  EXPECT_FALSE(client->feltProblem()) << "half of the field";
  own.stiffness_n_per_mm = -1.0;
  EXPECT_FALSE(client->openScene(own));
  EXPECT_EQ(client->scene().stiffness_n_per_mm, 4.0);
  EXPECT_FALSE(client->finished());
}

// The scene of a session, kept with what was fitted for the device it was made with.
TEST_F(SceneFitTest, AKeptFitIsFittedAnewAndAKeptSceneWithoutOneIsNot) {
  const auto mouse = start(5e-3, "mouse", {});
  ASSERT_TRUE(mouse && mouse->fit());
  haptic::Scene kept = mouse->scene();
  kept.mark_radius_samples = 9.0;
  const auto fitted = start(5e-3, kDesk, {.fits = true, .last = mouse->fit(), .lowers = true}, kept);
  ASSERT_TRUE(fitted);
  EXPECT_NEAR(felt(*fitted), 1.0, 2e-3);
  EXPECT_EQ(fitted->scene().mark_radius_samples, 9.0);
  const auto as_it_is = start(5e-3, kDesk, {.fits = false, .lowers = true}, kept);
  ASSERT_TRUE(as_it_is);
  EXPECT_EQ(as_it_is->scene(), kept);
}

// What a device does not hold is lowered for it alone: with the next one it is as its user had it.
TEST_F(SceneFitTest, WhatWasLoweredForADeviceIsAsBeforeWithTheNextOne) {
  const auto client = start(5e-3, "mouse", {});
  ASSERT_TRUE(client);
  haptic::Scene edited = client->scene();
  edited.effects.push_back(haptic::EffectKind::kEdgeSnap);
  edited.params.edge_snap.force_n = 0.9;
  ASSERT_TRUE(client->setScene(edited));
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(client->setDevice(kDesk));
    EXPECT_TRUE(says(client->takeNotices(), "edge snap"));
    const double lowered_n = client->scene().params.edge_snap.force_n;
    EXPECT_NEAR(lowered_n, 0.25, 1e-3) << "4 F over 1 mm of the hand, of 1 N/mm";
    EXPECT_EQ(client->unlowered().params.edge_snap.force_n, 0.9);
    ASSERT_TRUE(client->setRate(2000.0));
    EXPECT_EQ(client->scene().params.edge_snap.force_n, lowered_n);
    EXPECT_FALSE(says(client->takeNotices(), "edge snap")) << "it was said";
    ASSERT_TRUE(client->setRate(1000.0));
    ASSERT_TRUE(client->setDevice("mouse"));
    EXPECT_EQ(client->scene(), edited);
  }
  ASSERT_TRUE(client->setDevice(kDesk));
  ASSERT_TRUE(client->fitScene());
  EXPECT_EQ(client->unlowered().params.edge_snap.force_n, 0.9);
  // What the user typed meanwhile stays.
  haptic::Scene typed = client->scene();
  typed.params.edge_snap.force_n = 0.1;
  typed.brush_radius_samples = 11.0;
  ASSERT_TRUE(client->setScene(typed));
  ASSERT_TRUE(client->setDevice("mouse"));
  EXPECT_EQ(client->scene().params.edge_snap.force_n, 0.1);
  EXPECT_EQ(client->scene().brush_radius_samples, 11.0);
}

// The scale follows the reach that was measured, whatever the user typed for another: it is lowered, and not the setup refused.
TEST_F(SceneFitTest, ADeviceIsSetUpWithTheLargestStiffnessForAnotherReach) {
  const auto client = start(100.0, kDesk, {});
  ASSERT_TRUE(client);
  haptic::Scene edited = client->scene();
  edited.stiffness_n_per_mm = *client->largestStiffness();
  ASSERT_TRUE(client->setScene(edited));
  EXPECT_NEAR(felt(*client), 1.0, 1e-3);
  DeviceSetup setup = client->deviceSetup();
  setup.reach = DeviceReach{glm::dvec3(-25.0), glm::dvec3(25.0)};
  const engine::Status set = client->setDeviceSetup(setup);
  ASSERT_TRUE(set) << set.error().line();
  EXPECT_TRUE(says(client->takeNotices(), "is more than the"));
  EXPECT_NEAR(felt(*client), 1.0, 1e-3);
  EXPECT_NEAR(client->scene().stiffness_n_per_mm, 0.5, 1e-3) << "2 mm of the field for one of the hand";
  setup.reach.reset();
  ASSERT_TRUE(client->setDeviceSetup(setup));
  EXPECT_EQ(client->scene(), edited);
  EXPECT_NEAR(felt(*client), 1.0, 1e-3);
}

// Another rate holds less: a scene that is fitted is lowered for it, and as before with the first.
TEST_F(SceneFitTest, ASlowerLoopLowersAFittedSceneAndRefusesOneThatWasGiven) {
  tests::TempFolder folder;
  const std::string strokes = folder.file("strokes.csv");
  std::ofstream(strokes) << "t,x,y,z,tool\n0,5,5,1,feel\n60,5,5,1,feel\n";
  for (const bool fits : {true, false}) {
    const auto client = start(12.0, "hand:" + strokes, {.fits = fits});
    ASSERT_TRUE(client);
    ASSERT_TRUE(client->setRate(2000.0));
    haptic::Scene stiff = client->scene();
    stiff.stiffness_n_per_mm = 10.0;
    ASSERT_TRUE(client->setScene(stiff));
    EXPECT_EQ(static_cast<bool>(client->setRate(1000.0)), fits);
    EXPECT_EQ(client->scene().stiffness_n_per_mm, fits ? 6.0 : 10.0);
    ASSERT_TRUE(client->setRate(2000.0));
    EXPECT_EQ(client->scene(), stiff);
  }
}

// Edge snap on a fine scan: the pull is that of a reach of 63 samples, whatever the scene states.
TEST_F(SceneFitTest, EdgeSnapThatIsTakenIsStableWithTheReachThatTheScanHas) {
  constexpr int kSamples = 1025;
  haptic::Scene own = haptic::defaultScene();
  own.effects.push_back(haptic::EffectKind::kEdgeSnap);
  own.params.edge_snap = {10.0, 30.0};
  const double cut_mm = 63.0 * 100.0 / (kSamples - 1);
  // As felt, by a largest stiffness that is rounded down to four digits: up to a thousandth more than it is.
  constexpr double kMost = 1.0 + 1e-3;
  const auto pull = [&](const LoopClient& client) {
    const double force_n = client.scene().params.edge_snap.force_n;
    return 4.0 * force_n / cut_mm * felt(client) / client.scene().stiffness_n_per_mm;
  };
  // Ticked on in the window: refused with the force that is held, which is taken.
  const auto client = start(100.0, kDesk, {}, haptic::defaultScene(), kSamples);
  ASSERT_TRUE(client);
  const engine::Status set = client->setScene(own);
  ASSERT_FALSE(set);
  const std::string remedy = set.error().remedy;
  ASSERT_NE(remedy.find("a force of at most "), std::string::npos) << remedy;
  own.params.edge_snap.force_n = std::stod(remedy.substr(remedy.find_first_of("0123456789")));
  ASSERT_TRUE(client->setScene(own)) << remedy;
  EXPECT_LE(pull(*client), kMost);
  EXPECT_GT(pull(*client), 0.99);
  // Given at the start: at the scale at which it is held.
  own.params.edge_snap.force_n = 10.0;
  const auto given = start(100.0, kDesk, {.fits = false}, own, kSamples);
  ASSERT_TRUE(given);
  EXPECT_LE(pull(*given), kMost);
  EXPECT_GT(pull(*given), 0.99);
  // From another device: lowered to what is held.
  const auto kept = start(100.0, kDesk, {.fits = true, .last = client->fit(), .lowers = true}, own, kSamples);
  ASSERT_TRUE(kept);
  EXPECT_LE(pull(*kept), kMost);
  EXPECT_EQ(kept->scene().params.edge_snap.force_n, client->scene().params.edge_snap.force_n);
}

}  // namespace
}  // namespace fettle::app
