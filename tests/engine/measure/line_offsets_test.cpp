#include "engine/measure/line_offsets.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/field/builder.h"
#include "engine/measure/lowered.h"
#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr int kWide = 150, kHigh = 131;

LineOffsets offsetsOf(const Version& field, const LineOptions& options) {
  JobControl job;
  auto found = findLineOffsets(field, options, job);
  EXPECT_TRUE(found) << found.error().line();
  return found ? *std::move(found) : LineOffsets{};
}

// Offsets of a scanner's lines, of mean 0.
std::vector<double> randomOffsets(int lines, double size) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal(0.0, size);
  std::vector<double> offsets(static_cast<std::size_t>(lines));
  double mean = 0.0;
  for (double& o : offsets) mean += o = normal(random);
  for (double& o : offsets) o -= mean / lines;
  return offsets;
}

double worstOffset(const LineOffsets& found, const std::vector<double>& offsets) {
  double most = 0.0;
  for (std::size_t l = 0; l < offsets.size(); ++l)
    most = std::max(
        most, std::abs(found.coefficients[l * (static_cast<std::size_t>(found.degree) + 1)] - offsets[l]));
  return most;
}

// A grating along the lines, the same in all of them, with a step that fills less than half of a line.
double grating(int c) {
  return c % 30 < 12 ? 4.0 : 0.0;
}

constexpr LineMethod kAllMethods[] = {LineMethod::kMedian, LineMethod::kPolynomial, LineMethod::kDifference,
                                      LineMethod::kMatching};

TEST(LineOffsets, OfAGratingAreFoundByEveryMethodAlongBothAxes) {
  for (const LineMethod method : kAllMethods) {
    const std::vector<double> rows = randomOffsets(kHigh, 1.0), columns = randomOffsets(kWide, 1.0);
    const Version x =
        fieldOf(kWide, kHigh, [&](int c, int r) { return grating(c) + rows[static_cast<std::size_t>(r)]; });
    EXPECT_LT(worstOffset(offsetsOf(x, {method, 0, ScanAxis::kX}), rows), 2e-6) << static_cast<int>(method);
    const Version y = fieldOf(
        kWide, kHigh, [&](int c, int r) { return grating(r) + columns[static_cast<std::size_t>(c)]; });
    EXPECT_LT(worstOffset(offsetsOf(y, {method, 0, ScanAxis::kY}), columns), 2e-6)
        << static_cast<int>(method);
  }
}

// A block that covers two fifths of some lines: what the mean follows and the others do not.
TEST(LineOffsets, KeepAFeatureOfSomeLines) {
  const std::vector<double> offsets = randomOffsets(kHigh, 1.0);
  const auto block = [](int c, int r) { return r >= 20 && r < 60 && c < 60; };
  const Version field = fieldOf(
      kWide, kHigh,
      [&](int c, int r) { return (block(c, r) ? 50.0 : 0.0) + offsets[static_cast<std::size_t>(r)]; }, block);
  const auto error = [&](LineMethod method, Region region) {
    return worstOffset(offsetsOf(field, {method, 0, ScanAxis::kX, region}), offsets);
  };
  EXPECT_GT(error(LineMethod::kPolynomial, Region::kAll), 10.0);
  for (const LineMethod method : {LineMethod::kMedian, LineMethod::kDifference, LineMethod::kMatching})
    EXPECT_LT(error(method, Region::kAll), 1e-5) << static_cast<int>(method);
  // Marked, the block does not count for any.
  for (const LineMethod method : kAllMethods)
    EXPECT_LT(error(method, Region::kUnmarked), 1e-5) << static_cast<int>(method);
}

// Features of six tenths of all lines at changing places: medians of lines go up and down with them, differences do not.
TEST(LineOffsets, DifferencesCrossFeaturesThatFillLines) {
  const std::vector<double> offsets = randomOffsets(kHigh, 1.0);
  const Version field = fieldOf(kWide, kHigh, [&](int c, int r) {
    return (c < 45 + r / 2 ? 50.0 : 0.0) + offsets[static_cast<std::size_t>(r)];
  });
  EXPECT_GT(worstOffset(offsetsOf(field, {LineMethod::kMedian}), offsets), 10.0);
  EXPECT_LT(worstOffset(offsetsOf(field, {LineMethod::kDifference}), offsets), 1e-4);
  EXPECT_LT(worstOffset(offsetsOf(field, {LineMethod::kMatching}), offsets), 1e-4);
}

