// Paths that processors with wider vectors have of their own: means by strips and by tiles, Gaussians and medians of small windows by tiles.
// Each must have the bits of the plain one; where it matters which path is taken, the fields here are made so that it is.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/tile.h"
#include "engine/filter/pass.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

PlainField at(const Version& version, const FilterSpec& spec, int block_side, CpuLevel level) {
  JobControl job;
  const Result<Filtered> result = applyFilter(version, version, spec, FilterTuning{block_side, level}, job);
  EXPECT_TRUE(result);
  return toPlain(result->field);
}

// Every level and several cuts of the work, upright and turned over, have the bits of the plain level; these are what the reference says.
void expectPlainBits(const PlainField& plain, const FilterSpec& spec, const std::vector<int>& block_sides) {
  const Version version = toVersion(plain);
  const PlainField expected = at(version, spec, 64, CpuLevel::kPlain);
  EXPECT_EQ(checkPass(plain, expected, spec, 300), "");
  for (const CpuLevel level : {CpuLevel::kAvx2, CpuLevel::kAvx512})
    for (const int side : block_sides) {
      EXPECT_TRUE(sameBits(at(version, spec, side, level), expected))
          << spec.window << " " << side << " " << static_cast<int>(level);
      const PlainField turned = at(version.inverted(), spec, side, level);
      int different = 0;
      for (std::size_t i = 0; i < turned.z.size(); ++i)
        different +=
            turned.z[i] == -expected.z[i] || (std::isnan(turned.z[i]) && std::isnan(expected.z[i])) ? 0 : 1;
      EXPECT_EQ(different, 0) << spec.window << " " << side << " " << static_cast<int>(level);
    }
}

std::uint32_t hashOf(int c, int r) {
  std::uint32_t x = static_cast<std::uint32_t>(c) * 0x9e3779b1U ^ static_cast<std::uint32_t>(r) * 0x85ebca77U;
  x ^= x >> 15;
  x *= 0x2c1b3c6dU;
  return x ^ (x >> 13);
}

// Multiples of 1/8 to 2^20: sums of any window are exact in one double.
float coarse(int c, int r) {
  return 0.125F * static_cast<float>(hashOf(c, r) % (1U << 23)) - 1e5F;
}

// Samples in one column that cancel in windows of so many rows, so that what is beside them counts.
std::function<float(int, int)> largeAt(int column, int window) {
  return [=](int c, int r) {
    const int row = r % window;
    return c != column || row == window - 1 ? coarse(c, r) : row % 2 == 0 ? 1e30F : -1e30F;
  };
}

TEST(FastPaths, OfABoxTakeASecondLaneForRowsThatNeedItAndGiveItUpAgain) {
  for (const bool holes : {false, true}) {
    const PlainField plain = formed(300, 300, [&](int c, int r) {
      if (holes && hashOf(c, r + 1000) % 97 == 0) return kHole;
      const bool fine = r == 50 || r == 51 || r == 130 || r == 290;
      return fine && hashOf(c, r) % 5 == 0 ? std::ldexp(coarse(c, r), -48) : coarse(c, r);
    });
    for (const int window : {3, 5, 7, 21, 131})
      expectPlainBits(plain, makeSpec(FilterKind::kBox, window), {0, 64, 256});
  }
}

TEST(FastPaths, OfABoxGoOnBehindRowsThatFitNoTwoLanes) {
  const PlainField plain = formed(200, 400, [](int c, int r) {
    const bool neither = r > 70 && r < 110 && c % 40 == 3;
    return neither ? (c % 80 == 3 ? 1e12F : 1e-30F) * coarse(c, r) : coarse(c, r);
  });
  for (const int window : {3, 5, 7, 31}) expectPlainBits(plain, makeSpec(FilterKind::kBox, window), {0, 64});
}

