// Texture: the relief is where it should be, no steeper than stated, and felt as the gradient of an energy.
#include "haptic/effects/texture.h"

#include <numbers>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/haptic/effects/touch.h"

namespace fettle::haptic {
namespace {

using tests::fieldOf;
using tests::HeldMass;
using tests::sceneOf;
using tests::Touch;
using tests::uniform;

Scene textured(const TextureParams& params) {
  Scene scene = sceneOf({EffectKind::kSpring, EffectKind::kTexture});
  scene.force_limit_n = 1000.0;
  scene.params.texture = params;
  return scene;
}

TEST(Texture, GratingIsASineOfItsAmplitudeAndWavelength) {
  const TextureParams params{0.04, 0.7, TexturePattern::kGrating};
  const TextureTable table(params);
  // A cubic B-spline through 16 samples a wave: off by (2 pi / 16)^4 / 384 * 3 of the half amplitude at
  // most, below 3e-4 of it; coefficients are floats.
  for (int i = 0; i < 1000; ++i) {
    const double x = -3.0 + 0.0123 * i;
    const double want = 0.02 * (std::cos(2.0 * std::numbers::pi * x / 0.7) - 1.0);
    EXPECT_NEAR(table.at(x, 1.7 * i).height_mm, want, 3e-4 * 0.02) << x;
  }
  EXPECT_NEAR(table.at(0.0, 0.0).height_mm, 0.0, 1e-8);
  EXPECT_NEAR(table.at(0.35, 5.0).height_mm, -0.04, 1e-8);
}

TEST(Texture, NoiseStaysWithinItsAmplitudeSlopeAndCurvature) {
  const TextureParams params{0.05, 0.4, TexturePattern::kNoise};
  const TextureTable table(params);
  const double slope = std::numbers::pi * 0.05 / 0.4;
  std::mt19937_64 random(4);
  double least = 0.0, most = -1.0, steepest = 0.0, bent = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const double x = uniform(random, -50.0, 50.0);
    const double y = uniform(random, -50.0, 50.0);
    const TextureTable::Value v = table.at(x, y);
    least = std::min(least, v.height_mm);
    most = std::max(most, v.height_mm);
    steepest = std::max(steepest, glm::length(v.slope));
    const double turn = uniform(random, 0.0, 6.3);
    const glm::dvec2 to{std::cos(turn), std::sin(turn)};
    const double h = 1e-4;
    const TextureTable::Value w = table.at(x + h * to.x, y + h * to.y);
    bent = std::max(bent, std::abs(glm::dot(w.slope - v.slope, to)) / h);
    // The slope is the height's: central differences, third derivative below 1e3 / mm^2.
    const double dx = table.at(x + h, y).height_mm - table.at(x - h, y).height_mm;
    ASSERT_NEAR(dx / (2 * h), v.slope.x, 1e-5);
  }
  EXPECT_LE(most, 0.0);
  EXPECT_GE(least, -0.05);
  EXPECT_GT(most - least, 0.6 * 0.05);  // and it is there
  EXPECT_LE(steepest, slope);
  EXPECT_GT(steepest, 0.2 * slope);
  EXPECT_LE(bent, 1.02 * 2.0 * std::numbers::pi * std::numbers::pi * 0.05 / (0.4 * 0.4));
  // Repeats after 16 wavelengths, and far away is as good as near: the period is exact to an ulp of 1e6.
  EXPECT_NEAR(table.at(0.13, 0.22).height_mm, table.at(0.13 + 6.4, 0.22 - 6.4).height_mm, 1e-12);
  EXPECT_NEAR(table.at(0.13, 0.22).height_mm, table.at(0.13 + 6.4e6, 0.22).height_mm, 1e-8);
}

TEST(Texture, NoiseHasNothingShorterThanItsWavelength) {
  const TextureTable table({0.05, 0.5, TexturePattern::kNoise});
  // Along a line through the whole period: no Fourier part beyond 16 cycles (plus the spline's own ripple,
  // below (2 pi / 16)^4 / 384 or so).
  constexpr int kN = 1024;
  double inside = 0.0, outside = 0.0;
  for (int f = 1; f < 100; ++f) {
    double re = 0.0, im = 0.0;
    for (int i = 0; i < kN; ++i) {
      const double h = table.at(8.0 * i / kN, 1.234).height_mm;
      re += h * std::cos(2.0 * std::numbers::pi * f * i / kN);
      im += h * std::sin(2.0 * std::numbers::pi * f * i / kN);
    }
    (f <= 16 ? inside : outside) += re * re + im * im;
  }
  EXPECT_LT(outside, 1e-6 * inside);
}

TEST(Texture, IsFeltAsTheGradientOfAnEnergyAndNeverOutOfContact) {
  const engine::Version flat = fieldOf(40, 40, [](int, int) { return 0.0; });
  for (const TexturePattern pattern : {TexturePattern::kNoise, TexturePattern::kGrating}) {
    const TextureParams params{0.05, 0.5, pattern};
    const TextureTable table(params);
    Touch touch(flat, textured(params));
    const auto energy = [&](const glm::dvec3& e) {
      const double d = std::max(-e.z + table.at(e.x, e.y).height_mm, 0.0);
      return 0.5 * d * d;
    };
    std::mt19937_64 random(6);
    for (int i = 0; i < 2000; ++i) {
      const glm::dvec3 e{uniform(random, 2, 37), uniform(random, 2, 37), uniform(random, -0.4, 0.02)};
      const ForceSample f = touch.at(e);
      const double h = 1e-5;
      const bool near_edge = std::abs(-e.z + table.at(e.x, e.y).height_mm) < 1e-4;
      for (int k = 0; k < 3 && !near_edge; ++k) {
        glm::dvec3 up = e, down = e;
        up[k] += h;
        down[k] -= h;
        // Rounding of energies near 0.1 over 2e-5, curvature's own error far below.
        ASSERT_NEAR(f.force_n[k], -(energy(up) - energy(down)) / (2 * h), 1e-6) << i << ' ' << k;
      }
      if (!f.contact) {
        ASSERT_EQ(f.force_n, glm::dvec3(0.0));
      }
    }
  }
}

// A pit of the grating holds the tip sideways with K (d + h) c: stable while that times T / 2 is below b.
TEST(Texture, SidewaysStiffnessInAPitIsWithinTheStatedBoundAndObeysTheSameCondition) {
  const engine::Version flat = fieldOf(40, 40, [](int, int) { return 0.0; });
  const TextureParams params{0.1, 1.0, TexturePattern::kGrating};
  const double curvature = 2.0 * std::numbers::pi * std::numbers::pi * 0.1;
  const double rate = 1000.0;
  const double b = 0.001;
  for (const double factor : {0.9, 1.12}) {
    // Pit at x = 20.5, 0.1 mm deep: pressed so deep that the stiffness is `factor` of 2 b / T.
    const double deep = factor * 2.0 * b * rate / curvature;
    Touch touch(flat, textured(params), rate);
    HeldMass mass{0.1, b};
    mass.x_mm = {20.5 + 1e-4, 20.0, -deep - 0.1};
    double early = 0.0, late = 0.0;
    for (int i = 0; i < 2000; ++i) {
      const glm::dvec3 force = touch.at(mass.x_mm).force_n;
      EXPECT_LE(std::abs(force.x), 1.02 * deep * curvature * std::abs(mass.x_mm.x - 20.5) + 1e-9);
      mass.advance({force.x, 0.0, 0.0}, touch.period_s);
      double& most = i < 200 ? early : late;
      if (i < 200 || i >= 1800) most = std::max(most, std::abs(mass.x_mm.x - 20.5));
    }
    EXPECT_EQ(late < early, factor < 1.0) << factor << ' ' << early << ' ' << late;
  }
}

TEST(Texture, HardInputsGiveFiniteForces) {
  const TextureTable table({1.0, 1e-3, TexturePattern::kNoise});
  for (const double x : {0.0, -0.0, 5e-324, 5e9, -5e9, 1e15})
    EXPECT_TRUE(std::isfinite(table.at(x, -x).height_mm)) << x;
  const engine::Version spikes = fieldOf(
      30, 30, [](int c, int r) { return (c * 7 + r * 3) % 11 == 0 ? 1e6 : 0.0; }, 0.05, 3.0);
  Scene scene = textured({1.0, 0.01, TexturePattern::kNoise});
  scene.force_limit_n = 8.0;
  Touch touch(spikes, scene);
  std::mt19937_64 random(7);
  for (int i = 0; i < 5000; ++i) {
    const ForceSample f =
        touch.at({uniform(random, -1, 3), uniform(random, -1, 90), uniform(random, -9, 1e6)});
    ASSERT_LE(glm::length(f.force_n), 8.0 * (1 + 1e-12));
  }
}

}  // namespace
}  // namespace fettle::haptic
