#include "engine/measure/form.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/field/builder.h"
#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

FormFit fitted(const Version& field, const FormOptions& options) {
  JobControl job;
  auto fit = fitForm(field, options, job);
  EXPECT_TRUE(fit) << fit.error().line();
  return fit ? *std::move(fit) : FormFit{};
}

// Where float heights are exact the form is found to rounding: here a polynomial in thousandths of the field.
double polynomial(int degree, double c, double r) {
  const double x = c / 200.0 - 0.4, y = r / 150.0 - 0.5;
  double sum = 0.0;
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j) sum += (1.0 + 0.3 * i - 0.2 * j) * std::pow(x, i) * std::pow(y, j);
  return sum;
}

TEST(Form, OfEachDegreeIsFound) {
  for (int degree = 0; degree <= PolynomialForm::kMostDegree; ++degree) {
    const Version field = fieldOf(211, 150, [&](int c, int r) { return polynomial(degree, c, r); });
    const FormFit fit = fitted(field, {degree, Region::kAll, false});
    EXPECT_EQ(fit.samples, 211 * 150);
    // Rounded to float: 6e-8 of heights of up to 4, independent.
    EXPECT_LT(fit.rms, 2e-7) << degree;
    for (const auto& [c, r] : {std::pair{0.0, 0.0}, {105.3, 71.9}, {210.0, 149.0}})
      EXPECT_NEAR(fit.form.heightAt(c, r), polynomial(degree, c, r), 2e-8) << degree;
    const double step = 1e-4, column = 105.0, row = 74.5;  // the middle
    const PolynomialForm::Gradient gradient = fit.form.gradient();
    EXPECT_NEAR(
        gradient.by_column,
        (polynomial(degree, column + step, row) - polynomial(degree, column - step, row)) / (2 * step), 1e-8)
        << degree;
    EXPECT_NEAR(
        gradient.by_row,
        (polynomial(degree, column, row + step) - polynomial(degree, column, row - step)) / (2 * step), 1e-8)
        << degree;
  }
}

TEST(Form, OfRowsIsTheFormOfSamples) {
  const Version field = fieldOf(150, 90, [](int c, int r) { return polynomial(5, c, r); });
  const FormFit fit = fitted(field, {5, Region::kAll, false});
  std::vector<double> heights(70 * 65);
  fit.form.readHeights({80, 20, 65, 70}, heights.data(), 65);
  for (int r = 0; r < 70; ++r)
    for (int c = 0; c < 65; ++c)
      ASSERT_NEAR(heights[static_cast<std::size_t>(r * 65 + c)], fit.form.heightAt(80 + c, 20 + r), 1e-13);
}

// The plane by the textbook's equations in long double, over samples with holes and marks.
TEST(Form, OfARegionIsThatOfItsSamples) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::vector<double> noise(130 * 97);
  for (double& z : noise) z = normal(random);
  const auto height = [&](int c, int r) {
    return (c * 7 + r * 13) % 11 == 0
               ? double{kHole}
               : 500.0 + 0.3 * c - 0.2 * r + noise[static_cast<std::size_t>(r * 130 + c)];
  };
  const auto marked = [](int c, int r) { return c > 40 && (r + c) % 3 != 0; };
  const Version field = fieldOf(130, 97, height, marked);
  for (const Region region : {Region::kAll, Region::kMarked, Region::kUnmarked}) {
    long double n = 0, x = 0, y = 0, z = 0;
    const auto each = [&](auto&& f) {
      for (int r = 0; r < 97; ++r)
        for (int c = 0; c < 130; ++c) {
          const long double h = static_cast<float>(height(c, r));
          if (std::isnan(h) || (region != Region::kAll && marked(c, r) != (region == Region::kMarked)))
            continue;
          f(c, r, h);
        }
    };
    each([&](long double c, long double r, long double h) { n += 1, x += c, y += r, z += h; });
    x /= n, y /= n, z /= n;
    long double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
    each([&](long double c, long double r, long double h) {
      xx += (c - x) * (c - x), xy += (c - x) * (r - y), yy += (r - y) * (r - y);
      xz += (c - x) * (h - z), yz += (r - y) * (h - z);
    });
    const long double det = xx * yy - xy * xy;
    const long double a = (yy * xz - xy * yz) / det, b = (xx * yz - xy * xz) / det;
    const FormFit fit = fitted(field, {1, region, false});
    EXPECT_EQ(fit.samples, static_cast<std::int64_t>(n));
    EXPECT_NEAR(fit.form.gradient().by_column, static_cast<double>(a), 1e-13);
    EXPECT_NEAR(fit.form.gradient().by_row, static_cast<double>(b), 1e-13);
    EXPECT_NEAR(fit.form.heightAt(static_cast<double>(x), static_cast<double>(y)), static_cast<double>(z),
                1e-11);
    long double square = 0;
    each([&](long double c, long double r, long double h) {
      const long double off = h - z - a * (c - x) - b * (r - y);
      square += off * off;
    });
    EXPECT_NEAR(fit.rms, static_cast<double>(std::sqrt(square / n)), 1e-12);
  }
}