// The median of Gaussian noise has an efficiency of 2 / pi, the weighted mean nearly 1; steps add up over 131 lines.
TEST(LineOffsets, MatchingIsNearerThanTheMedianOfDifferences) {
  const std::vector<double> offsets = randomOffsets(kHigh, 1.0);
  double by_median = 0.0, by_matching = 0.0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0.0, 0.2);
    const Version field = fieldOf(kWide, kHigh, [&](int c, int r) {
      return grating(c) + offsets[static_cast<std::size_t>(r)] + normal(random);
    });
    const auto square = [&](LineMethod method) {
      const LineOffsets found = offsetsOf(field, {method});
      double sum = 0.0;
      for (std::size_t l = 1; l < offsets.size(); ++l)
        sum += std::pow(found.coefficients[l] - found.coefficients[l - 1] - offsets[l] + offsets[l - 1], 2);
      return sum;
    };
    by_median += square(LineMethod::kDifference);
    by_matching += square(LineMethod::kMatching);
  }
  const double ratio = std::sqrt(by_matching / by_median);
  EXPECT_LT(ratio, 0.9);
  EXPECT_GT(ratio, 0.75);
  // The mean of 150 differences of noise of 0.2.
  EXPECT_NEAR(std::sqrt(by_matching / (20 * 130)), 0.2 * std::sqrt(2.0 / 150.0), 0.004);
}

// Weights depend on ratios alone: heights 2^30 times smaller have offsets 2^30 times smaller, bit for bit.
TEST(LineOffsets, AreTheSameInAnyUnit) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 0.3);
  const std::vector<double> offsets = randomOffsets(kHigh, 1.0);
  std::vector<float> z;
  for (int r = 0; r < kHigh; ++r)
    for (int c = 0; c < kWide; ++c)
      z.push_back(static_cast<float>(grating(c) * (1.0 + 0.01 * r) + offsets[static_cast<std::size_t>(r)] +
                                     normal(random)));
  const auto inUnit = [&](double unit) {
    return fieldOf(kWide, kHigh, [&](int c, int r) {
      return unit * static_cast<double>(z[static_cast<std::size_t>(r * kWide + c)]);
    });
  };
  for (const LineMethod method : kAllMethods) {
    const LineOffsets one = offsetsOf(inUnit(1.0), {method}), other = offsetsOf(inUnit(0x1p-30), {method});
    ASSERT_EQ(one.coefficients.size(), other.coefficients.size());
    for (std::size_t k = 0; k < one.coefficients.size(); ++k)
      ASSERT_EQ(one.coefficients[k], 0x1p30 * other.coefficients[k]) << static_cast<int>(method) << ' ' << k;
  }
}

TEST(LineOffsets, APolynomialIsThatOfTheSamplesInLongDouble) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> noise(static_cast<std::size_t>(kWide * 7));
  for (double& z : noise) z = normal(random);
  const Version field = fieldOf(kWide, 7, [&](int c, int r) {
    return (c * 5 + r) % 9 == 0 ? double{kNone}
                                : 5e6 + 0.01 * c * r + noise[static_cast<std::size_t>(r * kWide + c)];
  });
  const LineOffsets found = offsetsOf(field, {LineMethod::kPolynomial, 1});
  std::vector<long double> constants, slopes;
  long double mean = 0;
  for (int r = 0; r < 7; ++r) {
    long double n = 0, x = 0, z = 0, xx = 0, xz = 0;
    for (int pass = 0; pass < 2; ++pass)
      for (int c = 0; c < kWide; ++c) {
        const float h = field.reader().heightAt(c, r);
        if (std::isnan(h)) continue;
        const long double u = 2.0L * c / (kWide - 1) - 1.0L;
        if (pass == 0) {
          n += 1, x += u, z += h;
        } else {
          xx += (u - x / n) * (u - x / n), xz += (u - x / n) * (h - z / n);
        }
      }
    slopes.push_back(xz / xx);
    constants.push_back(z / n - xz / xx * x / n);
    mean += constants.back() / 7;
  }
  for (std::size_t r = 0; r < 7; ++r) {
    EXPECT_NEAR(found.coefficients[2 * r], static_cast<double>(constants[r] - mean), 1e-8);
    EXPECT_NEAR(found.coefficients[2 * r + 1], static_cast<double>(slopes[r]), 1e-9);
  }
}

TEST(LineOffsets, ARobustPolynomialIgnoresAStepOverTwoFifthsOfALine) {
  // Bow and tilt of a line scanner, other ones on each line, under a step of 30.
  const auto bow = [](int c, int r) {
    const double u = 2.0 * c / (kWide - 1) - 1.0;
    return 0.1 * r + (0.5 + 0.01 * r) * u + 0.3 * u * u;
  };
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 0.01);
  const auto height = [&](int c, int r) { return bow(c, r) + (c > 89 ? 30.0 : 0.0) + normal(random); };
  const Version field = fieldOf(kWide, 40, height);
  JobControl job;
  const auto error = [&](bool robust) {
    const LineOffsets found =
        offsetsOf(field, {LineMethod::kPolynomial, 2, ScanAxis::kX, Region::kAll, robust});
    const auto level = lowered(
        field, "", [&](const SampleRect& rect, double* out) { found.readHeights(rect, out); }, job);
    const float first = level->reader().heightAt(0, 0);
    double most = 0.0;
    for (int r = 0; r < 40; ++r)
      for (int c = 0; c < 90; ++c)
        most = std::max(most, std::abs(double{level->reader().heightAt(c, r)} - first));
    return most;
  };
  EXPECT_LT(error(true), 0.1);  // some ten times the noise
  EXPECT_GT(error(false), 3.0);
}

