#include "engine/filter/ball_erosion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "engine/filter/ball_near.h"
#include "tests/engine/filter/made_scan.h"

namespace fettle::engine::tests {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

double noiseAt(int c, int r) {
  auto x = static_cast<std::uint64_t>(r) << 32 | static_cast<std::uint32_t>(c);
  x = (x + 0x9e3779b97f4a7c15) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return static_cast<double>((x ^ (x >> 31)) >> 11) * 0x1p-53 - 0.5;
}

bool seldom(int c, int r, int every) {
  return std::fmod(std::fabs(noiseAt(c + 7919, r)) * 1e6, every) < 1.0;
}

// Of a sphere around c0, r0 the height above its lowest or below its top.
double sphereAt(int c, int r, double middle, double spacing, double radius, double beside) {
  const double x = (c - middle) * spacing, y = (r - middle) * spacing, rest = radius * radius - x * x - y * y;
  return rest > 0.0 ? std::sqrt(rest) : beside;
}

std::vector<MadeScan> grounds() {
  const auto waves = [](int c, int r) { return 2.0 * std::cos(0.011 * r) * std::sin(0.013 * c); };
  const auto rough = [=](int c, int r) { return waves(c, r) + 0.3 * noiseAt(c, r); };
  return {
      {"noise, few samples of reach", 83, 61, 0.05, 0.05, 0.35, rough},
      {"noise, a width of no whole block", 131, 99, 0.05, 0.05, 1.4, rough},
      {"noise, many samples of reach", 150, 133, 0.05, 0.05, 2.5, rough, 1.0, 23},
      {"waves", 120, 97, 0.05, 0.05, 2.0, waves, 1.0, 13},
      {"flat", 100, 90, 0.05, 0.05, 2.0, [](int, int) { return 3.0; }, 1.0, 13},
      {"a steep slope", 110, 90, 0.05, 0.05, 2.0,
       [](int c, int r) { return 0.065 * c - 0.11 * r + 0.003 * noiseAt(c, r); }, 1.0, 13},
      {"walls, where the ball touches at its rim", 130, 110, 0.05, 0.05, 1.5,
       [](int c, int r) { return ((c / 45 + r / 50) % 2 != 0 ? 9.0 : 0.0) + 0.01 * noiseAt(c, r); }, 1.0, 13},
      {"a sphere of the ball's radius", 101, 101, 0.05, 0.05, 2.0,
       [](int c, int r) { return sphereAt(c, r, 50, 0.05, 2.0, 0.0); }, 1.0, 13},
      {"a bowl of the ball's radius", 101, 101, 0.05, 0.05, 2.0,
       [](int c, int r) { return 2.0 - sphereAt(c, r, 50, 0.05, 2.0, 0.0); }, 1.0, 13},
      {"a large sphere of the ball's radius", 501, 501, 0.01, 0.01, 2.4,
       [](int c, int r) { return sphereAt(c, r, 250, 0.01, 2.4, 0.0); }, 1.0, 1499},
      {"spikes", 120, 100, 0.05, 0.05, 1.6,
       [](int c, int r) { return seldom(c, r, 900)   ? 1e6
                                 : seldom(c, r, 901) ? -1e6
                                                     : 0.01 * noiseAt(c, r); },
       1.0, 13},
      {"holes", 130, 101, 0.05, 0.05, 1.3,
       [=](int c, int r) {
         return seldom(c, r, 3) || (c / 20 + r / 30) % 3 == 0 ? std::nan("") : rough(c, r);
       },
       1.0, 13},
      {"few samples", 130, 101, 0.05, 0.05, 1.9,
       [=](int c, int r) { return seldom(c, r, 300) ? rough(c, r) : std::nan(""); }, 1.0, 7},
      {"spacing 1:4", 150, 70, 0.05, 0.2, 2.2, rough, 1.0, 13},
      {"micrometres", 90, 80, 0.05, 0.05, 1.7, [=](int c, int r) { return 1e3 * rough(c, r); }, 1e-3, 13},
      {"far away", 90, 80, 0.05, 0.05, 1.7, [=](int c, int r) { return 5e6 + rough(c, r); }, 1.0, 13},
      {"huge", 90, 80, 1.0, 1.0, 30.0, [](int c, int r) { return (c * 7 % 11 - 5) * 6e37 + r; }, 1.0, 13},
      {"denormal", 90, 80, 1.0, 1.0, 30.0, [](int c, int r) { return 1e-42 * (c * 7 % 11 + r % 5); }, 1.0,
       13},
      {"no table, as a row is long", 9000, 60, 0.05, 0.05, 300.0,
       [](int c, int r) { return 250.0 * std::sin(0.002 * c) + noiseAt(c, r); }, 1.0, 9973},
      {"nearly a plane", 90, 80, 1.0, 1.0, 1e17, rough, 1.0, 11},
  };
}

template <class T>
Patch<T> patchOf(const SampleRect& rect, const std::function<T(int, int)>& value) {
  Patch<T> patch;
  patch.resize(rect);
  for (int r = rect.row; r < rect.row + rect.rows; ++r)
    for (int c = rect.column; c < rect.column + rect.columns; ++c)
      patch.row(r)[c - rect.column] = value(c, r);
  return patch;
}

// How many results of every `step`, and around the middle, are not the least over all samples to the bit.
template <class T>
int wrongResults(const BallElement& ball, const Patch<T>& from, const Patch<double>& got, int step) {
  int wrong = 0;
  const SampleRect &all = from.rect, &rect = got.rect;
  const int middle_c = all.column + all.columns / 2, middle_r = all.row + all.rows / 2;
  for (int k = 0; k < rect.columns * rect.rows; ++k) {
    const int c = rect.column + k % rect.columns, r = rect.row + k / rect.columns;
    if (k % step != 0 && (std::abs(c - middle_c) > 2 || std::abs(r - middle_r) > 2)) continue;
    double least = kNone;
    for (int v = all.row; v < all.row + all.rows; ++v)
      for (int u = all.column; u < all.column + all.columns; ++u)
        if (const double depth = ball.depthAt(u - c, v - r); depth < kNone)
          least = std::min(least, static_cast<double>(from.row(v)[u - all.column]) + depth);
    if (!(static_cast<double>(from.row(r)[c - all.column]) < kNone)) least = -kNone;
    wrong += got.row(r)[c - rect.column] != least;
  }
  return wrong;
}

// Under a sanitizer most of the time goes into the search over all samples that results are held against.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kSparser = 4;
#else
constexpr int kSparser = 1;
#endif

class BallErosion : public testing::TestWithParam<CpuLevel> {};

// From heights and once more from what that leaves turned over, where all places from which the ball touches one sample tie.
TEST_P(BallErosion, IsTheLeastOverAllSamplesToTheBit) {
  int near = 0, far = 0, without_table = 0;
  for (const MadeScan& ground : grounds()) {
    const SampleRect all{0, 0, ground.width, ground.height};
    double lowest = kNone, highest = -kNone;
    const auto from = patchOf<float>(all, [&](int c, int r) {
      const auto z = static_cast<float>(ground.z(c, r));
      if (std::isnan(z)) return std::numeric_limits<float>::infinity();
      lowest = std::min(lowest, static_cast<double>(z));
      highest = std::max(highest, static_cast<double>(z));
      return z;
    });
    const BallElement ball(ground.nesting, lowest, highest, gridOf(ground));
    ++(isNear(ball) ? near : far);
    without_table += ball.table() == nullptr;
    BallScratch scratch;
    const JobControl job;
    // Not from the field's first sample on, to the last one.
    const SampleRect rect{5, 3, ground.width - 5, ground.height - 3};
    Patch<double> eroded, again;
    eroded.resize(rect);
    const CpuLevel level = std::min(GetParam(), bestCpuLevel());
    ASSERT_TRUE(erode(ball, from, eroded, false, level, scratch, job));
    EXPECT_EQ(wrongResults(ball, from, eroded, kSparser * ground.step), 0) << ground.name;
    const auto turned = patchOf<double>(rect, [&](int c, int r) { return -eroded.row(r)[c - rect.column]; });
    again.resize({9, 4, ground.width - 19, ground.height - 11});
    ASSERT_TRUE(erode(ball, turned, again, false, level, scratch, job));
    EXPECT_EQ(wrongResults(ball, turned, again, kSparser * ground.step), 0) << ground.name << ", again";
  }
  EXPECT_GT(near, 0);
  EXPECT_GT(far, 10);
  EXPECT_GT(without_table, 0);
}

// Where the ball rests on a slope of that, all samples of the block lie within it.
TEST(BallElement, ItsSteepestSlopeKeepsABlockWithinTheBall) {
  for (const double radius : {0.35, 1.4, 2.5})
    for (const double along_y : {0.05, 0.2}) {
      Grid grid;
      grid.width = grid.height = 200;
      grid.spacing_x = 0.05;
      grid.spacing_y = along_y;
      const BallElement ball(radius, 0.0, 10.0, grid);
      for (std::int32_t side = 1; side <= 16; ++side) {
        const double squared = static_cast<double>(ball.steepest(side)),
                     corner = 0.5 * (side - 1) * std::hypot(0.05, along_y);
        ASSERT_GE(squared, 0.0);
        if (corner < 0.9 * radius) {
          EXPECT_GT(squared, 0.0) << side;
        }
        if (squared > 0.0) {
          EXPECT_LE(radius * std::sqrt(squared / (1.0 + squared)) + corner, radius) << radius << ' ' << side;
        }
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Levels, BallErosion,
                         testing::Values(CpuLevel::kPlain, CpuLevel::kAvx2, CpuLevel::kAvx512));

}  // namespace
}  // namespace fettle::engine::tests
