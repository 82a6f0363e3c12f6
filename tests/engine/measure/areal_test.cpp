#include "engine/measure/areal.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/field/builder.h"
#include "engine/measure/form.h"
#include "engine/measure/form_fit.h"
#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kPi = std::numbers::pi;

struct Made {
  Grid grid;
  std::vector<float> heights;
  std::vector<std::uint8_t> marks;

  Made(std::int32_t width, std::int32_t height, const std::function<double(int, int)>& z) {
    grid.width = width;
    grid.height = height;
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c) heights.push_back(static_cast<float>(z(c, r)));
  }
  [[nodiscard]] Version field() const { return makeField(grid, heights, marks); }
};

PolynomialForm zeroForm(const Grid& grid) {
  return {0, grid.width, grid.height, 0.0, {0.0}};
}

ArealParameters measured(const Made& made, Region region = Region::kAll) {
  JobControl job;
  const auto result = measureAreal(made.field(), zeroForm(made.grid), {.region = region}, job);
  EXPECT_TRUE(result) << result.error().line();
  return result ? *result : ArealParameters{};
}

// Forty whole waves along x: every height of the closed formulas, slopes as the chords between samples have them.
TEST(Areal, OfASineIsTheClosedFormula) {
  constexpr double kAmplitude = 0.3, kWave = 25.0;
  Made made(1001, 40, [](int c, int) { return kAmplitude * std::sin(2.0 * kPi * (c + 0.25) / kWave); });
  made.grid.spacing_x = 0.02;
  made.grid.spacing_y = 0.05;
  const ArealParameters p = measured(made);
  // 1001 columns: one sample more than whole waves.
  EXPECT_NEAR(p.sq, kAmplitude / std::sqrt(2.0), 2e-3 * kAmplitude);
  EXPECT_NEAR(p.sa, 2.0 * kAmplitude / kPi, 3e-3 * kAmplitude);
  EXPECT_NEAR(p.ssk, 0.0, 5e-3);
  EXPECT_NEAR(p.sku, 1.5, 5e-3);
  EXPECT_NEAR(p.sp, kAmplitude, 5e-3 * kAmplitude);
  // No sample lies on a crest: at most half a sample off.
  EXPECT_NEAR(p.sz, 2.0 * kAmplitude, 2.0 * kAmplitude * (1.0 - std::cos(kPi / kWave)));
  const double k = 2.0 * kPi / (kWave * 0.02);
  const double sinc = std::sin(kPi / kWave) / (kPi / kWave);
  EXPECT_NEAR(p.sdq, kAmplitude * k / std::sqrt(2.0) * sinc, 1e-5 * k);
  EXPECT_EQ(p.cells, 1000 * 39);
}

// Whole waves sampled half a sample beside their zeros: sums over a period are closed formulas, exactly.
TEST(Areal, OfWholeWavesIsTheClosedFormula) {
  constexpr int kSamples = 40;
  constexpr double kAmplitude = 0.3, k = 2.0 * kPi / kSamples;
  const auto wave = [](int c, int) { return kAmplitude * std::sin(k * (c + 0.5)); };
  const ArealParameters p = measured(Made(25 * kSamples, 30, wave));
  const auto near = [](double seen, double wanted) { EXPECT_NEAR(seen / wanted, 1.0, 1e-6); };
  near(p.sq, kAmplitude / std::sqrt(2.0));
  near(p.sku, 1.5);
  EXPECT_NEAR(p.ssk, 0.0, 1e-6);
  near(p.sa, kAmplitude * 2.0 / (kSamples * std::sin(0.5 * k)));
  near(p.sz, 2.0 * kAmplitude * std::cos(0.5 * k));
  near(p.sp, p.sv);
  // Chords of 25 waves: 25 * 40 cells along x.
  Made chords(25 * kSamples + 1, 30, wave);
  chords.grid.spacing_x = 0.05;
  near(measured(chords).sdq, kAmplitude * k / 0.05 / std::sqrt(2.0) * std::sin(0.5 * k) / (0.5 * k));
}

