#include "engine/scanner/laser_effects.h"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

constexpr LaserModel kModel;
constexpr double kInf = std::numeric_limits<double>::infinity();

// A block at (column, row) whose truth is f(x, y) of its place in the field [mm].
ScanBlock blockOf(int column, int row, double spacing, const std::function<double(double, double)>& f,
                  int columns = 64, int rows = 64) {
  ScanBlock b;
  b.column = column;
  b.row = row;
  b.columns = columns;
  b.rows = rows;
  b.spacing_mm = spacing;
  b.truth.fill(std::numeric_limits<float>::quiet_NaN());
  for (int r = -1; r <= rows; ++r)
    for (int c = -1; c <= columns; ++c)
      b.truth[static_cast<std::size_t>((r + 1) * ScanBlock::kStride + c + 1)] =
          static_cast<float>(f((column + c) * spacing, (row + r) * spacing));
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) b.heightAt(c, r) = b.truthAt(c, r);
  return b;
}

double flat(double, double) {
  return 0.0;
}

struct Moments {
  double n = 0.0, sum = 0.0, square = 0.0, next = 0.0, pairs = 0.0;
  void add(const ScanBlock& b, double level) {
    ScanBlock copy = b;
    for (int r = 0; r < b.rows; ++r)
      for (int c = 0; c < b.columns; ++c) {
        const double e = copy.heightAt(c, r) - level;
        n += 1.0;
        sum += e;
        square += e * e;
        if (c + 1 < b.columns) next += e * (copy.heightAt(c + 1, r) - level), pairs += 1.0;
      }
  }
  [[nodiscard]] double variance() const { return square / n; }
};

// Bounds at significance 1e-4 (3.89 standard deviations): the mean square of n normals with mean 0 has
// standard deviation sigma^2 sqrt(2 / n), times sqrt(sum of squared correlations) when they are correlated.
constexpr double kDeviations = 3.89;

TEST(SensorNoise, HasTheSigmaOfItsDepth) {
  for (const double level : {0.0, 20.0, -30.0}) {
    Moments m;
    for (int k = 0; k < 16; ++k) {
      ScanBlock b = blockOf(64 * k, 0, 0.1, [&](double, double) { return level; });
      addSensorNoise(b, kModel, 1.5, CounterRandom(1, 2));
      m.add(b, level);
    }
    const double sigma = 1.5 * kModel.sigma_mm * std::pow((150.0 - level) / 150.0, 2);
    EXPECT_NEAR(m.variance() / (sigma * sigma), 1.0, kDeviations * std::sqrt(2.0 / m.n)) << level;
    EXPECT_NEAR(m.sum / m.n, 0.0, kDeviations * sigma / std::sqrt(m.n));
    EXPECT_NEAR(m.next / m.pairs, 0.0, kDeviations * sigma * sigma / std::sqrt(m.pairs));
  }
}

TEST(Speckle, HasItsVarianceAndTheKernelsCorrelationAlongTheLineOnly) {
  const double spacing = 0.05;
  const std::vector<double> kernel = speckleKernel(kModel, spacing);
  ASSERT_GT(kernel.size(), 3U);
  double power = 0.0;
  double one_apart = 0.0;
  for (std::size_t k = 0; k < kernel.size(); ++k) power += kernel[k] * kernel[k];
  for (std::size_t k = 1; k < kernel.size(); ++k) one_apart += kernel[k] * kernel[k - 1];
  EXPECT_NEAR(power, 1.0, 1e-12);
  double squared = 0.0;  // sum of the squared correlations over all lags
  for (std::size_t lag = 0; lag < kernel.size(); ++lag) {
    double rho = 0.0;
    for (std::size_t k = lag; k < kernel.size(); ++k) rho += kernel[k] * kernel[k - lag];
    squared += (lag == 0 ? 1.0 : 2.0) * rho * rho;
  }
  Moments m;
  double across = 0.0;
  for (int k = 0; k < 16; ++k) {
    ScanBlock b = blockOf(64 * k, 0, spacing, flat);
    addSpeckle(b, kModel, 1.0, kernel, CounterRandom(3, 4));
    m.add(b, 0.0);
    for (int r = 1; r < 64; ++r)
      for (int c = 0; c < 64; ++c) across += b.heightAt(c, r) * b.heightAt(c, r - 1);
  }
  const double variance = std::pow(kModel.sigma_mm * kModel.speckle_ratio, 2);
  const double bound = kDeviations * std::sqrt(2.0 * squared / m.n);
  EXPECT_NEAR(m.variance() / variance, 1.0, bound);
  EXPECT_NEAR(m.next / m.pairs / variance, one_apart, bound);
  EXPECT_GT(one_apart, 0.5);
  EXPECT_NEAR(across / m.n / variance, 0.0, bound);
}

