#include "engine/measure/wave_fit.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/measure/spatial.h"
#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

using std::numbers::pi;

SpatialParameters spatialOf(const Surface& surface) {
  JobControl job;
  const auto found = correlate(surface, job);
  EXPECT_TRUE(found) << found.error().line();
  return found ? found->parameters : SpatialParameters{};
}

// A wave of a length in units of x, whose direction of travel is at `degrees`; spacing 1 along x.
Surface waveOf(double length, double degrees, double spacing_y,
               const std::function<bool(int, int)>& hole = {}) {
  const double x = std::cos(degrees * pi / 180.0) / length, y = std::sin(degrees * pi / 180.0) / length;
  Surface surface = surfaceOf(200, 150, [&](int c, int r) {
    if (hole && hole(c, r)) return std::nan("");
    return 2.5 * std::cos(2.0 * pi * (x * c + y * spacing_y * r) + 0.7);
  });
  surface.spacing_y = spacing_y;
  return surface;
}

// Heights are floats: a wave's length is known to some 1e-8 over the number of waves.
TEST(DominantWave, OfASineIsItsLength) {
  for (const double length : {7.3, 12.0, 37.3, 61.0, 140.0})
    for (const double degrees : {0.0, 31.0, 90.0, 155.0})
      for (const double spacing_y : {1.0, 4.0}) {
        if (length < 4.0 * spacing_y) continue;  // two samples of a wave along y
        const SpatialParameters p = spatialOf(waveOf(length, degrees, spacing_y));
        EXPECT_NEAR(p.ssw / length, 1.0, 1e-6) << length << ' ' << degrees << ' ' << spacing_y;
      }
}

TEST(DominantWave, HolesTakeNoPart) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform;
  for (const double length : {12.0, 37.3, 90.0}) {
    const Surface surface = waveOf(length, 31.0, 1.0, [&](int c, int r) {
      return uniform(random) < 0.3 || (c > 90 && c < 150 && r > 20 && r < 70);
    });
    EXPECT_NEAR(spatialOf(surface).ssw / length, 1.0, 1e-6) << length;
  }
}

// The larger one of two, however near in length: a wave over the surface apart each has a peak of its own.
TEST(DominantWave, OfTwoWavesIsTheLargerOne) {
  for (const double other : {0.5, 0.9}) {
    const Surface surface = surfaceOf(200, 150, [&](int c, int r) {
      return std::sin(2.0 * pi * c / 25.0) + other * std::sin(2.0 * pi * c / 20.0 + 2.0 * pi * r / 50.0);
    });
    EXPECT_NEAR(spatialOf(surface).ssw, 25.0, 0.01) << other;
  }
  // Crossed: two waves along the diagonals, each of sqrt(1/2) of the length. What one leaves beside its peak moves that of the other: by less than
  // 3 / (4 pi^2) of a wave over the square of those along a side.
  const Surface crate =
      surfaceOf(200, 200, [](int c, int r) { return std::cos(pi * c / 10.0) * std::cos(pi * r / 10.0); });
  EXPECT_NEAR(spatialOf(crate).ssw, 20.0 / std::sqrt(2.0), 20.0 * 0.076 / 10.0 / 10.0 * 2.0);
}

// White noise as large as the wave: by the Cramer-Rao bound the frequency of one of 200 x 150 samples is known to
// sqrt(12 / (150 * 200)) / (2 pi) of a wave over the surface, where A^2 / 2 is the noise's mean square.
TEST(DominantWave, IsFoundUnderNoise) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> noise;
  const Surface surface = surfaceOf(
      200, 150, [&](int c, int) { return std::sqrt(2.0) * std::sin(2.0 * pi * c / 23.0) + noise(random); });
  const double waves = 200.0 / 23.0, error = std::sqrt(12.0 / 30000.0) / (2.0 * pi);
  EXPECT_NEAR(200.0 / spatialOf(surface).ssw, waves, 4.0 * error);
}

TEST(DominantWave, OfHardSurfacesIsAFigureOrAReason) {
  const auto check = [](const Surface& surface) {
    const SpatialParameters p = spatialOf(surface);
    EXPECT_EQ(std::isfinite(p.ssw), p.no_ssw.empty()) << p.ssw << ' ' << p.no_ssw;
    if (p.no_ssw.empty()) {
      EXPECT_GT(p.ssw, 1.0);
    }
    return p.no_ssw;
  };
  EXPECT_FALSE(check(surfaceOf(0, 0, {})).empty());
  EXPECT_FALSE(check(surfaceOf(90, 1, [](int c, int) { return c % 2; })).empty());
  EXPECT_FALSE(check(surfaceOf(20, 20, [](int, int) { return 0.0; })).empty());
  (void)check(surfaceOf(40, 30, [](int c, int r) { return c == 20 && r == 9 ? 1e6 : -1e6 / 1200.0; }));
  (void)check(surfaceOf(40, 30, [](int c, int r) { return c < 20 ? 1.0 : r < 0 ? 0.0 : -1.0; }));
  (void)check(
      surfaceOf(40, 30, [](int c, int r) { return c % 2 == 0 && r % 2 == 0 ? c - 20.0 : std::nan(""); }));
  // A bend over the whole surface is no wave of it.
  EXPECT_EQ(check(surfaceOf(60, 60, [](int c, int) { return std::cos(pi * c / 59.0); })),
            "its largest wave is longer than the surface");
}

TEST(DominantWave, IsBitIdenticalForAnyNumberOfThreads) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> noise;
  const Surface surface = surfaceOf(143, 120, [&](int c, int) { return std::sin(0.2 * c) + noise(random); });
  const auto with = [&](int threads) {
    double found = 0.0;
    tbb::task_arena arena(threads);
    arena.execute([&] { found = spatialOf(surface).ssw; });
    return found;
  };
  const double one = with(1);
  for (const int threads : {2, 4}) EXPECT_EQ(with(threads), one);
}

}  // namespace
}  // namespace fettle::engine
