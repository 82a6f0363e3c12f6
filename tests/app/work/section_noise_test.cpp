// What the difference of two cursors is worth in a scan whose rows or columns are off, against the scatter over scans.

#include "app/work/section_noise.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/measure/section.h"
#include "engine/measure/section_figures.h"

namespace fettle::app {
namespace {

constexpr int kNoisySide = 160;
constexpr double kSpacing = 0.01, kNoise = 0.002, kOff = 0.01;  // mm

engine::Version scanOf(std::uint64_t seed, bool rows) {
  engine::Grid grid;
  grid.width = grid.height = kNoisySide;
  grid.spacing_x = grid.spacing_y = kSpacing;
  std::mt19937_64 random(seed + 1);
  std::normal_distribution<double> normal;
  std::vector<double> off(kNoisySide);
  for (double& each : off) each = kOff * normal(random);
  std::vector<float> heights;
  for (int r = 0; r < kNoisySide; ++r)
    for (int c = 0; c < kNoisySide; ++c)
      heights.push_back(
          static_cast<float>(off[static_cast<std::size_t>(rows ? r : c)] + kNoise * normal(random)));
  return engine::makeField(grid, heights);
}

TEST(SectionNoise, CursorsHaveTheErrorOfRowsAndColumnsThatAreOff) {
  struct Line {
    std::string name;
    glm::dvec2 from, to;
    double width_mm = 0.0;
  };
  // All in the middle, so that no place of a width lies outside.
  const std::vector<Line> lines{{"along a column", {0.8, 0.2}, {0.8, 1.4}},
                                {"along a column, wide", {0.8, 0.2}, {0.8, 1.4}, 0.1},
                                {"between columns", {0.804, 0.203}, {0.804, 1.4}},
                                {"along a row", {0.2, 0.8}, {1.4, 0.8}},
                                {"along a row, wide", {0.2, 0.8}, {1.4, 0.8}, 0.1},
                                {"aslant", {0.2, 0.3}, {1.4, 1.1}},
                                {"aslant, wide", {0.2, 0.3}, {1.4, 1.1}, 0.1}};
  for (const bool rows : {true, false})
    for (const Line& line : lines) {
      double in_errors = 0.0;
      int trials = 0;
      for (std::uint64_t seed = 0; seed < 24; ++seed) {
        engine::JobControl job;
        const engine::Version scan = scanOf(seed, rows);
        const auto noise = sectionNoiseOf(scan, job);
        const auto section = engine::sectionAlong(scan, std::vector<glm::dvec2>{line.from, line.to},
                                                  {.width_mm = line.width_mm}, job);
        ASSERT_TRUE(noise && section);
        for (const auto& [first, second] : {std::pair{0.1, 0.5}, {0.233, 0.787}, {0.6, 1.103}}) {
          const auto figures = engine::cursorFigures(*section, first, second, *noise);
          ASSERT_TRUE(figures);
          const double in_error = figures->dz_mm.value / figures->dz_mm.error;  // the truth is 0
          in_errors += in_error * in_error;
          ++trials;
        }
      }
      const double scatter = std::sqrt(in_errors / trials);
      EXPECT_LT(scatter, 1.0 / 0.7) << line.name << (rows ? ", rows off" : ", columns off");
      EXPECT_GT(scatter, 1.0 / 1.4) << line.name << (rows ? ", rows off" : ", columns off");
    }
}

}  // namespace
}  // namespace fettle::app
