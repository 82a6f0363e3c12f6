#include "engine/measure/roughness.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

Section profileOf(std::vector<double> heights, double step_mm) {
  Section section;
  section.step_mm = step_mm;
  section.covariance.assign(heights.size(), 1.0);
  section.share.assign(heights.size(), 1.0);
  section.position.resize(heights.size());
  section.height = std::move(heights);
  return section;
}

Roughness measured(const Section& section, double cutoff_mm, double lambda_s_mm = 0.0) {
  const auto roughness = roughnessOf(section, {0.0, section.lengthMm()}, {cutoff_mm, lambda_s_mm});
  EXPECT_TRUE(roughness) << roughness.error().line();
  return roughness ? *roughness : Roughness{};
}

// ISO 16610-21:2011, 4.3: of a sine of wavelength L the mean line has the share exp(-pi (a c / L)^2), a half at the cut-off.
TEST(Roughness, MeanLineOfASineHasTheStandardsAmplitude) {
  const double step = 0.001, cutoff = 0.8;
  for (const double wavelength : {0.4, 0.8, 1.6, 4.0}) {
    std::vector<double> heights(8001);
    for (std::size_t i = 0; i < heights.size(); ++i)
      heights[i] = std::sin(kTurn * static_cast<double>(i) * step / wavelength);
    const std::vector<double> line = gaussianMeanLine(heights, step, cutoff);
    const double share = std::exp(-std::numbers::ln2 * std::pow(cutoff / wavelength, 2));
    // Weights beyond one cut-off are left out: less than 1.2e-6 of all.
    for (std::size_t i = 1000; i < 7000; i += 100)
      EXPECT_NEAR(line[i], share * heights[i], 3e-6) << wavelength;
  }
}

// Each mean by its definition, near and far from the ends.
TEST(Roughness, MeanLineIsTheWeightedMean) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<double> heights(60);
  for (double& z : heights) z = normal(random);
  const double step = 0.1, cutoff = 1.0;
  const std::vector<double> line = gaussianMeanLine(heights, step, cutoff);
  for (int i = 0; i < 60; ++i) {
    long double sum = 0.0, whole = 0.0;
    for (int k = 0; k < 60; ++k) {
      const double x = (i - k) * step;
      if (std::abs(i - k) > 10) continue;
      const long double weight =
          std::exp(-std::numbers::pi * x * x / (std::numbers::ln2 / std::numbers::pi * cutoff * cutoff));
      sum += weight * static_cast<long double>(heights[static_cast<std::size_t>(k)]);
      whole += weight;
    }
    EXPECT_NEAR(line[static_cast<std::size_t>(i)], static_cast<double>(sum / whole), 1e-14) << i;
  }
}

TEST(Roughness, OfASineIsThatOfTheSine) {
  const double step = 0.0005, cutoff = 0.8, wavelength = 0.08, amplitude = 0.001;
  std::vector<double> heights(11201);  // 5.6 mm on a slope
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = 3.0 + 0.1 * static_cast<double>(i) * step +
                 amplitude * std::sin(kTurn * static_cast<double>(i) * step / wavelength);
  const Roughness r = measured(profileOf(heights, step), cutoff);
  EXPECT_EQ(r.lengths, 6);
  EXPECT_NEAR(r.evaluated.from_mm, 0.4, 1e-9);
  EXPECT_NEAR(r.evaluated.to_mm, 5.2, 1e-9);
  // The mean line has exp(-100 ln 2) of it; at the ends its weights are one-sided beyond 0.4 mm, 0.4 % of the slope of
  // what is left, here of the sine's own line.
  EXPECT_NEAR(r.ra, amplitude * 2.0 / std::numbers::pi, 2e-3 * amplitude);
  EXPECT_NEAR(r.rq, amplitude / std::numbers::sqrt2, 2e-3 * amplitude);
  EXPECT_NEAR(r.rz, 2.0 * amplitude, 2e-3 * amplitude);
  EXPECT_NEAR(r.rsk, 0.0, 0.01);
  EXPECT_NEAR(r.rku, 1.5, 0.01);
  EXPECT_NEAR(r.rsm, wavelength, 1e-4);
}