// A triangle wave with its corners on samples: one slope everywhere.
TEST(Areal, OfATriangleIsTheClosedFormula) {
  constexpr int kSamples = 64;
  Made made(20 * kSamples + 1, 25, [](int c, int) { return std::abs(c % kSamples - kSamples / 2) / 32.0; });
  made.grid.spacing_x = 0.125;
  made.grid.spacing_y = 0.5;
  const ArealParameters p = measured(made);
  const double slope = 1.0 / 32.0 / 0.125;
  EXPECT_NEAR(p.sdq, slope, 1e-12);
  EXPECT_NEAR(p.sdr, std::sqrt(1.0 + slope * slope) - 1.0, 1e-12);
  EXPECT_NEAR(p.sz, 1.0, 1e-12);
  // Sums of squares over whole waves of n samples: 1/12 + 2 / (3 n^2) of the height, and one sample more.
  const Made whole(20 * kSamples, 25,
                   [](int c, int) { return std::abs(c % kSamples - kSamples / 2) / 32.0; });
  const ArealParameters w = measured(whole);
  EXPECT_NEAR(w.sq, std::sqrt(1.0 / 12.0 + 2.0 / (3.0 * kSamples * kSamples)), 1e-7);
  EXPECT_NEAR(w.sa, 0.25, 1e-7);
}

// z = (x^2 + y^2) / 2 R over [-a, a]^2: chords are slopes in their middles, whose mean square is a^2 / 3 - h^2 / 12.
TEST(Areal, OfAParaboloidHasItsGradient) {
  constexpr double kRadius = 512.0;
  const ArealParameters p = measured(Made(65, 65, [](int c, int r) {
    return ((c - 32.0) * (c - 32.0) + (r - 32.0) * (r - 32.0)) / (2.0 * kRadius);
  }));
  EXPECT_NEAR(p.sdq, std::sqrt(2.0 * (32.0 * 32.0 / 3.0 - 1.0 / 12.0)) / kRadius, 1e-12);
  EXPECT_NEAR(p.sz, 2.0, 1e-12);
}

TEST(Areal, OfAHalfRaisedFieldIsItsStep) {
  const ArealParameters p = measured(Made(64, 64, [](int c, int) { return c < 32 ? 0.0 : 2.0; }));
  EXPECT_DOUBLE_EQ(p.sq, 1.0);
  EXPECT_DOUBLE_EQ(p.sa, 1.0);
  EXPECT_DOUBLE_EQ(p.ssk, 0.0);
  EXPECT_DOUBLE_EQ(p.sku, 1.0);
  EXPECT_DOUBLE_EQ(p.sp, 1.0);
  EXPECT_DOUBLE_EQ(p.sv, 1.0);
}

TEST(Areal, OfATiltedPlaneIsAUniformDistribution) {
  Made made(400, 400, [](int c, int) { return 0.5 * c; });
  const ArealParameters p = measured(made);
  const double range = 0.5 * 400;
  EXPECT_NEAR(p.sq, range / std::sqrt(12.0), 1e-3);
  EXPECT_NEAR(p.sku, 1.8, 1e-4);
  EXPECT_NEAR(p.sa, range / 4.0, 1e-3);
  EXPECT_NEAR(p.sdq, 0.5, 1e-9);
  EXPECT_NEAR(p.sdr, std::sqrt(1.25) - 1.0, 1e-9);
  EXPECT_NEAR(p.ratio.sk, range, 0.01 * range);
}

TEST(Areal, OfGaussianNoiseHasItsMoments) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 0.02);
  const ArealParameters p = measured(Made(700, 600, [&](int, int) { return noise(random); }));
  // 420,000 samples: standard errors of sq 0.0011, ssk 0.0038, sku 0.0076; four of each.
  EXPECT_NEAR(p.sq / 0.02, 1.0, 0.0044);
  EXPECT_NEAR(p.sa / 0.02, std::sqrt(2.0 / kPi), 0.0044);
  EXPECT_NEAR(p.ssk, 0.0, 0.016);
  EXPECT_NEAR(p.sku, 3.0, 0.031);
  // Chords of white noise: variance 2 sigma^2 / h^2; over a patch (2 + 2 + 2 * 1 ...) / 3 of it in each direction.
  EXPECT_NEAR(p.sdq / 0.02, std::sqrt(2.0 * 4.0 / 3.0), 0.02);
}

