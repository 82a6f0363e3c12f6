// Form across the lines that stays while they are levelled.
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/measure/levelled_lines.h"
#include "engine/measure/line_offsets.h"
#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

constexpr int kScanLines = 131, kAlongLine = 150;

LineOffsets lineOffsetsOf(const Version& field, const LineOptions& options) {
  JobControl job;
  auto found = findLineOffsets(field, options, job);
  EXPECT_TRUE(found) << found.error().line();
  return found ? *std::move(found) : LineOffsets{};
}

Version levelledByLines(const Version& field, const LineOptions& options) {
  JobControl job;
  return *levelledLines(field, lineOffsetsOf(field, options), allTiles(field.grid()), job);
}

std::vector<double> stripesOf(double size) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal(0.0, size);
  std::vector<double> all(kScanLines);
  for (double& each : all) each = normal(random);
  return all;
}

// Features of less than half of a line, the same on all of them.
double gratingAt(int place) {
  return place % 30 < 12 ? 4.0 : 0.0;
}

// A cubic over the lines.
double formAt(int line) {
  const double x = 2.0 * line / (kScanLines - 1) - 1.0;
  return 20.0 * x * x * x - 15.0 * x * x + 5.0 * x;
}

double rmsOverLines(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double v : values) sum += v;
  const double mean = sum / static_cast<double>(values.size());
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

// How far the lines of a levelled field are off grating and form.
std::vector<double> lineErrorsOf(const Version& field, ScanAxis axis, double (*form)(int)) {
  std::vector<double> off;
  for (int line = 0; line < kScanLines; ++line) {
    const float z =
        axis == ScanAxis::kX ? field.reader().heightAt(70, line) : field.reader().heightAt(line, 70);
    off.push_back(z - gratingAt(70) - form(line));
  }
  return off;
}

constexpr LineMethod kLineMethods[] = {LineMethod::kMedian, LineMethod::kPolynomial, LineMethod::kDifference,
                                       LineMethod::kMatching};

// Of stripes with a standard deviation of 1 their part in the four polynomials to degree 3 stays: chi-squared of four, which is
// above 18.5 once in a thousand, over 131 lines.
TEST(LineForm, StaysWhileStripesGo) {
  const double most = std::sqrt(18.5 / kScanLines);
  const std::vector<double> off = stripesOf(1.0);
  for (const ScanAxis axis : {ScanAxis::kX, ScanAxis::kY}) {
    const auto height = [&](int line, int place) {
      return gratingAt(place) + formAt(line) + off[static_cast<std::size_t>(line)];
    };
    const Version field = axis == ScanAxis::kX
                              ? fieldOf(kAlongLine, kScanLines, [&](int c, int r) { return height(r, c); })
                              : fieldOf(kScanLines, kAlongLine, [&](int c, int r) { return height(c, r); });
    for (const LineMethod method : kLineMethods) {
      const LineOptions with{.method = method, .axis = axis, .form_degree = 3};
      EXPECT_LT(rmsOverLines(lineErrorsOf(levelledByLines(field, with), axis, formAt)), most)
          << static_cast<int>(method);
      EXPECT_NEAR(
          lineOffsetsOf(field, with).form_rms,
          [&] {
            std::vector<double> form;
            for (int l = 0; l < kScanLines; ++l) form.push_back(formAt(l));
            return rmsOverLines(form);
          }(),
          most);
      // Without, nothing of the form is left.
      const LineOptions without{.method = method, .axis = axis};
      EXPECT_GT(rmsOverLines(lineErrorsOf(levelledByLines(field, without), axis, formAt)), 5.0);
      EXPECT_EQ(lineOffsetsOf(field, without).form_rms, 0.0);
    }
  }
}