Roughness measuredOf(ProfileKind kind, const Section& section, double cutoff_mm, double lambda_s_mm = 0.0) {
  const auto figures = roughnessOf(section, {0.0, section.lengthMm()}, {cutoff_mm, lambda_s_mm, kind});
  EXPECT_TRUE(figures) << figures.error().line();
  return figures ? *figures : Roughness{};
}

// Two sines on a slope: the primary profile has both, roughness the short one, waviness exp(-ln 2 (c / L)^2) of the long one.
TEST(Roughness, OfTwoSinesIsSharedByTheProfiles) {
  const double step = 0.001, cutoff = 0.8, small = 0.001, large = 0.004, wavelength = 4.0;
  std::vector<double> heights(16801);  // 16.8 mm: four long waves, and half a cut-off at each end
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const double x = static_cast<double>(i) * step - 0.4;
    heights[i] =
        7.0 - 0.02 * x + small * std::sin(kTurn * x / 0.08) + large * std::cos(kTurn * x / wavelength);
  }
  const Section section = profileOf(heights, step);
  const double left = large * std::exp(-std::numbers::ln2 * std::pow(cutoff / wavelength, 2));
  const Roughness w = measuredOf(ProfileKind::kWaviness, section, cutoff);
  EXPECT_EQ(w.lengths, 1);
  EXPECT_NEAR(w.evaluated.from_mm, 0.4, 1e-9);
  EXPECT_NEAR(w.evaluated.to_mm, 16.4, 1e-9);
  // Of the line that is taken out the cosine's ends leave a tilt, below 1 % of it.
  EXPECT_NEAR(w.rq, left / std::numbers::sqrt2, 0.01 * left);
  EXPECT_NEAR(w.ra, left * 2.0 / std::numbers::pi, 0.01 * left);
  EXPECT_NEAR(w.rt, 2.0 * left, 0.02 * left);
  EXPECT_EQ(w.rz, w.rt) << "one section length";
  EXPECT_NEAR(w.rsm, wavelength, 0.01 * wavelength);
  EXPECT_NEAR(w.rku, 1.5, 0.02);
  const Roughness r = measuredOf(ProfileKind::kRoughness, section, cutoff);
  const double leaves = large - left;  // 2.7 % of the long wave
  EXPECT_NEAR(r.rq, std::hypot(small, leaves) / std::numbers::sqrt2, 0.01 * small);
  const Roughness p = measuredOf(ProfileKind::kPrimary, section, 0.0);
  EXPECT_EQ(p.lengths, 1);
  EXPECT_EQ(p.evaluated.from_mm, 0.0);
  EXPECT_NEAR(p.evaluated.to_mm, 16.8, 1e-9);
  EXPECT_NEAR(p.rt, 2.0 * (small + large), 0.02 * large);
  EXPECT_EQ(p.rz, p.rt);
  // Over 16.8 mm, where the long wave has 4.2 of its own.
  EXPECT_NEAR(p.rq, std::hypot(small, large) / std::numbers::sqrt2, 0.03 * large);
  // The S-filter takes half of the short wave, where its length is lambda s.
  const Roughness smooth = measuredOf(ProfileKind::kPrimary, section, 0.0, 0.08);
  EXPECT_NEAR(p.rt - smooth.rt, small, 0.1 * small);
  EXPECT_NEAR(smooth.evaluated.from_mm, 0.04, 1e-9);
}

