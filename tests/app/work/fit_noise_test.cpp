// What the tilts of a plane are worth in a scan whose rows or columns are off, by the noise that is found in it, against the
// scatter over scans.

#include "app/work/fit_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/measure/fit_regions.h"

namespace fettle::app {
namespace {

constexpr int kFitNoiseSide = 128;
constexpr double kFitNoiseSpacing = 0.01, kFitNoise = 0.002;  // mm

using NoiseOf = std::function<double(int, int)>;

// Noise of a field by its seed: of samples of 1, and of lines.
NoiseOf noiseWith(std::uint64_t seed, double rows, double columns, bool shared) {
  std::mt19937_64 random(seed + 1);
  std::normal_distribution<double> normal;
  const auto drawn = [&](std::size_t count) {
    std::vector<double> values(count);
    for (double& value : values) value = normal(random);
    return values;
  };
  constexpr std::size_t kWide = kFitNoiseSide + 2;
  return [=, of_rows = drawn(kFitNoiseSide), of_columns = drawn(kFitNoiseSide),
          white = drawn(kWide * kFitNoiseSide)](int c, int r) {
    const double* at = &white[static_cast<std::size_t>(r) * kWide + static_cast<std::size_t>(c)];
    const double own = shared ? (at[0] + at[1] + at[2]) / std::sqrt(3.0) : at[0];
    return own + rows * of_rows[static_cast<std::size_t>(r)] +
           columns * of_columns[static_cast<std::size_t>(c)];
  };
}

TEST(FitNoise, TiltsHaveTheErrorOfRowsAndColumnsThatAreOff) {
  struct Case {
    std::string name;
    double rows, columns;
    bool shared;
  };
  constexpr int kSeeds = 60;
  for (const Case& of : {Case{"white", 0.0, 0.0, false},
                         {"rows", 1.0, 0.0, false},
                         {"loud rows", 30.0, 0.0, false},
                         {"columns", 0.0, 5.0, false},
                         {"both", 2.0, 1.0, false},
                         {"shared along rows", 0.0, 0.0, true},
                         {"shared, and rows", 1.0, 0.0, true}}) {
    double in_errors[2] = {}, mean_errors[2] = {}, squares[2] = {};
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      const NoiseOf noise = noiseWith(seed, of.rows, of.columns, of.shared);
      engine::Grid grid;
      grid.width = grid.height = kFitNoiseSide;
      grid.spacing_x = grid.spacing_y = kFitNoiseSpacing;
      std::vector<float> heights;
      for (int r = 0; r < kFitNoiseSide; ++r)
        for (int c = 0; c < kFitNoiseSide; ++c)
          heights.push_back(static_cast<float>(kFitNoise * noise(c, r)));
      const engine::Version field = engine::makeField(grid, heights);
      engine::JobControl job;
      engine::FitOptions how;
      ASSERT_TRUE(setNoise(how, field, job));
      const auto region = engine::wholeRegion(field, engine::Region::kAll, job);
      const auto fit =
          engine::fitShape(engine::FitSamples(field, *region), engine::ShapeKind::kPlane, how, job);
      ASSERT_TRUE(fit) << fit.error().line();
      const engine::ShapeFit::Errors errors = fit->errors();
      for (int axis = 0; axis < 2; ++axis) {
        const double off = fit->shape.direction[axis], error = errors.direction[axis];
        in_errors[axis] += off * off / (error * error) / kSeeds;
        squares[axis] += off * off / kSeeds;
        mean_errors[axis] += error / kSeeds;
      }
    }
    for (int axis = 0; axis < 2; ++axis) {
      // Of 60 a root mean square is known to 9 %, the errors to as much as 128 offsets know their size.
      EXPECT_NEAR(std::sqrt(in_errors[axis]), 1.0, 0.3) << of.name << ' ' << "xy"[axis];
      EXPECT_LT(mean_errors[axis], 1.5 * std::sqrt(squares[axis])) << of.name << ' ' << "xy"[axis];
    }
  }
}

}  // namespace
}  // namespace fettle::app