TEST(Speckle, JoinsWithoutASeamAcrossBlocks) {
  // One block of 64 and two of 32 over the same samples give the same numbers.
  const auto kernel = speckleKernel(kModel, 0.05);
  const CounterRandom random(3, 4);
  ScanBlock whole = blockOf(128, 64, 0.05, flat);
  ScanBlock left = blockOf(128, 64, 0.05, flat, 32, 64);
  ScanBlock right = blockOf(160, 64, 0.05, flat, 32, 64);
  for (ScanBlock* b : {&whole, &left, &right}) addSpeckle(*b, kModel, 1.0, kernel, random);
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 64; ++c)
      EXPECT_EQ(whole.heightAt(c, r), c < 32 ? left.heightAt(c, r) : right.heightAt(c - 32, r));
}

TEST(Speckle, OnACoarseGridIsWhiteNoise) {
  EXPECT_EQ(speckleKernel(kModel, 1.0), std::vector<double>{1.0});
}

TEST(LineOffset, IsOneNumberALineWithItsVarianceOverLines) {
  double square = 0.0;
  int lines = 0;
  for (int k = 0; k < 64; ++k) {
    ScanBlock b = blockOf(64 * (k % 3), 64 * k, 0.1, flat);
    addLineOffset(b, kModel, 1.0, CounterRandom(1, 5));
    for (int r = 0; r < 64; ++r, ++lines) {
      for (int c = 1; c < 64; ++c) ASSERT_EQ(b.heightAt(c, r), b.heightAt(0, r));
      square += b.heightAt(0, r) * b.heightAt(0, r);
    }
  }
  const double variance = std::pow(kModel.sigma_mm * kModel.line_ratio, 2);
  EXPECT_NEAR(square / lines / variance, 1.0, kDeviations * std::sqrt(2.0 / lines));
}

TEST(Quantise, GivesWholeCountsHalfACountAwayAtMost) {
  ScanBlock b = blockOf(0, 0, 0.1, [](double x, double y) { return 3.0 * x - 1.7 * y; });
  const ScanBlock before = b;
  quantise(b, kModel, 2.0);
  const double count = 2.0 * kModel.sigma_mm * kModel.count_ratio;
  for (std::size_t i = 0; i < b.height.size(); ++i) {
    EXPECT_EQ(b.height[i], std::round(b.height[i] / count) * count);
    EXPECT_LE(std::abs(b.height[i] - before.height[i]), 0.5 * count * (1.0 + 1e-12));
  }
}

TEST(MixedPixels, AppearBesideStepsOnlyInTheirShareAndBetweenTheLevels) {
  double next_to_step = 0.0;
  double mixed = 0.0;
  double sum = 0.0;
  for (int k = 0; k < 64; ++k) {
    ScanBlock b = blockOf(0, 64 * k, 0.1, [](double x, double) { return x < 3.0 ? 1.0 : 5.0; });
    const ScanBlock before = b;
    mixPixels(b, kModel, 0.3, CounterRandom(9, 1));
    for (int r = 0; r < 64; ++r)
      for (int c = 0; c < 64; ++c) {
        const bool at_step = c == 29 || c == 30;
        const bool changed = b.heightAt(c, r) != ScanBlock(before).heightAt(c, r);
        EXPECT_TRUE(at_step || !changed) << c;
        next_to_step += at_step;
        if (!changed) continue;
        mixed += 1.0;
        sum += b.heightAt(c, r);
        EXPECT_GE(b.heightAt(c, r), 1.0);
        EXPECT_LE(b.heightAt(c, r), 5.0);
      }
  }
  // Binomial and uniform at significance 1e-4.
  EXPECT_NEAR(mixed / next_to_step, 0.3, kDeviations * std::sqrt(0.3 * 0.7 / next_to_step));
  EXPECT_NEAR(sum / mixed, 3.0, kDeviations * 4.0 / std::sqrt(12.0 * mixed));
}