// Legendre's polynomials from degree 6 on have 2.6 % of cos(pi x).
TEST(LineForm, OfAWaveAsLongAsTheFieldThreePercentGo) {
  const auto wave = [](int line) {
    return 10.0 * std::cos(std::numbers::pi * (2.0 * line / (kScanLines - 1) - 1.0));
  };
  const Version field = fieldOf(kAlongLine, kScanLines, [&](int, int r) { return wave(r); });
  const LineOffsets taken = lineOffsetsOf(field, {.form_degree = LineOptions::kUsualFormDegree});
  EXPECT_LT(taken.rms, 0.03 * 10.0 / std::sqrt(2.0));
  EXPECT_GT(taken.rms, 0.02 * 10.0 / std::sqrt(2.0));
}

// Slopes and bends that all lines have stay, too: what goes is what differs from line to line.
TEST(LineForm, OfPolynomialsAlongTheLinesStaysWhatLinesHaveInCommon) {
  const std::vector<double> slopes = stripesOf(0.2);
  const Version field = fieldOf(kAlongLine, kScanLines, [&](int c, int r) {
    const double u = 2.0 * c / (kAlongLine - 1) - 1.0;
    return (3.0 + slopes[static_cast<std::size_t>(r)]) * u + 2.0 * u * u;
  });
  const LineOffsets with =
      lineOffsetsOf(field, {.method = LineMethod::kPolynomial, .degree = 2, .form_degree = 0});
  const LineOffsets without = lineOffsetsOf(field, {.method = LineMethod::kPolynomial, .degree = 2});
  for (const std::size_t term : {1U, 2U}) {
    double mean = 0.0, all = 0.0;
    for (std::size_t l = 0; l < kScanLines; ++l) {
      mean += with.coefficients[3 * l + term] / kScanLines;
      all += without.coefficients[3 * l + term] / kScanLines;
    }
    EXPECT_NEAR(mean, 0.0, 1e-9);
    EXPECT_GT(all, 1.0);
  }
}

// Steps by the median of noisy differences add up to a walk; of a walk six polynomials have nine tenths.
TEST(LineForm, ErrorsThatAddUpLoseTheirSlowPart) {
  double with = 0.0, without = 0.0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0.0, 0.5);
    const Version field =
        fieldOf(kAlongLine, kScanLines, [&](int c, int) { return gratingAt(c) + normal(random); });
    without += std::pow(lineOffsetsOf(field, {.method = LineMethod::kDifference}).rms, 2);
    with += std::pow(lineOffsetsOf(field, {.method = LineMethod::kDifference, .form_degree = 5}).rms, 2);
  }
  EXPECT_LT(with, 0.25 * without);
}

// A line of which nothing counts is levelled between its neighbours, and not by the bend of the form.
TEST(LineForm, LinesThatDoNotCountKeepItToo) {
  const auto counts = [](int r) { return r % 10 < 7; };
  const Version field = fieldOf(
      kAlongLine, kScanLines, [&](int c, int r) { return gratingAt(c) + formAt(r); },
      [&](int, int r) { return counts(r); });
  const Version level = levelledByLines(field, {.region = Region::kMarked, .form_degree = 3});
  for (int r = 0; r < kScanLines; ++r)
    EXPECT_NEAR(level.reader().heightAt(70, r), field.reader().heightAt(70, r), 1e-4) << r;
}

TEST(LineForm, OfFewLinesIsTheirMean) {
  const Version three = fieldOf(20, 3, [](int, int r) { return 2.0 * r; });
  const LineOffsets with = lineOffsetsOf(three, {.form_degree = 9}), without = lineOffsetsOf(three, {});
  for (std::size_t l = 0; l < 3; ++l) EXPECT_NEAR(with.coefficients[l], without.coefficients[l], 1e-12);
  const Version one =
      fieldOf(20, 1, [](int c, int) { return c == 3 ? std::numeric_limits<double>::quiet_NaN() : 7.0; });
  EXPECT_EQ(lineOffsetsOf(one, {.form_degree = 5}).coefficients, std::vector<double>{0.0});
  JobControl job;
  for (const int degree : {-1, LineOptions::kMostFormDegree + 1}) {
    const auto refused = findLineOffsets(three, {.form_degree = degree}, job);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
  }
}

}  // namespace
}  // namespace fettle::engine
