// How little two fields may have in common to be found: shares of known surfaces and shifts.
#include "engine/measure/align.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "engine/field/builder.h"

namespace fettle::engine {
namespace {

constexpr int kOverlapSide = 128;      // samples
constexpr double kOverlapApart = 0.1;  // [mm]
constexpr double kOverlapLong = kOverlapSide * kOverlapApart;

using OverlapHeights = std::function<double(double x, double y)>;  // [mm]

// Waves of `shortest` to twice that in all directions, Sq 1.
OverlapHeights overlapWaves(double shortest, std::uint64_t seed) {
  struct Wave {
    double kx, ky, phase, height;
  };
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return std::generate_canonical<double, 53>(random); };
  std::vector<Wave> all;
  for (int i = 0; i < 10; ++i) {
    const double k = 2.0 * std::numbers::pi / (shortest * (1.0 + uniform())),
                 angle = std::numbers::pi * uniform();
    all.push_back({k * std::cos(angle), k * std::sin(angle), 2.0 * std::numbers::pi * uniform(),
                   std::sqrt(2.0 / 10.0)});
  }
  return [all](double x, double y) {
    double z = 0.0;
    for (const Wave& w : all) z += w.height * std::sin(w.kx * x + w.ky * y + w.phase);
    return z;
  };
}

// Terraces 1 apart: cells of a random lattice, each with a level of three.
OverlapHeights overlapTerraces(double cell, std::uint64_t seed) {
  return [cell, seed](double x, double y) {
    const auto i = static_cast<std::int64_t>(std::floor(x / cell)),
               j = static_cast<std::int64_t>(std::floor(y / cell));
    std::mt19937_64 random(seed + static_cast<std::uint64_t>(i + 1000) * 7919U +
                           static_cast<std::uint64_t>(j + 1000) * 104729U);
    random.discard(3);
    return static_cast<double>(random() % 3);
  };
}

struct OverlapsFound {
  int right = 0, wrong = 0, refused = 0;
};

OverlapsFound overlapsFound(const std::function<OverlapHeights(std::uint64_t)>& surface, double common,
                            double noise, double tilt, int seeds) {
  OverlapsFound found;
  for (int s = 0; s < seeds; ++s) {
    const OverlapHeights z = surface(static_cast<std::uint64_t>(s) + 1);
    std::mt19937_64 random(900 + static_cast<std::uint64_t>(s));
    std::normal_distribution<double> normal;
    const double part = std::generate_canonical<double, 53>(random);
    // The overlap is a rectangle of `common` of the field's area.
    const double along = 1.0 - std::pow(common, part), across = 1.0 - std::pow(common, 1.0 - part);
    const glm::dvec2 shift(std::round(along * kOverlapSide) * kOverlapApart * (s % 2 == 0 ? 1.0 : -1.0),
                           std::round(across * kOverlapSide) * kOverlapApart * (s % 4 < 2 ? 1.0 : -1.0));
    const auto fieldAt = [&](const glm::dvec2& first, double slope) {
      std::vector<float> heights;
      for (int r = 0; r < kOverlapSide; ++r)
        for (int c = 0; c < kOverlapSide; ++c) {
          const double x = kOverlapApart * c, y = kOverlapApart * r;
          heights.push_back(static_cast<float>(z(first.x + x, first.y + y) + noise * normal(random) +
                                               slope * x - 0.5 * slope * y));
        }
      Grid grid;
      grid.width = grid.height = kOverlapSide;
      grid.spacing_x = grid.spacing_y = kOverlapApart;
      return makeField(grid, heights);
    };
    JobControl job;
    const auto motion = alignFields(fieldAt({0.0, 0.0}, 0.0), fieldAt(shift, tilt), {}, job);
    if (!motion)
      ++found.refused;
    else if (glm::length(glm::dvec2(motion->motion.shift) - shift) < 0.1 * kOverlapLong / 4.0)
      ++found.right;
    else
      ++found.wrong;
  }
  return found;
}

// The search takes no less than a fifth, of what its window leaves of both. The tilted ones are 8 degrees apart.
TEST(AlignOverlap, SmoothAndSteppedSurfacesAreFoundByLittleMoreThanAFifth) {
  constexpr int kSeeds = 3;
  for (const auto& [common, tilt] : {std::pair{0.33, 0.15}, {0.22, 0.0}}) {
    for (const double share : {0.08, 0.15, 0.4}) {
      const OverlapsFound found =
          overlapsFound([&](std::uint64_t seed) { return overlapWaves(share * kOverlapLong, seed); }, common,
                        0.01, tilt, kSeeds);
      EXPECT_EQ(found.right, kSeeds) << share << " " << common;
    }
    const OverlapsFound found =
        overlapsFound([](std::uint64_t seed) { return overlapTerraces(0.13 * kOverlapLong, seed); }, common,
                      0.03, tilt, kSeeds);
    EXPECT_EQ(found.right, kSeeds) << common;
  }
}

}  // namespace
}  // namespace fettle::engine