TEST(Form, RobustIgnoresWhatStandsOnAPlane) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.01);
  const auto plane = [](double c, double r) { return 3.0 + 0.01 * c - 0.02 * r; };
  // Lands over 30 % of the field, on one side, and a spike of 1e6.
  const Version field = fieldOf(200, 160, [&](int c, int r) {
    if (c == 50 && r == 60) return 1e6;
    return plane(c, r) + noise(random) + (c >= 140 ? 2.0 : 0.0);
  });
  const FormFit fit = fitted(field, {1, Region::kAll, true});
  // 22,400 samples on the plane; standard error of a corner's height some 4 * 0.01 / sqrt(22,400).
  for (const auto& [c, r] : {std::pair{0.0, 0.0}, {199.0, 0.0}, {0.0, 159.0}, {199.0, 159.0}})
    EXPECT_NEAR(fit.form.heightAt(c, r), plane(c, r), 0.002) << c << ", " << r;
  const FormFit plain = fitted(field, {1, Region::kAll, false});
  EXPECT_GT(std::abs(plain.form.heightAt(199.0, 0.0) - plane(199.0, 0.0)), 0.5);
  EXPECT_GT(fit.rounds, 2);
  // Of those on the plane it is the noise, to three standard deviations; of all, the lands' and the spike's.
  EXPECT_NEAR(fit.rms_counted, 0.01, 3.0 * 0.01 / std::sqrt(2.0 * 22400.0));
  EXPECT_GT(fit.rms, 1.0);
  EXPECT_EQ(plain.rms_counted, plain.rms);
}

TEST(Form, RobustOfAnExactPlaneIsThatPlane) {
  const Version field = fieldOf(90, 70, [](int c, int r) { return c > 60 ? 8.0 : 0.25 * c - 0.125 * r; });
  const FormFit fit = fitted(field, {1, Region::kAll, true});
  EXPECT_NEAR(fit.form.gradient().by_column, 0.25, 1e-6);
  EXPECT_NEAR(fit.form.gradient().by_row, -0.125, 1e-6);
}

// What stands on a bent surface is no bend of it, wherever it stands: it is nearer to a plane than the surface is.
TEST(Form, RobustIgnoresWhatStandsOnABentSurface) {
  const auto bent = [](double c, double r) {
    const double x = (c - 100.0) / 100.0, y = (r - 80.0) / 100.0;
    return 0.3 * x * x + 0.1 * x * y - 0.2 * y * y + 0.05 * x;
  };
  struct Standing {
    const char* what;
    std::function<bool(int, int)> there;
  };
  const std::vector<Standing> all{
      {"a strip at the edge, 13 %", [](int c, int) { return c < 26; }},
      {"a boss in the middle, 16 %", [](int c, int r) { return std::hypot(c - 100, r - 80) < 40; }},
      {"a corner, 24 %", [](int c, int r) { return c < 98 && r < 78; }},
      {"two walls, 30 %", [](int c, int) { return c < 20 || (c > 90 && c < 130); }}};
  for (const Standing& standing : all)
    for (int degree = 2; degree <= 4; ++degree) {
      std::mt19937_64 random(11);
      std::normal_distribution<double> noise(0.0, 0.001);
      const Version field = fieldOf(200, 160, [&](int c, int r) {
        return bent(c, r) + noise(random) + (standing.there(c, r) ? 0.3 : 0.0);
      });
      const FormFit fit = fitted(field, {degree, Region::kAll, true});
      double square = 0.0, samples = 0.0;
      for (int r = 0; r < 160; ++r)
        for (int c = 0; c < 200; ++c) {
          if (standing.there(c, r)) continue;
          const double off = fit.form.heightAt(c, r) - bent(c, r);
          square += off * off;
          samples += 1.0;
        }
      EXPECT_LT(std::sqrt(square / samples), 2e-4) << standing.what << ", degree " << degree;
    }
}