TEST(Roughness, OfPrimaryProfilesAndWavinessHardCasesHaveAFigureOrAnError) {
  const auto all = [](const Section& section, double cutoff, ProfileKind kind) {
    return roughnessOf(section, {0.0, section.lengthMm()}, {cutoff, 0.0, kind});
  };
  const Section flat = profileOf(std::vector<double>(400, 3.0), 0.01);
  for (const ProfileInfo& info : profileInfos()) {
    EXPECT_EQ(&profileInfo(info.kind), &info);
    const auto r = all(flat, 0.5, info.kind);
    ASSERT_TRUE(r) << info.word;
    EXPECT_LT(r->rt, 1e-12) << "rounding of the line that is taken out";
  }
  std::vector<double> spike(400, 0.0);
  spike[200] = 1e6;
  for (const ProfileInfo& info : profileInfos()) {
    const auto r = all(profileOf(spike, 0.01), 0.5, info.kind);
    ASSERT_TRUE(r) << info.word;
    EXPECT_TRUE(std::isfinite(r->rq) && r->rq > 0.0);
  }
  // The longest part without a hole counts.
  std::vector<double> holed(400, 0.0);
  for (std::size_t i = 0; i < holed.size(); ++i) holed[i] = std::sin(0.3 * static_cast<double>(i));
  holed[100] = std::numeric_limits<double>::quiet_NaN();
  const auto part = all(profileOf(holed, 0.01), 0.5, ProfileKind::kPrimary);
  ASSERT_TRUE(part);
  EXPECT_NEAR(part->evaluated.from_mm, 1.01, 1e-9);
  EXPECT_FALSE(all(profileOf({1.0, 2.0, 1.0}, 0.01), 0.0, ProfileKind::kPrimary));
  EXPECT_FALSE(all(profileOf(std::vector<double>(90, 0.0), 0.01), 0.5, ProfileKind::kWaviness));
  EXPECT_FALSE(all(flat, 0.03, ProfileKind::kWaviness)) << "a cut-off of 3 places";
}

// A ripple far below a tenth of Rz makes no elements of its own.
TEST(Roughness, SmallPeaksCountToTheirNeighbours) {
  const double step = 0.0005, wavelength = 0.1;
  std::vector<double> heights(8001);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const double x = static_cast<double>(i) * step;
    heights[i] = std::sin(kTurn * x / wavelength) + 0.1 * std::sin(kTurn * x / (wavelength / 17.3));
  }
  EXPECT_NEAR(measured(profileOf(heights, step), 0.8).rsm, wavelength, 0.02 * wavelength);
}

// ISO 16610-21, 4.3, of the S-filter: what is left of a sine of wavelength L is the share exp(-ln 2 (lambda s / L)^2), a half
// where both are alike. The mean line with its cut-off of ten and more wavelengths takes nothing.
TEST(Roughness, LambdaSLeavesHalfOfASineOfItsLength) {
  const double step = 0.0005, cutoff = 0.8;
  for (const double wavelength : {0.02, 0.04, 0.08})
    for (const double lambda_s : {0.01, 0.02, 0.04}) {
      std::vector<double> heights(11201);  // on a slope
      for (std::size_t i = 0; i < heights.size(); ++i)
        heights[i] = 0.1 * static_cast<double>(i) * step +
                     std::sin(kTurn * static_cast<double>(i) * step / wavelength);
      const Roughness whole = measured(profileOf(heights, step), cutoff),
                      left = measured(profileOf(heights, step), cutoff, lambda_s);
      const double share = std::exp(-std::numbers::ln2 * std::pow(lambda_s / wavelength, 2));
      // 2e-3 of the sine, of which the section's length holds no whole number (OfASineIsThatOfTheSine).
      EXPECT_NEAR(left.rq, share * whole.rq, 2e-3) << wavelength << " " << lambda_s;
      EXPECT_NEAR(left.rz, share * whole.rz, 4e-3) << wavelength << " " << lambda_s;
    }
}

