#include "engine/measure/spatial.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/measure/plane_transform.h"
#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

using std::numbers::pi;

SpatialAnalysis analysed(const Surface& surface) {
  JobControl job;
  const auto result = correlate(surface, job);
  EXPECT_TRUE(result) << result.error().line();
  return result ? *result : SpatialAnalysis{};
}

// Noise through a Gaussian with standard deviations `a` along a line at `degrees` and `b` across it, in units of x:
// its autocorrelation is exp(-(u / 2a)^2 - (v / 2b)^2).
Surface randomTexture(std::int32_t side, double a, double b, double degrees, double spacing_y,
                      unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const int reach = static_cast<int>(std::ceil(4.0 * std::max(a, b)));
  const int wide = side + 2 * reach;
  std::vector<double> noise(static_cast<std::size_t>(wide) * wide);
  for (double& z : noise) z = normal(random);
  std::vector<double> kernel;
  const double cosine = std::cos(degrees * pi / 180.0), sine = std::sin(degrees * pi / 180.0);
  for (int r = -reach; r <= reach; ++r)
    for (int c = -reach; c <= reach; ++c) {
      const double x = c, y = r * spacing_y;
      const double u = (x * cosine + y * sine) / a, v = (y * cosine - x * sine) / b;
      kernel.push_back(std::exp(-0.5 * (u * u + v * v)));
    }
  Surface surface = surfaceOf(side, side, [&](int column, int row) {
    double sum = 0.0;
    std::size_t k = 0;
    for (int r = 0; r <= 2 * reach; ++r)
      for (int c = 0; c <= 2 * reach; ++c)
        sum += kernel[k++] *
               noise[static_cast<std::size_t>(row + r) * wide + static_cast<std::size_t>(column + c)];
    return sum;
  });
  surface.spacing_y = spacing_y;
  return surface;
}

TEST(PlaneTransform, IsTheSumOfWaves) {
  constexpr int kWidth = 12, kHeight = 10;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<std::complex<double>> values(kWidth * kHeight);
  for (auto& value : values) value = {normal(random), normal(random)};
  JobControl job;
  auto forward = values;
  transformPlane(forward, kWidth, kHeight, Transform::kForward, job);
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) {
      std::complex<double> sum;
      for (int r = 0; r < kHeight; ++r)
        for (int c = 0; c < kWidth; ++c)
          sum += values[static_cast<std::size_t>(r * kWidth + c)] *
                 std::polar(1.0, -2.0 * pi * (u * c / 12.0 + v * r / 10.0));
      EXPECT_LT(std::abs(forward[static_cast<std::size_t>(v * kWidth + u)] - sum), 1e-12);
    }
  transformPlane(forward, kWidth, kHeight, Transform::kBackward, job);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_LT(std::abs(forward[i] / 120.0 - values[i]), 1e-14);
  EXPECT_EQ(transformLength(1), 1);
  EXPECT_EQ(transformLength(7), 8);
  EXPECT_EQ(transformLength(721), 729);
}

// Every lag by plain sums over the samples that both have.
TEST(Spatial, CorrelationIsWhatPlainLoopsFind) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  const Surface surface = surfaceOf(23, 18, [&](int c, int r) {
    const double z = normal(random);
    return (c * 3 + r * 7) % 10 == 0 || (c > 15 && r > 11) ? std::nan("") : 1e3 * z;
  });
  const Autocorrelation correlation = analysed(surface).correlation;
  ASSERT_EQ(correlation.lags_x, 11);
  ASSERT_EQ(correlation.lags_y, 9);
  long double square = 0;
  for (const float z : surface.heights)
    if (!std::isnan(z)) square += static_cast<long double>(z) * z;
  square /= surface.samples;
  int stated = 0;
  for (int ty = -9; ty <= 9; ++ty)
    for (int tx = -11; tx <= 11; ++tx) {
      long double sum = 0;
      int pairs = 0;
      for (int r = std::max(0, -ty); r < std::min(18, 18 - ty); ++r)
        for (int c = std::max(0, -tx); c < std::min(23, 23 - tx); ++c) {
          const long double product = static_cast<long double>(surface.at(c, r)) * surface.at(c + tx, r + ty);
          if (!std::isnan(product)) sum += product, ++pairs;
        }
      if (16 * pairs < surface.samples) {
        EXPECT_TRUE(std::isnan(correlation.at(tx, ty)));
        continue;
      }
      ++stated;
      EXPECT_NEAR(correlation.at(tx, ty), static_cast<double>(sum / pairs / square), 1e-13)
          << tx << ", " << ty;
    }
  EXPECT_GT(stated, 400);
  EXPECT_DOUBLE_EQ(correlation.at(0, 0), 1.0);
}

// Between lags the cosine is its chord: where that is 0.2.
double chordOfCosine(double k, double level) {
  int lag = 0;
  while (std::cos(k * (lag + 1)) > level) ++lag;
  const double high = std::cos(k * lag), low = std::cos(k * (lag + 1));
  return lag + (high - level) / (high - low);
}