// The height of one spike says nothing of how finely the others are rounded.
TEST(Form, RobustWithASpikeBesideAStepIsThePlane) {
  for (const double spike : {1e3, 1e5, 1e6}) {
    const Version field = fieldOf(200, 150, [&](int c, int r) {
      const double plane = 0.02 * c + 0.01 * r;
      return c == 120 && r == 40 ? spike : c > 160 ? plane + 0.5 : plane + 1e-3 * ((c * 7 + r * 13) % 5 - 2);
    });
    for (int degree = 1; degree <= PolynomialForm::kMostDegree; ++degree) {
      const FormFit fit = fitted(field, {degree, Region::kAll, true});
      for (const auto& [c, r] : {std::pair{0.0, 0.0}, {80.0, 75.0}, {150.0, 149.0}})
        EXPECT_NEAR(fit.form.heightAt(c, r), 0.02 * c + 0.01 * r, 1e-3) << spike << ' ' << degree;
    }
  }
}

TEST(Form, OfHardFieldsIsFinite) {
  const auto check = [](const Version& field, double most) {
    for (int degree = 0; degree <= PolynomialForm::kMostDegree; ++degree)
      for (const bool robust : {false, true}) {
        const FormFit fit = fitted(field, {degree, Region::kAll, robust});
        EXPECT_TRUE(std::isfinite(fit.rms));
        EXPECT_LE(fit.rms, most) << degree;
        for (const double z : fit.form.coefficients) EXPECT_TRUE(std::isfinite(z)) << degree;
      }
  };
  check(fieldOf(1, 1, [](int, int) { return 5.0; }), 1e-12);
  check(fieldOf(70, 1, [](int c, int) { return 0.5 * c; }), 1.0 + 20.3);
  check(fieldOf(1, 70, [](int, int r) { return 0.5 * r; }), 1.0 + 20.3);
  check(fieldOf(40, 40, [](int, int) { return 0.0; }), 1e-12);
  check(fieldOf(40, 40, [](int c, int r) { return c == 3 && r < 3 ? 2.0 + r : double{kHole}; }), 1.0);
  check(fieldOf(40, 40, [](int c, int r) { return (c + r) % 7 == 0 ? 1e6 : 1e-40 * c; }), 4e5);
  // Two halves of equal size: a robust mean is one of them.
  check(fieldOf(40, 40, [](int c, int) { return 3e38 * (c % 2 == 0 ? 1.0 : -1.0); }), 4.3e38);
}

// A line through three samples and a plane of one row: level across what is not determined.
TEST(Form, IsLevelAcrossWhatSamplesDoNotDetermine) {
  const FormFit row = fitted(fieldOf(70, 1, [](int c, int) { return 0.5 * c; }), {1, Region::kAll, false});
  EXPECT_NEAR(row.form.gradient().by_column, 0.5, 1e-9);
  EXPECT_EQ(row.form.gradient().by_row, 0.0);
  EXPECT_NEAR(row.rms, 0.0, 1e-5);
}

// A field of holes with few samples, spacings 1 and 0.25 mm.
Version fewSamples(int width, int height, const std::vector<std::array<int, 3>>& samples) {
  const Version field = fieldOf(width, height, [&](int c, int r) {
    for (const auto& [column, row, z] : samples)
      if (column == c && row == r) return double{1.0} * z;
    return double{kHole};
  });
  Grid grid = field.grid();
  grid.spacing_x = 1.0;
  grid.spacing_y = 0.25;
  return field.withGrid(grid);
}

TEST(Form, OfOneSampleIsLevelAndSaysWhatIsOpen) {
  for (int degree = 1; degree <= PolynomialForm::kMostDegree; ++degree) {
    const FormFit fit = fitted(fewSamples(40, 30, {{39, 29, 7}}), {degree, Region::kAll, false});
    for (const auto& [c, r] : {std::pair{0.0, 0.0}, {39.0, 0.0}, {20.0, 15.0}, {39.0, 29.0}})
      EXPECT_NEAR(fit.form.heightAt(c, r), 7.0, 1e-12) << degree;
    EXPECT_EQ(fit.decided, 1);
  }
  EXPECT_EQ(fitted(fewSamples(40, 30, {{39, 29, 7}}), {1, Region::kAll, false}).open, "x, y");
}