TEST(FastPaths, OverWholeTilesHaveThePlainBitsWhateverTheMagnitudes) {
  constexpr float kMost = std::numeric_limits<float>::max();
  struct Ground {
    const char* name;
    std::function<float(int, int)> z;
  };
  const std::vector<Ground> grounds = {
      {"noise", [](int c, int r) { return 1e-3F * coarse(c, r); }},
      {"all zeros of both signs", [](int c, int r) { return hashOf(c, r) % 2 == 0 ? 0.0F : -0.0F; }},
      {"zeros among heights", [](int c, int r) { return hashOf(c, r) % 3 == 0 ? 0.0F : coarse(c, r); }},
      {"one sample that needs a second lane",
       [](int c, int r) { return c == 100 && r == 90 ? 3e-6F : coarse(c, r); }},
      {"one sample that no two lanes hold",
       [](int c, int r) { return c == 100 && r == 90 ? 1e-38F : coarse(c, r); }},
      {"a large one beyond the windows", [](int c, int r) { return c == 58 ? 1e30F : coarse(c, r); }},
      // The tile in the middle has the columns 64 to 127.
      {"large ones left of it in windows of 3", largeAt(63, 3)},
      {"large ones right of it in windows of 3", largeAt(128, 3)},
      {"large ones left of it in windows of 5", largeAt(62, 5)},
      {"large ones right of it in windows of 5", largeAt(129, 5)},
      {"denormals", [](int c, int r) { return static_cast<float>(hashOf(c, r) % 1000) * 1e-45F - 3e-43F; }},
      {"denormals among the smallest normal ones",
       [](int c, int r) {
         return (hashOf(c, r) % 7 == 0 ? 1e-45F : 1e-38F) * static_cast<float>(c + r % 9);
       }},
      {"the largest floats", [](int c, int r) { return hashOf(c, r) % 2 == 0 ? kMost : -kMost; }},
      {"a constant", [](int, int) { return -0.1F; }},
  };
  for (const Ground& ground : grounds) {
    const PlainField plain = formed(3 * kTileSide + 8, 3 * kTileSide + 8, ground.z);
    for (const auto& [kind, windows] : {std::pair{FilterKind::kBox, std::vector{3, 5, 7}},
                                        std::pair{FilterKind::kGaussian, std::vector{3, 5, 7}},
                                        std::pair{FilterKind::kMedian, std::vector{3, 5}}})
      for (const int window : windows) {
        SCOPED_TRACE(std::string(ground.name) + " " + std::string(name(kind)));
        expectPlainBits(plain, makeSpec(kind, window), {64, 0});
      }
  }
}

// A tile is taken by itself only where neither a border nor a hole is near: those between two holes, too.
TEST(FastPaths, OverTilesBetweenHolesHaveThePlainBits) {
  PlainField plain = formed(6 * kTileSide, 5 * kTileSide, coarse);
  for (const auto& [c, r] : {std::pair{70, 70}, {5 * kTileSide, 4 * kTileSide - 1}, {200, 191}, {255, 192}})
    plain.at(c, r) = kHole;
  for (const FilterKind kind : {FilterKind::kBox, FilterKind::kGaussian, FilterKind::kMedian})
    for (const int window : {3, 5}) {
      SCOPED_TRACE(std::string(name(kind)));
      expectPlainBits(plain, makeSpec(kind, window), {0, 64, 128, 1024});
    }
}

// Nine times eight tiles: what is asked for ahead of the last rows of tiles that are taken by themselves lies in the field.
TEST(FastPaths, UpToTheLastTilesHaveThePlainBits) {
  const PlainField plain = formed(9 * kTileSide, 8 * kTileSide, coarse);
  for (const FilterKind kind : {FilterKind::kBox, FilterKind::kGaussian, FilterKind::kMedian}) {
    SCOPED_TRACE(std::string(name(kind)));
    expectPlainBits(plain, makeSpec(kind, 3), {0});
  }
}

}  // namespace
}  // namespace fettle::engine::tests
