// After an edit under the tip the proxy is on the surface at the very next tick, whatever the brush, the
// level and the effects.
#include <cstdio>

#include <gtest/gtest.h>

#include "tests/haptic/effects/touch.h"

namespace fettle::haptic {
namespace {

using tests::fieldOf;
using tests::uniform;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kStrokes = 40;  // ten times slower there
#else
constexpr int kStrokes = 400;
#endif
constexpr int kTicksAStroke = 2500;
constexpr int kEditedSide = 200;

// Height of the field below a point, from its samples alone.
double heightUnder(const engine::FieldReader& field, const glm::dvec3& at) {
  const int c = std::clamp(static_cast<int>(at.x), 0, kEditedSide - 2);
  const int r = std::clamp(static_cast<int>(at.y), 0, kEditedSide - 2);
  const double u = at.x - c;
  const double v = at.y - r;
  const auto h = [&](int dc, int dr) { return static_cast<double>(field.heightAt(c + dc, r + dr)); };
  return (1 - v) * ((1 - u) * h(0, 0) + u * h(1, 0)) + v * ((1 - u) * h(0, 1) + u * h(1, 1));
}

TEST(EditUnderTheTip, TheProxyIsOnTheSurfaceAtTheVeryNextTickInAMillionTicksOfSmoothing) {
  std::mt19937_64 random(77);
  const engine::Version rough = fieldOf(kEditedSide, kEditedSide, [&](int c, int r) {
    return 0.4 * std::sin(0.8 * c) * std::cos(0.6 * r) + (c % 41 == 0 ? 0.6 : 0.0) +
           uniform(random, -0.2, 0.2);
  });
  engine::LiveField field(rough, engine::Growth::kAllowed);
  std::int64_t contacts = 0, edited = 0, below = 0, above = 0, without_contact = 0;
  double worst = 0.0;
  for (int stroke = 0; stroke < kStrokes; ++stroke) {
    Scene scene;
    scene.brush_radius_samples = stroke % 4 == 0 ? 0.0 : uniform(random, 0.0, 6.0);
    scene.level = stroke % 8 == 5   ? ContactLevel::kCertified
                  : stroke % 8 == 6 ? ContactLevel::kDescent
                                    : ContactLevel::kPaper;
    if (stroke % 2 == 1)
      for (const EffectKind kind : {EffectKind::kFriction, EffectKind::kCoupling, EffectKind::kPassivity})
        scene.effects.push_back(kind);
    // Smoothed flat it would have nothing left to show: each tenth stroke starts on the rough field.
    if (stroke % 10 == 0) static_cast<void>(field.adopt(rough));
    Tick tick(scene, field, rough);
    glm::dvec3 tip{uniform(random, 5, 190), uniform(random, 5, 190), 0.0};
    const double turn = uniform(random, 0.0, 6.3);
    const double speed = uniform(random, 0.005, 0.2);  // up to 200 mm/s
    const double depth = uniform(random, 0.05, 2.0);
    for (int i = 0; i < kTicksAStroke; ++i) {
      tip.x = std::clamp(tip.x + speed * std::cos(turn + 1e-3 * i), 0.0, kEditedSide - 1.0);
      tip.y = std::clamp(tip.y + speed * std::sin(turn + 1e-3 * i), 0.0, kEditedSide - 1.0);
      // Follows the surface, lifts now and then.
      tip.z = heightUnder(field.reader(), tip) - depth * (0.8 + std::sin(0.01 * i));
      const engine::Version before = field.snapshot();
      const ForceSample felt = tick.run({1e-3 * i, tip, Tool::kSmooth});
      if (!felt.contact) {
        without_contact += tip.z < heightUnder(before.reader(), tip) ? 1 : 0;
        continue;
      }
      ++contacts;
      edited += field.snapshot() == before ? 0 : 1;
      // Heights and positions below 200 in double, weights from differences of them: below 1e-13.
      const double error = felt.proxy_mm.z - heightUnder(before.reader(), felt.proxy_mm);
      worst = std::max(worst, std::abs(error));
      below += error < -1e-12 ? 1 : 0;
      above += error > 1e-12 ? 1 : 0;
    }
  }
  std::printf("%d ticks, %lld in contact, %lld edits; below %lld, above %lld, worst %.1e mm\n",
              kStrokes * kTicksAStroke, static_cast<long long>(contacts), static_cast<long long>(edited),
              static_cast<long long>(below), static_cast<long long>(above), worst);
  EXPECT_EQ(below, 0);
  EXPECT_EQ(above, 0);
  EXPECT_EQ(without_contact, 0);
  EXPECT_GT(contacts, kStrokes * kTicksAStroke / 2);
  EXPECT_GT(edited, contacts / 2);
}

}  // namespace
}  // namespace fettle::haptic