// Samples on one line: the plane rises along it alone, in millimetres.
TEST(Form, OfSamplesOnALineRisesAlongIt) {
  // The line's direction is (2, 4 * 0.25) mm, on which heights rise by 5 over sqrt(5) mm.
  const FormFit fit = fitted(fewSamples(60, 50, {{30, 20, 1}, {32, 24, 6}, {34, 28, 11}}), {});
  EXPECT_NEAR(fit.form.gradient().by_column / 1.0, 5.0 / 5.0 * 2.0, 1e-9);
  EXPECT_NEAR(fit.form.gradient().by_row / 0.25, 5.0 / 5.0 * 1.0, 1e-9);
  EXPECT_NEAR(fit.rms, 0.0, 1e-10);
  EXPECT_EQ(fit.decided, 2);
  EXPECT_EQ(fit.open, "x, y");
  const FormFit column = fitted(fewSamples(60, 50, {{30, 20, 1}, {30, 24, 6}, {30, 28, 11}}), {});
  EXPECT_EQ(column.open, "x");
  EXPECT_NEAR(column.form.gradient().by_column, 0.0, 1e-12);
}

TEST(Form, OfThreeSamplesThatSpanAPlaneIsDecided) {
  const FormFit fit = fitted(fewSamples(60, 50, {{30, 20, 1}, {31, 20, 3}, {30, 21, 2}}), {});
  EXPECT_EQ(fit.decided, 3);
  EXPECT_EQ(fit.open, "");
  EXPECT_NEAR(fit.form.gradient().by_column, 2.0, 1e-9);
  EXPECT_NEAR(fit.form.gradient().by_row, 1.0, 1e-9);
}

// Mean square gradient over the field by plain sums, and each form through the same samples that is near is less flat.
TEST(Form, OfFewerSamplesThanTermsIsTheFlattest) {
  constexpr int kWidth = 48, kHeight = 30;
  const std::vector<std::array<int, 3>> samples = {{3, 4, 1},  {9, 4, 3}, {4, 9, 2},
                                                   {9, 12, 5}, {6, 7, 2}, {2, 12, 4}};
  const Version field = fewSamples(kWidth, kHeight, samples);
  const FormFit fit = fitted(field, {5, Region::kAll, false});
  EXPECT_EQ(fit.decided, 6);
  EXPECT_NEAR(fit.rms, 0.0, 1e-8);
  const auto steepness = [&](const PolynomialForm& form) {
    constexpr int kParts = 400;
    double sum = 0.0;
    for (int i = 0; i < kParts; ++i)
      for (int j = 0; j < kParts; ++j) {
        const double c = (i + 0.5) * (kWidth - 1) / kParts, r = (j + 0.5) * (kHeight - 1) / kParts;
        const double x = (form.heightAt(c + 1e-4, r) - form.heightAt(c - 1e-4, r)) / 2e-4,
                     y = (form.heightAt(c, r + 1e-4) - form.heightAt(c, r - 1e-4)) / (2e-4 * 0.25);
        sum += (x * x + y * y) / (double{kParts} * kParts);
      }
    return sum;
  };
  // Of quadratics six samples decide one.
  const FormFit quadratic = fitted(field, {2, Region::kAll, false});
  EXPECT_EQ(quadratic.open, "");
  const double flattest = steepness(fit.form);
  EXPECT_LT(flattest, steepness(quadratic.form));
  // To others by what is 0 at all six samples: products of lines through them, two each.
  const auto line = [&](int a, int b) {
    const auto &p = samples[static_cast<std::size_t>(a)], &q = samples[static_cast<std::size_t>(b)];
    return [p, q](double c, double r) { return (q[0] - p[0]) * (r - p[1]) - (q[1] - p[1]) * (c - p[0]); };
  };
  const auto first = line(0, 1), second = line(2, 3), third = line(4, 5);
  const Version nothing =
      fieldOf(kWidth, kHeight, [&](int c, int r) { return 1e-4 * first(c, r) * second(c, r) * third(c, r); });
  const PolynomialForm other = fitted(nothing, {5, Region::kAll, false}).form;
  for (const double step : {-1e-2, 1e-2}) {
    PolynomialForm moved = fit.form;
    for (std::size_t k = 0; k < moved.coefficients.size(); ++k)
      moved.coefficients[k] += step * other.coefficients[k];
    EXPECT_GT(steepness(moved), flattest) << step;
  }
}