// Every figure by the plainest loops in long double, over holes, marks, unequal spacing and a form.
TEST(Areal, IsWhatPlainLoopsFind) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0.0, 0.4);
  Made made(131, 77, [&](int c, int r) {
    return (c * 5 + r * 3) % 17 == 0 ? kNothing : 40.0 + 0.02 * c + noise(random);
  });
  made.grid.spacing_x = 0.25;
  made.grid.spacing_y = 1.0;
  made.grid.height_unit = {"um", 1e-3};
  for (int i = 0; i < 131 * 77; ++i) made.marks.push_back(i % 5 < 3 ? 1 : 0);
  JobControl job;
  const auto fit = fitForm(made.field(), {1, Region::kMarked, false}, job);
  ASSERT_TRUE(fit);
  const auto result = measureAreal(made.field(), fit->form, {.region = Region::kMarked}, job);
  ASSERT_TRUE(result);
  const auto at = [&](int c, int r) -> long double {
    const auto i = static_cast<std::size_t>(r * 131 + c);
    if (made.marks[i] == 0) return std::nanl("");
    return static_cast<long double>(made.heights[i]) - fit->form.heightAt(c, r);
  };
  long double n = 0, mean = 0;
  std::vector<long double> all;
  for (int r = 0; r < 77; ++r)
    for (int c = 0; c < 131; ++c)
      if (const long double z = at(c, r); !std::isnan(z)) n += 1, mean += z, all.push_back(z);
  mean /= n;
  long double a = 0, s2 = 0, s3 = 0, s4 = 0;
  for (const long double z : all) {
    const long double d = z - mean;
    a += std::abs(d), s2 += d * d, s3 += d * d * d, s4 += d * d * d * d;
  }
  const long double sq = std::sqrt(s2 / n);
  const auto near = [](double seen, long double wanted) {
    EXPECT_NEAR(seen, static_cast<double>(wanted), 1e-12 * (1.0 + std::abs(static_cast<double>(wanted))));
  };
  near(result->sq, sq);
  near(result->sa, a / n);
  near(result->ssk, s3 / n / (sq * sq * sq));
  near(result->sku, s4 / n / (sq * sq * sq * sq));
  near(result->sp, *std::ranges::max_element(all) - mean);
  near(result->sv, mean - *std::ranges::min_element(all));
  // The gradient and the area of every patch by many small pieces.
  long double gradient = 0, area = 0, cells = 0;
  for (int r = 0; r + 1 < 77; ++r)
    for (int c = 0; c + 1 < 131; ++c) {
      const long double z00 = at(c, r), z10 = at(c + 1, r), z01 = at(c, r + 1), z11 = at(c + 1, r + 1);
      if (std::isnan(z00 + z10 + z01 + z11)) continue;
      cells += 1;
      constexpr int kPieces = 40;
      for (int i = 0; i < kPieces; ++i)
        for (int j = 0; j < kPieces; ++j) {
          const long double u = (i + 0.5L) / kPieces, v = (j + 0.5L) / kPieces;
          const long double gx = 1e-3L * ((1 - v) * (z10 - z00) + v * (z11 - z01)) / 0.25L;
          const long double gy = 1e-3L * ((1 - u) * (z01 - z00) + u * (z11 - z10)) / 1.0L;
          gradient += (gx * gx + gy * gy) / (kPieces * kPieces);
          area += (std::sqrt(1 + gx * gx + gy * gy) - 1) / (kPieces * kPieces);
        }
    }
  EXPECT_EQ(result->cells, static_cast<std::int64_t>(cells));
  EXPECT_NEAR(result->sdq, static_cast<double>(std::sqrt(gradient / cells)), 2e-4 * result->sdq);
  EXPECT_NEAR(result->sdr, static_cast<double>(area / cells), 4e-4 * result->sdr);
}

TEST(Areal, OfHardFieldsIsAFigureOrNone) {
  const ArealParameters one = measured(Made(1, 1, [](int, int) { return 4.0; }));
  EXPECT_TRUE(std::isnan(one.sq));
  EXPECT_TRUE(std::isnan(one.ssk));
  EXPECT_TRUE(std::isnan(one.sdq));
  const ArealParameters flat = measured(Made(70, 65, [](int, int) { return 4.0; }));
  EXPECT_EQ(flat.sz, 0.0);
  EXPECT_EQ(flat.sdq, 0.0);
  EXPECT_EQ(flat.sdr, 0.0);
  // Where the peaks end is not stated of a core without a height, which two levels have, too.
  const ArealParameters levels = measured(Made(70, 65, [](int c, int) { return c < 35 ? 4.0 : 5.0; }));
  EXPECT_GT(levels.sq, 0.0);
  for (const ArealParameters* const p : {&flat, &levels})
    for (const char* const key : {"smrk1", "smrk2"})
      EXPECT_EQ(std::ranges::count(p->not_stated, key, &NotStated::parameter), 1) << key;
  const ArealParameters row = measured(Made(70, 1, [](int c, int) { return c % 2; }));
  EXPECT_DOUBLE_EQ(row.sq, 0.5);
  EXPECT_EQ(row.cells, 0);
  const ArealParameters spike =
      measured(Made(80, 80, [](int c, int r) { return c == 40 && r == 40 ? 1e6 : 0.0; }));
  EXPECT_NEAR(spike.sz, 1e6, 1e-3);
  for (const double value :
       {spike.sq, spike.ssk, spike.sku, spike.sdq, spike.sdr, spike.ratio.sk, spike.ratio.spk})
    EXPECT_TRUE(std::isfinite(value));
  const ArealParameters small = measured(Made(80, 80, [](int c, int r) { return 1e-41 * (c + r); }));
  EXPECT_GT(small.sq, 0.0);
  JobControl job;
  const Made holes(9, 9, [](int, int) { return kNothing; });
  EXPECT_EQ(measureAreal(holes.field(), zeroForm(holes.grid), {}, job).error().kind, ErrorKind::kInput);
  job.cancel();
  const Made any(9, 9, [](int c, int) { return c; });
  EXPECT_EQ(measureAreal(any.field(), zeroForm(any.grid), {}, job).error().kind, ErrorKind::kCancelled);
}