// Ends of the S-filter, where its weights are one-sided, are cut off: the slope leaves nothing, and what is evaluated is half of
// lambda s and half of a cut-off away from both ends at least.
TEST(Roughness, LambdaSHasNoEndsInWhatIsEvaluated) {
  std::vector<double> heights(4001);
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = 0.3 * static_cast<double>(i);
  for (const double lambda_s : {0.02, 0.1, 0.2}) {
    const Section section = profileOf(heights, 0.001);
    const Roughness r = measured(section, 0.25, lambda_s);
    EXPECT_LT(r.rz, 1e-9);
    EXPECT_GE(r.evaluated.from_mm, 0.5 * (lambda_s + 0.25) - 1e-9);
    EXPECT_LE(r.evaluated.to_mm, 4.0 - 0.5 * (lambda_s + 0.25) + 1e-9);
    EXPECT_NEAR(r.evaluated.to_mm - r.evaluated.from_mm, r.lengths * 0.25, 1e-9);
  }
  // A spike at an end that the S-filter spreads does not reach over half of it.
  heights.front() = 1e6;
  EXPECT_LT(measured(profileOf(heights, 0.001), 0.25, 0.02).rz, measured(profileOf(heights, 0.001), 0.25).rz);
}

// Integrals of ISO 21920-2 over whole waves: the trapezoidal rule is exact for them, while a mean over all places, which has one end too
// many, is not by 1 / 80 of the places here.
TEST(Roughness, EndsCountHalf) {
  // A square wave of 8 places, sampled twice as high and as low as its steps; the cut-off is far longer.
  std::vector<double> heights(241);
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = i % 8 == 0 ? 4.0 : 0.0;
  const Section section = profileOf(heights, 1.0);
  const auto profile = roughnessProfile(section, {0.0, 240.0}, {80.0});
  ASSERT_TRUE(profile);
  ASSERT_EQ(profile->heights.size(), 161U);
  ASSERT_NEAR(profile->heights.front(), profile->heights.back(), 1e-3) << "whole waves";
  // A peak in eight places: 3.5 over the mean, the others 0.5 below.
  EXPECT_NEAR(measured(section, 80.0).ra, 2.0 * 3.5 / 8.0, 2e-4);
  EXPECT_NEAR(measured(section, 80.0).rq, std::sqrt((3.5 * 3.5 + 7.0 * 0.25) / 8.0), 2e-4);
}

// Closed formulas of a sine of amplitude a and wavelength L. Rdq: 2 pi a / (L sqrt 2). Its material ratio curve is a cos(pi x), which is
// flattest at the top: the equivalent line is that of least squares from 0 to 40 %, and no peak stands over it.
TEST(Roughness, PeaksSlopesAndMaterialRatiosOfASine) {
  const double step = 0.0005, wavelength = 0.08, a = 0.001;
  std::vector<double> heights(11201);
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = a * std::sin(kTurn * static_cast<double>(i) * step / wavelength);
  const Roughness r = measured(profileOf(heights, step), 0.8);
  const double near = 2e-3 * a;
  EXPECT_NEAR(r.rp, a, near);
  EXPECT_NEAR(r.rv, a, near);
  EXPECT_DOUBLE_EQ(r.rz, r.rp + r.rv);
  EXPECT_NEAR(r.rt, 2.0 * a, near);
  EXPECT_NEAR(r.rc, 2.0 * a, near);
  EXPECT_NEAR(r.rdq, kTurn * a / wavelength / std::numbers::sqrt2, 1e-3);
  using std::numbers::pi;
  const double w = 0.4, mean = std::sin(pi * w) / (pi * w);
  const double slope =
      (0.5 * w * std::sin(pi * w) / pi - (1.0 - std::cos(pi * w)) / (pi * pi)) / (w * w * w / 12.0);
  EXPECT_NEAR(r.rk, -slope * a, 3.0 * near);
  EXPECT_EQ(r.rmrk1, 0.0);
  EXPECT_EQ(r.rpk, 0.0);
  const double level = mean + slope * (1.0 - 0.5 * w), from = std::acos(level) / pi;
  EXPECT_NEAR(r.rmrk2, from, 1e-3);
  // A triangle as wide as what lies below the line and as large.
  EXPECT_NEAR(r.rvk, 2.0 * a * (level + std::sin(pi * from) / (pi * (1.0 - from))), 5.0 * near);
}