// A region of a twentieth of the field, where the field's own terms can hardly be told apart.
TEST(Form, OfASmallRegionIsFound) {
  const auto within = [](int c, int r) { return c >= 610 && c < 640 && r >= 20 && r < 50; };
  const auto height = [](double c, double r) {
    const double x = (c - 625) / 15, y = (r - 35) / 15;
    return 2 * x * x * x * x * x - x * x * y * y * y + 3 * x * y + y - 1;
  };
  const Version field = fieldOf(
      640, 600, [&](int c, int r) { return within(c, r) ? height(c, r) : 0.0; }, within);
  const FormFit fit = fitted(field, {5, Region::kMarked, false});
  EXPECT_EQ(fit.open, "");
  EXPECT_LT(fit.rms, 1e-6);  // heights of up to 8, rounded to float: 2.4e-7, and the form's own rounding
}

TEST(Form, IsBitIdenticalForAnyNumberOfThreads) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> noise;
  const Version field = fieldOf(300, 280, [&](int c, int r) { return polynomial(4, c, r) + noise(random); });
  const auto with = [&](int threads) {
    FormFit fit;
    tbb::task_arena arena(threads);
    arena.execute([&] { fit = fitted(field, {5, Region::kAll, true}); });
    return fit.form.coefficients;
  };
  const auto one = with(1);
  for (const int threads : {2, 3, 5}) EXPECT_EQ(with(threads), one);
}

TEST(Form, FarFromZeroLosesNoDigit) {
  const Version field = fieldOf(128, 128, [](int c, int r) { return 4194304.0 + 0.5 * ((c + 2 * r) % 64); });
  const Version near = fieldOf(128, 128, [](int c, int r) { return 0.5 * ((c + 2 * r) % 64); });
  const FormFit far = fitted(field, {3, Region::kAll, false});
  const FormFit here = fitted(near, {3, Region::kAll, false});
  EXPECT_NEAR(far.form.heightAt(31, 77) - 4194304.0, here.form.heightAt(31, 77), 1e-8);
  EXPECT_NEAR(far.rms, here.rms, 1e-10);
}

TEST(Form, TakenOutLeavesWhatItIsNot) {
  const auto marked = [](int c, int r) { return c == r; };
  const Version field = fieldOf(
      140, 80,
      [](int c, int r) {
        return c == 9 && r == 8 ? double{kHole} : polynomial(2, c, r) + (c == 7 && r == 5 ? 1.0 : 0.0);
      },
      marked);
  JobControl job;
  PolynomialForm form = fitted(field, {2, Region::kUnmarked, true}).form;
  const auto levelled = withoutForm(field, form, job);
  ASSERT_TRUE(levelled) << levelled.error().line();
  const FieldReader reader = levelled->reader();
  EXPECT_TRUE(std::isnan(reader.heightAt(9, 8)));
  EXPECT_NEAR(reader.heightAt(7, 5), 1.0, 1e-6);
  EXPECT_TRUE(reader.markedAt(33, 33));
  EXPECT_FALSE(reader.markedAt(33, 34));
  for (int r = 0; r < 80; ++r)
    for (int c = 0; c < 140; ++c) {
      if ((c == 9 && r == 8) || (c == 7 && r == 5)) continue;
      const double left = field.reader().heightAt(c, r) - form.heightAt(c, r);
      ASSERT_NEAR(reader.heightAt(c, r), left, 1e-7 * std::abs(left) + 1e-14) << c << ", " << r;
    }
}

TEST(Form, RefusesWhatCannotBeFitted) {
  JobControl job;
  const Version field = fieldOf(20, 20, [](int c, int) { return c; });
  EXPECT_EQ(fitForm(field, {6, Region::kAll, false}, job).error().kind, ErrorKind::kInput);
  EXPECT_EQ(fitForm(field, {-1, Region::kAll, false}, job).error().kind, ErrorKind::kInput);
  EXPECT_EQ(fitForm(field, {1, Region::kMarked, false}, job).error().kind, ErrorKind::kInput);
  const Version holes = fieldOf(20, 20, [](int, int) { return double{kHole}; });
  EXPECT_EQ(fitForm(holes, {1, Region::kAll, true}, job).error().kind, ErrorKind::kInput);
  job.cancel();
  EXPECT_EQ(fitForm(field, {1, Region::kAll, false}, job).error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(withoutForm(field, PolynomialForm{0, 20, 20, 0.0, {0.0}}, job).error().kind,
            ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