// A figure, or one reason why there is none: nothing else.
TEST(Areal, StatesEachParameterOrTheReason) {
  const auto check = [](const Made& made) {
    const ArealParameters p = measured(made);
    const std::pair<const char*, double> figures[] = {{"sq", p.sq},
                                                      {"ssk", p.ssk},
                                                      {"sku", p.sku},
                                                      {"sp", p.sp},
                                                      {"sv", p.sv},
                                                      {"sz", p.sz},
                                                      {"sa", p.sa},
                                                      {"sdq", p.sdq},
                                                      {"sdr", p.sdr},
                                                      {"sk", p.ratio.sk},
                                                      {"spk", p.ratio.spk},
                                                      {"svk", p.ratio.svk},
                                                      {"smrk1", p.ratio.smrk1},
                                                      {"smrk2", p.ratio.smrk2},
                                                      {"vmp", p.ratio.vmp},
                                                      {"vmc", p.ratio.vmc},
                                                      {"vvc", p.ratio.vvc},
                                                      {"vvv", p.ratio.vvv},
                                                      {"sxp", p.ratio.sxp},
                                                      {"sal", p.spatial.sal},
                                                      {"str", p.spatial.str},
                                                      {"std", p.spatial.lay},
                                                      {"ssw", p.spatial.ssw},
                                                      {"spd", p.feature.spd},
                                                      {"svd", p.feature.svd},
                                                      {"spc", p.feature.spc},
                                                      {"svc", p.feature.svc},
                                                      {"s5p", p.feature.s5p},
                                                      {"s5v", p.feature.s5v},
                                                      {"s10z", p.feature.s10z},
                                                      {"sha", p.feature.sha},
                                                      {"sda", p.feature.sda},
                                                      {"shv", p.feature.shv},
                                                      {"sdv", p.feature.sdv}};
    for (const auto& figure : figures) {
      const auto named = [&](const auto& each) { return each.parameter == figure.first; };
      EXPECT_EQ(std::ranges::count_if(p.not_stated, named), std::isfinite(figure.second) ? 0 : 1)
          << figure.first;
    }
  };
  check(Made(1, 1, [](int, int) { return 4.0; }));
  check(Made(70, 1, [](int c, int) { return c % 2; }));
  check(Made(70, 65, [](int, int) { return 4.0; }));
  check(Made(40, 40, [](int c, int r) { return r == 9 && c < 3 ? c : kNothing; }));
  check(Made(80, 80, [](int c, int r) { return c == 40 && r == 40 ? 1e6 : 0.0; }));
  Made far(80, 80, [](int c, int r) { return std::sin(0.3 * c + 0.1 * r * r); });
  far.grid.origin_x = far.grid.origin_y = 5e6;
  far.grid.spacing_y = 4.0;
  check(far);
}

TEST(Areal, MaterialRatiosAreThoseAskedFor) {
  const Made made(100, 10, [](int c, int) { return c; });
  JobControl job;
  ArealOptions options;
  options.at_heights = {-100.0, 0.0, 25.0, 100.0};
  options.at_ratios = {0.0, 0.1, 0.5, 1.0};
  const auto p = measureAreal(made.field(), zeroForm(made.grid), options, job);
  ASSERT_TRUE(p);
  // About the mean of 49.5 heights run from -49.5 to 49.5.
  EXPECT_EQ(p->ratios, (std::vector<double>{1.0, 0.5, 0.25, 0.0}));
  EXPECT_EQ(p->heights.front(), 49.5);
  EXPECT_EQ(p->heights[2], 0.0);
  EXPECT_EQ(p->heights.back(), -49.5);
  options.functional = options.spatial = options.feature = options.hybrid = false;
  EXPECT_TRUE(measureAreal(made.field(), zeroForm(made.grid), options, job)->ratios.empty());
}

