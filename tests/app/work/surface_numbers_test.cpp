#include "app/work/surface_numbers.h"

#include <cmath>
#include <cstddef>
#include <numbers>

#include <gtest/gtest.h>

#include "engine/measure/form.h"
#include "tests/haptic/support/fields.h"

namespace fettle::app {
namespace {

engine::ArealParameters measured(const engine::Version& field, bool analysis) {
  engine::JobControl job;
  const auto fit = engine::fitForm(field, {.degree = 0}, job);
  EXPECT_TRUE(fit);
  engine::ArealOptions options;
  options.at_ratios = curveRatios();
  options.analysis = analysis;
  auto found = engine::measureAreal(field, fit->form, options, job);
  EXPECT_TRUE(found);
  return *std::move(found);
}

// Waves of 1 mm along x, 2 um high, sampled every 0.05 mm.
engine::Version waves() {
  return tests::fieldOf(
      200, 120, [](int c, int) { return 0.002 * std::sin(2.0 * std::numbers::pi * 0.05 * c); }, 0.05, 0.05);
}

TEST(SurfaceNumbers, of_waves_have_their_height_length_and_frequency) {
  const engine::Version field = waves();
  const SurfaceCurves curves = curvesOf(measured(field, true), field.grid());
  EXPECT_TRUE(curves.no_decay.empty());
  ASSERT_EQ(curves.heights.size(), curveRatios().size());
  // From the highest to the lowest sample: 20 a wave, two of them at its crest and trough.
  EXPECT_NEAR(curves.heights.front(), 0.002, 1e-9);
  EXPECT_NEAR(curves.heights.back(), -0.002, 1e-9);
  for (std::size_t i = 1; i < curves.heights.size(); ++i)
    EXPECT_LE(curves.heights[i], curves.heights[i - 1]) << i;
  ASSERT_EQ(curves.decay.size(), 2U);
  for (const DecayCurve& curve : curves.decay) EXPECT_NEAR(curve.values.front(), 1.0, 1e-12) << curve.name;
  EXPECT_DOUBLE_EQ(curves.decay_step_mm, 0.05);
  // Half a wave from a crest lies a trough.
  EXPECT_LT(curves.decay.front().values[10], -0.95);
  // The line at 1 per mm is the largest, within a step of the frequencies.
  std::size_t most = 1;
  for (std::size_t i = 1; i < curves.along_x.density.size(); ++i)
    if (curves.along_x.density[i] > curves.along_x.density[most]) most = i;
  EXPECT_NEAR(curves.along_x.frequency(most), 1.0, curves.along_x.step);
}

TEST(SurfaceNumbers, say_why_there_is_no_autocorrelation) {
  const engine::Version field = waves();
  const SurfaceCurves curves = curvesOf(measured(field, false), field.grid());
  EXPECT_FALSE(curves.no_decay.empty());
  EXPECT_TRUE(curves.decay.empty());
  EXPECT_FALSE(curves.heights.empty());
}

}  // namespace
}  // namespace fettle::app