// Rows of sines whose phases make whole turns over the field: along x the products' other half is 0, exactly.
TEST(Spatial, OfASineDecaysAsItsCosine) {
  constexpr double k = 2.0 * pi / 37.3;
  Surface surface =
      surfaceOf(200, 160, [](int c, int r) { return 2.5 * std::sin(k * c + 2.0 * pi * 7 * r / 160.0); });
  surface.spacing_x = 0.01;
  surface.spacing_y = 0.04;
  const SpatialAnalysis analysis = analysed(surface);
  for (int tx = 0; tx <= 100; ++tx) ASSERT_NEAR(analysis.correlation.at(tx, 0), std::cos(k * tx), 1e-6) << tx;
  EXPECT_NEAR(analysis.correlation.decay(0.0, 0.2) / (0.01 * chordOfCosine(k, 0.2)), 1.0, 1e-6);
  // A plane wave: fastest along its wave vector, in which it is shorter; along the crests it never falls.
  const double kx = k / 0.01, ky = 2.0 * pi * 7 / 160.0 / 0.04, length = std::hypot(kx, ky);
  EXPECT_NEAR(analysis.parameters.sal, std::acos(0.2) / length, 0.01 * std::acos(0.2) / length);
  EXPECT_TRUE(std::isnan(analysis.parameters.str));
  EXPECT_NE(analysis.parameters.no_str.find("stays above"), std::string::npos) << analysis.parameters.no_str;
  const double lay = std::atan2(ky, kx) * 180.0 / pi + 90.0;
  EXPECT_NEAR(analysis.parameters.lay, lay, 0.5);
}

// The decay on a function that is known everywhere: bilinear patches, walked through in steps of 1e-5 of a lag.
TEST(Spatial, DecayIsWhereBilinearPatchesFall) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> part(-0.2, 0.2);
  Autocorrelation correlation;
  correlation.lags_x = 12;
  correlation.lags_y = 9;
  correlation.spacing_x = 0.5;
  correlation.spacing_y = 2.0;
  for (int ty = 0; ty <= 9; ++ty)
    for (int tx = -12; tx <= 12; ++tx)
      correlation.values.push_back(tx == 0 && ty == 0 ? 1.0
                                                      : std::exp(-0.2 * std::hypot(tx, ty)) + part(random));
  // Row 0 is its own mirror.
  for (int tx = 1; tx <= 12; ++tx)
    correlation.values[static_cast<std::size_t>(12 - tx)] =
        correlation.values[static_cast<std::size_t>(12 + tx)];
  int fell = 0;
  for (int i = 0; i < 90; ++i) {
    const double angle = pi * i / 90.0 + (i % 3 == 0 ? 0.0 : 0.01);
    double plain = std::numeric_limits<double>::infinity();
    for (double distance = 0.0;; distance += 5e-6) {
      const double x = distance * std::cos(angle) / 0.5, y = distance * std::sin(angle) / 2.0;
      const double left = std::floor(x), low = std::floor(y);
      if (x < -12 || x >= 12 || y >= 9) break;
      const double u = x - left, v = y - low;
      const auto at = [&](double c, double r) {
        return correlation.at(static_cast<int>(c), static_cast<int>(r));
      };
      const double value = (1 - v) * ((1 - u) * at(left, low) + u * at(left + 1, low)) +
                           v * ((1 - u) * at(left, low + 1) + u * at(left + 1, low + 1));
      if (value <= 0.2) {
        plain = distance;
        break;
      }
    }
    if (std::isinf(plain)) continue;
    ++fell;
    EXPECT_NEAR(correlation.decay(angle, 0.2), plain, 1e-5) << i;
  }
  EXPECT_GT(fell, 60);
}

// Of a Gaussian autocorrelation exp(-(u / 2a)^2 - (v / 2b)^2): sal = 2 b sqrt(ln 5), str = b / a, the lay along u.
TEST(Spatial, OfARandomSurfaceOfKnownSpectrumIsItsClosedForm) {
  struct Case {
    double a, b, degrees, spacing_y;
  };
  for (const Case& c :
       {Case{5.0, 2.0, 0.0, 1.0}, {5.0, 2.0, 30.0, 1.0}, {5.0, 2.5, 120.0, 4.0}, {2.5, 2.5, 0.0, 1.0}}) {
    const SpatialParameters p = analysed(randomTexture(256, c.a, c.b, c.degrees, c.spacing_y, 7)).parameters;
    // 256^2 / (4 pi a b) > 1,600 independent patches: 2.5 % of the autocorrelation, 5 % of lengths; two of each.
    EXPECT_NEAR(p.sal / (2.0 * c.b * std::sqrt(std::log(5.0))), 1.0, 0.1) << c.degrees;
    EXPECT_NEAR(p.str * c.a / c.b, c.a == c.b ? 0.93 : 1.0, 0.12) << c.degrees;
    if (c.a == c.b) continue;
    EXPECT_NEAR(std::remainder(p.lay - c.degrees, 180.0), 0.0, 4.0) << c.degrees;
    EXPECT_NEAR(std::remainder(p.slow_direction - c.degrees, 180.0), 0.0, 6.0) << c.degrees;
  }
}