TEST(LineOffsets, WhatIsTakenIsWhatTheCoefficientsSay) {
  const Version field = fieldOf(kWide, kHigh, [](int c, int r) { return std::sin(0.1 * c * r) + 0.1 * r; });
  for (const ScanAxis axis : {ScanAxis::kX, ScanAxis::kY}) {
    const LineOffsets found = offsetsOf(field, {LineMethod::kPolynomial, 3, axis});
    std::vector<double> out(kTileSamples);
    found.readHeights({64, 64, 64, 64}, out.data());
    for (int r = 0; r < 64; ++r)
      for (int c = 0; c < 64; ++c) {
        const int line = axis == ScanAxis::kX ? 64 + r : 64 + c,
                  place = axis == ScanAxis::kX ? 64 + c : 64 + r;
        const double u = 2.0 * place / (found.length - 1) - 1.0;
        const double* k = found.coefficients.data() + 4 * line;
        ASSERT_NEAR(
            out[static_cast<std::size_t>(r * kTileSide + c)],
            k[0] + k[1] * std::legendre(1, u) + k[2] * std::legendre(2, u) + k[3] * std::legendre(3, u),
            1e-14);
      }
  }
}

TEST(LineOffsets, LinesWithoutSamplesLieBetweenTheirNeighbours) {
  for (const LineMethod method : kAllMethods) {
    // Lines 0, 4 to 6 and the last have no sample; the others stand at their number.
    const Version field = fieldOf(80, 12, [](int, int r) {
      return r == 0 || (r >= 4 && r <= 6) || r == 11 ? double{kNone} : static_cast<double>(r);
    });
    const LineOffsets found = offsetsOf(field, {method});
    EXPECT_EQ(found.empty, 5);
    for (std::size_t r = 2; r <= 10; ++r)
      EXPECT_NEAR(found.coefficients[r] - found.coefficients[r - 1], 1.0, 1e-12) << r;
    EXPECT_EQ(found.coefficients[0], found.coefficients[1]);
    EXPECT_EQ(found.coefficients[11], found.coefficients[10]);
  }
}

TEST(LineOffsets, BetweenLinesWithoutACommonPlaceThereIsNoStep) {
  // Samples on the left half of even lines and on the right half of odd ones.
  const Version field =
      fieldOf(80, 12, [](int c, int r) { return (c < 40) == (r % 2 == 0) ? 3.0 + r : double{kNone}; });
  for (const LineMethod method : {LineMethod::kDifference, LineMethod::kMatching})
    for (const double k : offsetsOf(field, {method}).coefficients) EXPECT_EQ(k, 0.0);
}

TEST(LineOffsets, OfHardFieldsAreFiniteOrRefused) {
  JobControl job;
  const std::function<double(int, int)> fields[] = {
      [](int, int) { return 0.0; },
      [](int c, int r) { return (c + r) % 7 == 0 ? 1e6 : 0.0; },
      [](int c, int r) { return c == r ? 0.1 : double{kNone}; },
      [](int c, int) { return 5e6 + 0.5 * c; },
      [](int c, int r) { return 1e-42 * (c * 3 + r); },
  };
  for (const auto& z : fields)
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {40, 1}, {3, 2}, {70, 66}})
      for (const LineMethod method : kAllMethods)
        for (const bool robust : {false, true})
          for (const ScanAxis axis : {ScanAxis::kX, ScanAxis::kY}) {
            const LineOffsets found =
                offsetsOf(fieldOf(width, height, z), {method, 3, axis, Region::kAll, robust});
            for (const double k : found.coefficients)
              ASSERT_TRUE(std::isfinite(k)) << width << " x " << height;
            ASSERT_TRUE(std::isfinite(found.rms));
          }
  const Version holes = fieldOf(70, 66, [](int, int) { return double{kNone}; });
  for (const LineMethod method : kAllMethods) {
    const auto found = findLineOffsets(holes, {method}, job);
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().kind, ErrorKind::kInput);
  }
  EXPECT_FALSE(findLineOffsets(fieldOf(9, 9, fields[0]), {LineMethod::kPolynomial, 4}, job));
  job.cancel();
  const auto cut = findLineOffsets(fieldOf(9, 9, fields[0]), {}, job);
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().kind, ErrorKind::kCancelled);
}

TEST(LineOffsets, AreTheSameForAnyNumberOfThreads) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  const Version field = fieldOf(200, 300, [&](int, int) { return normal(random); });
  for (const LineMethod method : kAllMethods) {
    LineOffsets one;
    tbb::task_arena(1).execute([&] {
      one = offsetsOf(field, {method, 2, ScanAxis::kX, Region::kAll, true});
    });
    const LineOffsets many = offsetsOf(field, {method, 2, ScanAxis::kX, Region::kAll, true});
    EXPECT_EQ(one.coefficients, many.coefficients);
  }
}

}  // namespace
}  // namespace fettle::engine