// Section lengths of unlike heights: Rz, Rp and Rv are means of theirs, Rt is of all.
TEST(Roughness, MeansAreOfSectionLengthsAndTheTotalIsOfAll) {
  std::vector<double> heights(501);
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = 0.01 * std::sin(kTurn * static_cast<double>(i) / 10.0);
  const Section section = [&] {
    heights[120] = 3.0;
    heights[330] = -2.0;
    return profileOf(heights, 1.0);
  }();
  const auto profile = roughnessProfile(section, {0.0, 500.0}, {100.0});
  ASSERT_TRUE(profile);
  ASSERT_EQ(profile->lengths, 4);
  double up = 0.0, down = 0.0, most = -1e9, least = 1e9, tallest = 0.0;
  for (int k = 0; k < 4; ++k) {
    double high = -1e9, low = 1e9;
    for (std::size_t i = profile->lengths_begin[static_cast<std::size_t>(k)];
         i <= profile->lengths_begin[static_cast<std::size_t>(k) + 1]; ++i) {
      high = std::max(high, profile->heights[i]);
      low = std::min(low, profile->heights[i]);
    }
    tallest = std::max(tallest, high - low);
    up += high / 4.0;
    down -= low / 4.0;
    most = std::max(most, high);
    least = std::min(least, low);
  }
  const Roughness r = measured(section, 100.0);
  EXPECT_DOUBLE_EQ(r.rp, up);
  EXPECT_DOUBLE_EQ(r.rv, down);
  EXPECT_DOUBLE_EQ(r.rzx, tallest);
  EXPECT_GT(r.rzx, 1.1 * r.rz);
  EXPECT_LT(r.rzx, 0.9 * r.rt);
  EXPECT_DOUBLE_EQ(r.rt, most - least);
  EXPECT_GT(r.rt, 1.5 * r.rz);
}

// What is flat, and what is too short for a slope, has a figure or none, never infinity.
TEST(Roughness, FlatProfilesHaveNoRatios) {
  const Roughness flat = measured(profileOf(std::vector<double>(101, 0.0), 0.01), 0.1);
  EXPECT_EQ(flat.rt, 0.0);
  EXPECT_EQ(flat.rdq, 0.0);
  EXPECT_TRUE(std::isnan(flat.rc));
  EXPECT_TRUE(std::isnan(flat.rmrk1) && std::isnan(flat.rmrk2));
  std::vector<double> few(10, 0.0);
  few[4] = 1.0;
  const Roughness shorter = measured(profileOf(few, 1.0), 4.0);
  EXPECT_TRUE(std::isnan(shorter.rdq)) << "five places";
  for (const RoughnessInfo& info : roughnessInfos())
    EXPECT_FALSE(std::isinf(shorter.*info.figure)) << info.key;
}

TEST(Roughness, RefusesWhatACutOffDoesNotFit) {
  std::vector<double> heights(101, 0.0);
  const Section flat = profileOf(heights, 0.01);
  EXPECT_FALSE(roughnessOf(flat, {0.0, 1.0}, {0.03}));
  EXPECT_FALSE(roughnessOf(flat, {0.0, 1.0}, {0.6}));
  EXPECT_FALSE(roughnessOf(flat, {2.0, 3.0}, {0.1}));
  EXPECT_FALSE(roughnessOf(flat, {0.0, 1.0}, {0.1, 0.03})) << "a lambda s of three places";
  EXPECT_FALSE(roughnessOf(flat, {0.0, 1.0}, {0.1, 0.1})) << "nothing between";
  EXPECT_FALSE(roughnessOf(flat, {0.0, 1.0}, {0.48, 0.2})) << "its ends leave less than two cut-offs";
  const Roughness r = measured(flat, 0.1);
  EXPECT_EQ(r.rq, 0.0);
  EXPECT_TRUE(std::isnan(r.rsk));
  EXPECT_TRUE(std::isnan(r.rsm));
  // The longest part without a hole counts.
  heights[40] = std::numeric_limits<double>::quiet_NaN();
  const Roughness part = measured(profileOf(heights, 0.01), 0.1);
  EXPECT_GT(part.evaluated.from_mm, 0.41);
  EXPECT_EQ(part.lengths, 4);
}

}  // namespace
}  // namespace fettle::engine