// Of lengths only their ratios count: on a grid 1024 times as fine lengths are so much shorter, and ratios have the same bits.
TEST(Spatial, RatiosAreTheSameOnAnyScale) {
  Surface surface = randomTexture(96, 1.5, 4.0, 30.0, 1.0, 3);
  const SpatialParameters coarse = analysed(surface).parameters;
  surface.spacing_x *= 0x1p-10;
  surface.spacing_y *= 0x1p-10;
  const SpatialParameters fine = analysed(surface).parameters;
  EXPECT_GT(coarse.str, 0.0);
  EXPECT_EQ(fine.str, coarse.str);
  EXPECT_EQ(fine.str_lowered, coarse.str_lowered);
  EXPECT_EQ(fine.sal, coarse.sal * 0x1p-10);
}

// Of all directions, also on small fields of noise, whose autocorrelation goes up and down about 0.2.
TEST(Spatial, NoDirectionDecaysFasterThanTheFastestOrSlowerThanTheSlowest) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const SpatialAnalysis analysis = analysed(randomTexture(24, 1.5, 1.0, 9.0 * seed, 1.0, seed));
    const SpatialParameters& p = analysis.parameters;
    ASSERT_TRUE(std::isfinite(p.sal)) << p.no_sal;
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (int i = 0; i < 1440; ++i) {
      const double distance = analysis.correlation.decay(pi * i / 1440, 0.2);
      least = std::min(least, distance);
      most = std::max(most, distance);
    }
    EXPECT_LE(p.sal, least) << seed;
    // The direction is rounded to degrees and back.
    EXPECT_NEAR(p.sal, analysis.correlation.decay(p.sal_direction * pi / 180.0, 0.2), 1e-12) << seed;
    if (std::isfinite(most)) {
      EXPECT_LE(p.str, p.sal / most) << seed;
    }
  }
}

TEST(Spatial, OfHardSurfacesIsAFigureOrAReason) {
  const auto check = [](const Surface& surface) {
    const SpatialParameters p = analysed(surface).parameters;
    EXPECT_EQ(std::isfinite(p.sal), p.no_sal.empty()) << p.no_sal;
    EXPECT_EQ(std::isfinite(p.str), p.no_str.empty()) << p.no_str;
    EXPECT_EQ(std::isfinite(p.lay), p.no_lay.empty()) << p.no_lay;
    // Without a lay there is none either were a part of it noise.
    if (!p.no_lay.empty()) {
      for (const double lay : p.lay_less) EXPECT_TRUE(std::isnan(lay));
    }
    return p;
  };
  EXPECT_FALSE(check(surfaceOf(0, 0, {})).no_sal.empty());
  EXPECT_FALSE(check(surfaceOf(500, 1, [](int c, int) { return c % 7; })).no_sal.empty());
  EXPECT_FALSE(check(surfaceOf(3, 1, [](int c, int) { return c; })).no_sal.empty());
  EXPECT_FALSE(check(surfaceOf(40, 40, [](int, int) { return 0.0; })).no_sal.empty());
  check(surfaceOf(40, 40, [](int c, int r) { return c == r ? std::nan("") : 0.01 * c; }));
  check(surfaceOf(4, 4, [](int c, int r) { return (c + r) % 2 == 0 ? 1.0 : -1.0; }));
  // A spike is correlated with nothing: linear from 1 to 0 in a sample.
  const SpatialParameters spike =
      check(surfaceOf(64, 64, [](int c, int r) { return c == 20 && r == 30 ? 1e6 : 0.0; }));
  EXPECT_NEAR(spike.sal, 1.0 - std::sqrt(0.2), 0.3);
  // Samples on a diagonal alone have no lag across it.
  check(surfaceOf(40, 40, [](int c, int r) { return c == r ? std::sin(0.5 * c) : std::nan(""); }));
  JobControl job;
  job.cancel();
  EXPECT_EQ(correlate(surfaceOf(40, 40, [](int c, int) { return c; }), job).error().kind,
            ErrorKind::kCancelled);
}

TEST(Spatial, IsBitIdenticalForAnyNumberOfThreads) {
  const Surface surface = randomTexture(90, 3.0, 2.0, 20.0, 1.0, 3);
  const auto with = [&](int threads) {
    SpatialAnalysis analysis;
    tbb::task_arena arena(threads);
    arena.execute([&] { analysis = analysed(surface); });
    std::vector<double> all = analysis.correlation.values;
    all.push_back(analysis.parameters.sal);
    all.push_back(analysis.parameters.str);
    all.push_back(analysis.parameters.lay);
    return all;
  };
  const auto one = with(1);
  for (const int threads : {2, 4}) EXPECT_EQ(with(threads), one);
}

}  // namespace
}  // namespace fettle::engine