TEST(Areal, SpatialParametersThatMemoryIsNotFreeForAreNotStated) {
  const Made made(80, 70, [](int c, int r) { return std::sin(0.5 * c + 0.3 * r); });
  JobControl job;
  const auto with = [&](std::optional<std::uint64_t> free) {
    ArealOptions options;
    options.free_memory = free;
    const auto p = measureAreal(made.field(), zeroForm(made.grid), options, job);
    EXPECT_TRUE(p) << p.error().line();
    return p ? *p : ArealParameters{};
  };
  const ArealParameters known = with({});
  EXPECT_TRUE(std::isfinite(known.spatial.sal));
  // 40 bytes a sample and more, since the transform's sides are rounded up; four fifths of what is free.
  const ArealParameters little = with(80 * 70 * 40);
  EXPECT_TRUE(std::isnan(little.spatial.sal) && std::isnan(little.spatial.str) &&
              std::isnan(little.spatial.lay));
  for (const char* const key : {"sal", "str", "std", "ssw"}) {
    const auto why = std::ranges::find(little.not_stated, key, &NotStated::parameter);
    ASSERT_NE(why, little.not_stated.end()) << key;
    EXPECT_NE(why->reason.find("smaller region"), std::string::npos) << why->reason;
  }
  EXPECT_EQ(little.sq, known.sq);
  EXPECT_EQ(little.feature.spd, known.feature.spd);
  // Where it is enough, or where nobody knows, they are measured.
  EXPECT_EQ(with(80 * 70 * 400).spatial.sal, known.spatial.sal);
  EXPECT_EQ(with(0).spatial.sal, known.spatial.sal);
}

TEST(Areal, IsBitIdenticalForAnyNumberOfThreads) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> noise;
  const Made made(333, 290, [&](int, int) { return noise(random); });
  const auto with = [&](int threads) {
    ArealParameters p;
    tbb::task_arena arena(threads);
    arena.execute([&] { p = measured(made); });
    return std::vector<double>{p.sq, p.ssk, p.sku, p.sa, p.sdq, p.sdr, p.ratio.sk, p.ratio.spk, p.ratio.vvc};
  };
  const auto one = with(1);
  for (const int threads : {2, 4}) EXPECT_EQ(with(threads), one);
}

// Nothing of three samples is left beside their plane but the rounding of the sums.
TEST(Areal, AFormThroughAllSamplesLeavesNothingToState) {
  const auto within = [](int c, int r) {
    return (c == 3 && r == 4) || (c == 4 && r == 4) || (c == 3 && r == 5);
  };
  const Version field = fieldOf(
      20, 20, [](int c, int r) { return 0.1 * c * c + 0.7 * r; }, within);
  JobControl job;
  const auto fit = fitNominalForm(field, {.kind = FormKind::kPlane, .region = Region::kMarked}, job);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->numbers, 3);
  ArealOptions options{.region = Region::kMarked, .fitted = fit->numbers};
  options.at_ratios = {0.1};
  const auto measured = measureAreal(field, fit->form, options, job);
  ASSERT_TRUE(measured);
  for (const double value :
       {measured->sq, measured->sku, measured->sz, measured->sdr, measured->ratio.sk, measured->ratio.sxp,
        measured->spatial.sal, measured->feature.spd, measured->feature.shv, measured->heights[0]})
    EXPECT_TRUE(std::isnan(value));
  ASSERT_EQ(measured->not_stated.size(), 34U);
  EXPECT_EQ(measured->not_stated[0].reason, "the form goes through all 3 samples");
  EXPECT_EQ(measured->samples, 3);
}

TEST(Areal, WhatIsLeftByRoundingIsNotStated) {
  // A plane that floats round: by half of 2^-20 at heights of 8 to 16.
  const Version field = fieldOf(60, 50, [](int c, int r) { return 8.0 + 0.013 * c + 0.007 * r; });
  JobControl job;
  const auto fit = fitNominalForm(field, {}, job);
  const auto measured = measureAreal(field, fit->form, {.fitted = fit->numbers}, job);
  ASSERT_TRUE(measured);
  EXPECT_TRUE(std::isnan(measured->sq));
  EXPECT_EQ(measured->not_stated.front().parameter, "sq");
  EXPECT_EQ(measured->not_stated.front().reason, "what is left is no more than the rounding of the heights");
  // A wave of some such steps is one.
  const Version wave =
      fieldOf(60, 50, [](int c, int r) { return 8.0 + 0.013 * c + 0.007 * r + 1e-5 * std::sin(0.5 * c); });
  EXPECT_NEAR(measureAreal(wave, fit->form, {}, job)->sq, 1e-5 / std::sqrt(2.0), 2e-7);
}

}  // namespace
}  // namespace fettle::engine