TEST(MixedPixels, LeaveSlopesAndSmallStepsAlone) {
  ScanBlock slope = blockOf(0, 0, 0.1, [](double x, double y) { return 1.7 * x + 1.7 * y; });  // 67 degrees
  ScanBlock small = blockOf(0, 0, 0.01, [](double x, double) { return x < 0.3 ? 0.0 : 0.19; });
  for (ScanBlock* b : {&slope, &small}) {
    const ScanBlock before = *b;
    mixPixels(*b, kModel, 1.0, CounterRandom(9, 1));
    EXPECT_EQ(b->height, before.height);
  }
}

TEST(SteepDropouts, GrowWithTheSquareOfTheAngleAndSpareTheLandBesideAWall) {
  const auto lost = [](double degrees, double scale) {
    double holes = 0.0;
    const double slope = std::tan(degrees * std::numbers::pi / 180.0);
    for (int k = 0; k < 4; ++k) {
      ScanBlock b = blockOf(64 * k, 0, 0.1, [&](double x, double) { return slope * x; });
      dropSteep(b, kModel, scale, CounterRandom(2, 5));
      for (const double z : b.height) holes += std::isnan(z);
    }
    return holes / (4.0 * 64.0 * 64.0);
  };
  const double n = 4.0 * 64.0 * 64.0;
  EXPECT_EQ(lost(0, 10), 0.0);
  EXPECT_EQ(lost(44.9, 10), 0.0);
  EXPECT_NEAR(lost(62.5, 1), 0.25, kDeviations * std::sqrt(0.25 * 0.75 / n) + 1e-4);
  EXPECT_NEAR(lost(62.5, 2), 0.5, kDeviations * std::sqrt(0.5 * 0.5 / n) + 2e-4);
  EXPECT_EQ(lost(81, 1), 1.0);
  ScanBlock wall = blockOf(0, 0, 0.1, [](double x, double) { return x < 3.0 ? 0.0 : 9.0; });
  dropSteep(wall, kModel, 10, CounterRandom(2, 5));
  for (const double z : wall.height) EXPECT_FALSE(std::isnan(z));
}

// The march along each camera ray, as the definition says.
bool hidden(const std::vector<double>& column, std::size_t row, double spacing) {
  for (std::size_t ahead = row + 1; ahead < column.size(); ++ahead) {
    const double t = static_cast<double>(ahead - row) * spacing;
    if (column[ahead] > column[row] + t / kModel.camera_tangent + 1e-4) return true;
  }
  return false;
}

TEST(Shadow, EqualsTheMarchAlongEveryRayAndCrossesBlocks) {
  const double spacing = 0.1;
  const auto surface = [](double x, double y) {
    return 3.0 * std::sin(1.3 * y + x) * std::cos(0.4 * y) + (std::fmod(y, 4.0) > 3.0 ? 2.0 + x : 0.0);
  };
  std::vector<double> horizon(64, -kInf);
  std::vector<ScanBlock> blocks;
  for (int k = 2; k >= 0; --k) {
    blocks.push_back(blockOf(0, 64 * k, spacing, surface));
    dropShadowed(blocks.back(), kModel, horizon);
  }
  int holes = 0;
  for (int c = 0; c < 64; ++c) {
    std::vector<double> column;
    for (int r = 0; r < 192; ++r)
      column.push_back(static_cast<double>(static_cast<float>(surface(c * spacing, r * spacing))));
    for (int r = 0; r < 192; ++r) {
      ScanBlock& b = blocks[static_cast<std::size_t>(2 - r / 64)];
      const bool lost = std::isnan(b.heightAt(c, r % 64));
      EXPECT_EQ(lost, hidden(column, static_cast<std::size_t>(r), spacing)) << c << ' ' << r;
      holes += lost;
    }
  }
  EXPECT_GT(holes, 100);
}

TEST(Shadow, OfAStepIsAsLongAsTheStepTimesTheTangentAndLiesBelowIt) {
  const double spacing = 0.05;
  ScanBlock b = blockOf(0, 0, spacing, [](double, double y) { return y < 1.6 - 1e-9 ? 0.0 : 3.0; });
  std::vector<double> horizon(64, -kInf);
  dropShadowed(b, kModel, horizon);
  int holes = 0;
  for (int r = 0; r < 64; ++r) holes += std::isnan(b.heightAt(7, r));
  // Rows strictly nearer than 3 mm * 0.4 = 1.2 mm = 24 rows.
  EXPECT_EQ(holes, 23);
  EXPECT_TRUE(std::isnan(b.heightAt(7, 31)));
  EXPECT_FALSE(std::isnan(b.heightAt(7, 32)));
}

}  // namespace
}  // namespace fettle::engine
