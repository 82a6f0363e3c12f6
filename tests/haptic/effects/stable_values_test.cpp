// What a device does not hold, by name and number: the largest stable value is stable, and little more is
// not.
#include "haptic/effects/stability.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "haptic/devices/known_devices.h"
#include "haptic/devices/virtual/simulated_hand.h"
#include "haptic/tick/tick.h"
#include "tests/haptic/effects/touch.h"
#include "tests/support/source_tree.h"

namespace fettle::haptic {
namespace {

std::vector<DeviceProfile> devices() {
  std::vector<DeviceProfile> all{DeviceProfile{}, SimulatedHand({HandTarget{}}, {}).profile()};
  for (const KnownDevice& known : knownDevices()) all.push_back(*knownProfile(known.name));
  return all;
}

struct Ask {
  const char* word;  // of the sentence
  Scene scene;
  std::function<double(const Scene&)> number;
  std::function<void(Scene&, double)> set;
};

// One number too large in each.
std::vector<Ask> asks() {
  std::vector<Ask> all;
  const auto stiffness = [](const Scene& s) { return s.stiffness_n_per_mm; };
  const auto setStiffness = [](Scene& s, double k) { s.stiffness_n_per_mm = k; };
  Scene scene;
  scene.stiffness_n_per_mm = 1000.0;
  all.push_back({"stiffness", scene, stiffness, setStiffness});
  scene.effects = {EffectKind::kSpring, EffectKind::kTexture};
  scene.params.texture = {0.01, 5.0, TexturePattern::kNoise};
  all.push_back({"texture", scene, stiffness, setStiffness});
  scene.stiffness_n_per_mm = 0.01;
  scene.params.texture = {1.0, 0.2, TexturePattern::kNoise};
  all.push_back({"texture", scene, [](const Scene& s) { return s.params.texture.amplitude_mm; },
                 [](Scene& s, double a) { s.params.texture.amplitude_mm = a; }});
  scene = {};
  scene.effects = {EffectKind::kSpring, EffectKind::kFriction};
  scene.stiffness_n_per_mm = 0.01;
  scene.params.friction.stiffness_n_per_mm = 500.0;
  const auto grip = [](const Scene& s) { return s.params.friction.stiffness_n_per_mm; };
  const auto setGrip = [](Scene& s, double k) { s.params.friction.stiffness_n_per_mm = k; };
  all.push_back({"friction", scene, grip, setGrip});
  scene.effects.push_back(EffectKind::kEdgeSnap);
  scene.params.edge_snap = {0.01, 5.0};
  all.push_back({"friction", scene, grip, setGrip});
  scene.params.friction.stiffness_n_per_mm = 0.01;
  scene.params.edge_snap = {20.0, 0.1};
  all.push_back({"edge snap", scene, [](const Scene& s) { return s.params.edge_snap.force_n; },
                 [](Scene& s, double f) { s.params.edge_snap.force_n = f; }});
  scene = {};
  scene.effects = {EffectKind::kSpring, EffectKind::kViscosity};
  scene.stiffness_n_per_mm = 0.01;
  scene.params.viscosity.damping_n_s_per_mm = 1.0;
  all.push_back({"damping", scene, [](const Scene& s) { return s.params.viscosity.damping_n_s_per_mm; },
                 [](Scene& s, double c) { s.params.viscosity.damping_n_s_per_mm = c; }});
  return all;
}

TEST(StableValues, TheLargestThatIsNamedIsStableAndLittleMoreIsNot) {
  for (const DeviceProfile& device : devices())
    for (const double rate : {500.0, 1000.0, 10000.0})
      for (const double scale : {0.25, 1.0, 2.7})
        for (const Ask& ask : asks()) {
          const std::string which =
              device.name + ", " + ask.word + ", " + std::to_string(rate) + ", " + std::to_string(scale);
          const auto problem = stabilityProblem(ask.scene, device, rate, scale);
          if (!problem) {
            // A hand that holds more than a scene can ask for.
            EXPECT_GE(device.max_damping_n_s_per_mm / scale, ask.number(ask.scene)) << which;
            continue;
          }
          EXPECT_NE(problem->what.find(ask.word), std::string::npos) << problem->what;
          EXPECT_NE(problem->what.find(device.name), std::string::npos) << problem->what;
          EXPECT_EQ(problem->largest, ask.number(problem->corrected)) << which;
          EXPECT_LT(problem->largest, ask.number(ask.scene)) << which;
          ASSERT_GT(problem->largest, 0.0) << which;
          EXPECT_EQ(stabilityProblem(problem->corrected, device, rate, scale), std::nullopt) << which;
          EXPECT_EQ(sceneProblem(problem->corrected), std::nullopt) << which;
          // What is read there and typed is held as well.
          const std::size_t at = problem->remedy.find("at most ");
          ASSERT_NE(at, std::string::npos) << problem->remedy;
          Scene typed = problem->corrected;
          ask.set(typed, std::stod(problem->remedy.substr(at + 8)));
          EXPECT_EQ(stabilityProblem(typed, device, rate, scale), std::nullopt) << problem->remedy;
          EXPECT_DOUBLE_EQ(ask.number(typed), problem->largest) << problem->remedy;
          // Four digits.
          ask.set(typed, problem->largest * 1.002);
          EXPECT_NE(stabilityProblem(typed, device, rate, scale), std::nullopt) << which;
        }
}

TEST(StableValues, AnUnknownDeviceHolds400NewtonsAMetreAnd4NewtonSecondsAMetre) {
  Scene scene;
  const auto stiff = stabilityProblem(scene, DeviceProfile{}, 1000.0);
  ASSERT_TRUE(stiff);
  EXPECT_EQ(stiff->largest, 0.4);
  EXPECT_EQ(stiff->remedy, "at most 0.4 N/mm");
  scene.stiffness_n_per_mm = 0.4;
  EXPECT_EQ(stabilityProblem(scene, DeviceProfile{}, 1000.0), std::nullopt);
  scene.effects = {EffectKind::kSpring, EffectKind::kViscosity, EffectKind::kPassivity};
  const auto damps = stabilityProblem(scene, DeviceProfile{}, 1000.0);  // 0.002 and 0.005
  ASSERT_TRUE(damps);
  EXPECT_EQ(damps->largest, 0.004);
}

TEST(StableValues, AFasterLoopHoldsNoMoreThanTheDevicesOwnInputs) {
  Scene scene;
  scene.stiffness_n_per_mm = 1.5;
  DeviceProfile device = *knownProfile("woodenhaptics");
  EXPECT_NE(stabilityProblem(scene, device, 10000.0), std::nullopt)
      << "it says where it is 1000 times a second";
  device.rate_hz = 2000.0;
  EXPECT_EQ(stabilityProblem(scene, device, 10000.0), std::nullopt);
  EXPECT_NE(stabilityProblem(scene, device, 1000.0), std::nullopt);
}

TEST(StableValues, AWholeSceneIsMendedAndADeviceThatHoldsNothingIsReported) {
  Scene scene;
  scene.effects.clear();
  for (const EffectKind kind :
       {EffectKind::kSpring, EffectKind::kTexture, EffectKind::kFriction, EffectKind::kEdgeSnap,
        EffectKind::kViscosity, EffectKind::kCoupling, EffectKind::kPassivity})
    scene.effects.push_back(kind);
  scene.stiffness_n_per_mm = scene.force_limit_n = scene.params.friction.stiffness_n_per_mm = 1000.0;
  scene.params.texture = {1.0, 0.01, TexturePattern::kGrating};
  scene.params.edge_snap = {20.0, 0.01};
  scene.params.viscosity.damping_n_s_per_mm = scene.params.coupling.damping_n_s_per_mm = 1.0;
  for (const DeviceProfile& device : devices())
    for (const double scale : {0.01, 1.0, 30.0}) {
      const Scene corrected = stableScene(scene, device, 1000.0, scale);
      EXPECT_EQ(stabilityProblem(corrected, device, 1000.0, scale), std::nullopt) << device.name << scale;
      EXPECT_EQ(sceneProblem(corrected), std::nullopt) << device.name << scale;
      EXPECT_EQ(corrected.effects, scene.effects);
      const double largest = largestStableScale(corrected, device, 1000.0);
      EXPECT_GE(largest * 1.001, scale) << device.name;
    }
  DeviceProfile nothing;
  nothing.max_stiffness_n_per_mm = nothing.max_damping_n_s_per_mm = 0.0;
  EXPECT_NE(stabilityProblem(stableScene(scene, nothing, 1000.0), nothing, 1000.0), std::nullopt);
  EXPECT_EQ(largestStableScale(scene, nothing, 1000.0), 0.0);
}

TEST(StableValues, TheProjectsScenesAreHeldByTheSimulatedHandAndByEveryDeviceAtItsScale) {
  for (const char* name : {"default", "everything", "gentle_clean", "listen", "trace_edges"}) {
    const auto scene = loadScene(fettle::tests::inSourceTree(std::string("assets/scenes/") + name + ".toml"));
    ASSERT_TRUE(scene) << scene.error().line();
    const DeviceProfile hand = SimulatedHand({HandTarget{}}, {}).profile();
    EXPECT_EQ(stabilityProblem(*scene, hand, 1000.0), std::nullopt) << name;
    for (const DeviceProfile& device : devices()) {
      const double scale = largestStableScale(*scene, device, 1000.0);
      EXPECT_GT(scale, 0.2) << name << ", " << device.name;
      EXPECT_EQ(stabilityProblem(*scene, device, 1000.0, scale), std::nullopt) << name << ", " << device.name;
    }
  }
  const Scene scene = defaultScene();
  EXPECT_EQ(stabilityProblem(scene, *knownProfile("woodenhaptics"), 1000.0), std::nullopt);
}

// A hand that begins a millimetre inside a wall, with its target there: whether it still swings after six
// seconds. Of the swing, (b - K T / 2) / 2 m goes a second: at nine tenths of K = 2 b / T, e^-6 in that time.
bool handBuzzes(double stiffness, double rate_hz) {
  Scene scene = tests::sceneOf({EffectKind::kSpring});
  scene.stiffness_n_per_mm = stiffness;
  HandSpec spec;
  spec.rate_hz = rate_hz;
  const double rest = spec.stiffness_n_per_mm / (stiffness + spec.stiffness_n_per_mm);  // of 1 mm
  const engine::Version flat = tests::fieldOf(16, 16, [](int, int) { return 0.0; });
  SimulatedHand hand({{0.0, {7.5, 7.5, -1.0}}}, spec);
  tests::Touch touch(flat, scene, rate_hz);
  const int ticks = static_cast<int>(6.0 * rate_hz);
  double late = 0.0;
  for (int i = 0; i < ticks; ++i) {
    const glm::dvec3 at = hand.read().position_mm;
    hand.write(touch.at(at).force_n);
    if (i >= ticks - ticks / 10) late = std::max(late, std::abs(at.z + rest));
  }
  return late > 0.1 * rest;
}

TEST(StableValues, TheSimulatedHandHoldsWhatItsProfileSaysAndBuzzesAboveIt) {
  EXPECT_EQ(SimulatedHand({HandTarget{}}, {}).profile().max_stiffness_n_per_mm, 6.0);
  for (const double rate : {1000.0, 4000.0}) {
    const double holds = 6.0 * rate / 1000.0;
    EXPECT_FALSE(handBuzzes(0.9 * holds, rate)) << rate;
    EXPECT_TRUE(handBuzzes(1.15 * holds, rate)) << rate;
  }
}

}  // namespace
}  // namespace fettle::haptic
