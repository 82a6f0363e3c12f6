#include "engine/measure/hills.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

std::vector<Hill> hillsOf(const Surface& surface, double least) {
  JobControl job;
  const auto hills = segmentHills(surface, least, job);
  EXPECT_TRUE(hills) << hills.error().line();
  return hills ? *hills : std::vector<Hill>{};
}

FeatureParameters featuresOf(const Surface& surface, double sz) {
  JobControl job;
  const auto features = measureFeatures(surface, sz, 0.05, job);
  EXPECT_TRUE(features) << features.error().line();
  return features ? *features : FeatureParameters{};
}

// The widest way between any two samples by Floyd and Warshall's loops: the height over which a peak must come down on
// its way to a higher one.
std::vector<Hill> plainHills(const Surface& surface, double least) {
  const int width = surface.width, n = surface.width * surface.height;
  const double none = -std::numeric_limits<double>::infinity();
  std::vector<double> way(static_cast<std::size_t>(n * n), none);
  const auto z = [&](int i) { return static_cast<double>(surface.heights[static_cast<std::size_t>(i)]); };
  const auto at = [&](int a, int b) -> double& { return way[static_cast<std::size_t>(a * n + b)]; };
  const auto link = [&](int a, int b, double height) {
    if (std::isnan(height)) return;
    at(a, b) = at(b, a) = std::max(at(a, b), height);
  };
  for (int r = 0; r < surface.height; ++r)
    for (int c = 0; c < width; ++c) {
      const int i = r * width + c;
      if (!std::isnan(z(i))) at(i, i) = z(i);
      if (c + 1 < width) link(i, i + 1, z(i) < z(i + 1) ? z(i) : std::isnan(z(i)) ? z(i) : z(i + 1));
      if (r + 1 < surface.height)
        link(i, i + width, z(i) < z(i + width) ? z(i) : std::isnan(z(i)) ? z(i) : z(i + width));
      if (c + 1 == width || r + 1 == surface.height) continue;
      // The highest way across the cell, by its saddle.
      const double a = z(i), b = z(i + 1), d = z(i + width), e = z(i + width + 1);
      if (std::isnan(a + b + d + e)) continue;
      const double saddle = static_cast<float>((a * e - b * d) / (a + e - b - d));
      if (std::min(a, e) > std::max(b, d)) link(i, i + width + 1, saddle);
      if (std::min(b, d) > std::max(a, e)) link(i + 1, i + width, saddle);
    }
  for (int k = 0; k < n; ++k)
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b) at(a, b) = std::max(at(a, b), std::min(at(a, k), at(k, b)));
  std::vector<Hill> hills;
  for (int p = 0; p < n; ++p) {
    if (std::isnan(z(p))) continue;
    double saddle = none, lowest = z(p);
    for (int q = 0; q < n; ++q) {
      if (at(p, q) == none) continue;
      lowest = std::min(lowest, z(q));
      if (z(q) > z(p)) saddle = std::max(saddle, at(p, q));
    }
    const double height = z(p) - (saddle == none ? lowest : saddle);
    if (height >= least && height > 0.0) hills.push_back({p % width, p / width, z(p), height});
  }
  std::sort(hills.begin(), hills.end(), [](const Hill& a, const Hill& b) { return a.peak > b.peak; });
  return hills;
}

TEST(Hills, AreWhatPlainLoopsFind) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const Surface surface = surfaceOf(11, 10, [&](int, int) {
      const double z = normal(random);
      return seed > 6 && z < -0.7 ? std::nan("") : z;
    });
    for (const double least : {0.0, 0.3, 1.0}) {
      const std::vector<Hill> seen = hillsOf(surface, least), wanted = plainHills(surface, least);
      ASSERT_EQ(seen.size(), wanted.size()) << seed << ", " << least;
      for (std::size_t i = 0; i < seen.size(); ++i) {
        EXPECT_EQ(seen[i].column, wanted[i].column);
        EXPECT_EQ(seen[i].row, wanted[i].row);
        EXPECT_EQ(seen[i].height, wanted[i].height);
      }
    }
  }
}

// Watersheds by the words of their definition: each sample follows its highest neighbour up to a peak; then, as long as a hill is lower than `least` over
// its highest saddle, the lowest of these becomes part of the hill across that saddle. Saddles are the lower of two neighbours of
// different hills, and passes across cells.
std::vector<int> plainMap(const Surface& surface, double least) {
  const int width = surface.width, n = surface.width * surface.height;
  const auto z = [&](int i) { return static_cast<double>(surface.heights[static_cast<std::size_t>(i)]); };
  struct Way {
    int a, b;
    double height;
  };
  std::vector<Way> ways;
  for (int r = 0; r < surface.height; ++r)
    for (int c = 0; c < width; ++c) {
      const int i = r * width + c;
      if (c + 1 < width && !std::isnan(z(i) + z(i + 1))) ways.push_back({i, i + 1, std::min(z(i), z(i + 1))});
      if (r + 1 < surface.height && !std::isnan(z(i) + z(i + width)))
        ways.push_back({i, i + width, std::min(z(i), z(i + width))});
      if (c + 1 == width || r + 1 == surface.height) continue;
      const double a = z(i), b = z(i + 1), d = z(i + width), e = z(i + width + 1);
      if (std::isnan(a + b + d + e)) continue;
      const double saddle = static_cast<float>((a * e - b * d) / (a + e - b - d));
      if (std::min(a, e) > std::max(b, d)) ways.push_back({i, i + width + 1, saddle});
      if (std::min(b, d) > std::max(a, e)) ways.push_back({i + 1, i + width, saddle});
    }
  std::vector<int> peak(static_cast<std::size_t>(n), -1);
  for (int i = 0; i < n; ++i) {
    if (std::isnan(z(i))) continue;
    int at = i;
    for (bool rises = true; rises;) {
      rises = false;
      int best = at;
      const int c = at % width, r = at / width;
      for (const auto& [dc, dr] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        if (c + dc < 0 || c + dc >= width || r + dr < 0 || r + dr >= surface.height) continue;
        const int other = (r + dr) * width + c + dc;
        if (z(other) > z(best)) best = other;
      }
      rises = best != at;
      at = best;
    }
    peak[static_cast<std::size_t>(i)] = at;
  }
  for (;;) {
    double lowest = least;
    int from = -1, to = -1;
    for (int p = 0; p < n; ++p) {
      if (std::isnan(z(p)) || peak[static_cast<std::size_t>(p)] != p) continue;
      double saddle = -std::numeric_limits<double>::infinity();
      int across = -1;
      for (const Way& way : ways) {
        const int a = peak[static_cast<std::size_t>(way.a)], b = peak[static_cast<std::size_t>(way.b)];
        if (a == b || (a != p && b != p) || way.height <= saddle) continue;
        saddle = way.height;
        across = a == p ? b : a;
      }
      // The highest of its part has no saddle to a higher one.
      if (across < 0 || z(across) < z(p)) continue;
      if (z(p) - saddle < lowest) {
        lowest = z(p) - saddle;
        from = p;
        to = across;
      }
    }
    if (from < 0) return peak;
    std::replace(peak.begin(), peak.end(), from, to);
  }
}

TEST(Hills, EverySampleIsOfTheHillThatTheDefinitionSays) {
  int samples = 0, elsewhere = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const Surface surface = surfaceOf(13, 11, [&](int c, int r) {
      const double z = normal(random) + std::sin(c * 0.8) + std::cos(r * 0.7);
      return seed > 6 && z < -1.5 ? std::nan("") : z;
    });
    for (const double least : {0.0, 0.4, 1.2}) {
      JobControl job;
      const auto map = mapHills(surface, least, job);
      ASSERT_TRUE(map);
      const std::vector<Hill> hills = hillsOf(surface, least);
      ASSERT_EQ(map->hills.size(), hills.size());
      const std::vector<int> plain = plainMap(surface, least);
      for (std::size_t i = 0; i < plain.size(); ++i) {
        const std::int32_t number = map->of[i];
        if (number == HillMap::kNone) continue;
        const Hill& hill = map->hills[static_cast<std::size_t>(number)];
        ++samples;
        elsewhere += hill.row * surface.width + hill.column == plain[i] ? 0 : 1;
      }
    }
  }
  EXPECT_GT(samples, 4000);
  EXPECT_EQ(elsewhere, 0);
}

// Two cones on a plane: half of the plane each, the cones' own volumes over their saddle.
TEST(Hills, OfTwoConesHaveTheirAreasAndVolumes) {
  constexpr int kWide = 161, kHigh = 81;
  Surface surface = surfaceOf(kWide, kHigh, [](int c, int r) {
    const double left = std::hypot(c - 40.0, r - 40.0), right = std::hypot(c - 120.0, r - 40.0);
    return std::max({3.0 - 0.1 * left, 2.0 - 0.1 * right, -0.001 * std::min(left, right)});
  });
  surface.spacing_x = 0.5;
  surface.spacing_y = 0.5;
  surface.height_mm = 0.01;
  JobControl job;
  const auto map = mapHills(surface, 0.2, job);
  ASSERT_TRUE(map);
  ASSERT_EQ(map->hills.size(), 2U);
  const auto figures = figuresOfHills(surface, *map);
  EXPECT_EQ(figures[0].samples + figures[1].samples, kWide * kHigh);
  EXPECT_NEAR(static_cast<double>(figures[0].samples), 0.5 * kWide * kHigh, 0.02 * kWide * kHigh);
  // The saddle lies at about -0.04; a cone of height h and slope 0.1 has a volume of pi h (10 h)^2 / 3, with its foot of the plane above the saddle.
  const double saddle = figures[1].hill.peak - figures[1].hill.height;
  EXPECT_NEAR(saddle, -0.04, 0.002);
  const auto cone = [](double height) { return std::numbers::pi * height * 100.0 * height * height / 3.0; };
  EXPECT_NEAR(figures[1].volume_mm3 / (0.25 * 0.01), cone(2.0),
              0.05 * cone(2.0) + 0.04 * static_cast<double>(figures[1].samples));
  EXPECT_GT(figures[1].volume_mm3 / (0.25 * 0.01), 0.97 * cone(2.0));
  EXPECT_DOUBLE_EQ(figures[0].area_mm2, 0.25 * static_cast<double>(figures[0].samples));
  EXPECT_TRUE(figures[0].open) << "the highest has no saddle but the lowest sample";
}

// A bump of 4 % of the height is part of the slope that it stands on, one of 6 % is a hill.
TEST(Hills, BelowFivePerCentArePruned) {
  for (const auto& [share, count] : {std::pair{0.04, 1}, {0.06, 2}}) {
    const double bump = share;
    const Surface surface = surfaceOf(41, 5, [&](int c, int) {
      const double ramp = 1.0 - c / 40.0;
      return c == 20 ? ramp + 1.0 / 40.0 + bump : ramp;
    });
    // The saddle is the sample before the bump, one step of the ramp above it.
    EXPECT_EQ(featuresOf(surface, 1.0).hills, count) << share;
  }
}

TEST(Hills, OfAParaboloidIsOneOfItsCurvature) {
  Surface surface = surfaceOf(41, 33, [](int c, int r) {
    return -((c - 20.0) * (c - 20.0) + 16.0 * (r - 15.0) * (r - 15.0)) / 2048.0;
  });
  surface.spacing_y = 4.0;
  surface.height_mm = 0.5;
  const FeatureParameters p = featuresOf(surface, 4.0);
  EXPECT_EQ(p.hills, 1);
  EXPECT_DOUBLE_EQ(p.spc, 0.5 / 1024.0);
  EXPECT_DOUBLE_EQ(p.spd, 1.0 / (41.0 * 33.0 * 4.0));
}

// Of radius R: 1 / R, and by second differences (2 R - 2 sqrt(R^2 - h^2)) / h^2.
TEST(Hills, OfASphereIsOneOfItsRadius) {
  constexpr double kRadius = 40.0;
  const Surface surface = surfaceOf(15, 15, [](int c, int r) {
    return std::sqrt(kRadius * kRadius - (c - 7) * (c - 7) - (r - 7) * (r - 7)) - kRadius;
  });
  const double differences = 2.0 * kRadius - 2.0 * std::sqrt(kRadius * kRadius - 1.0);
  EXPECT_NEAR(featuresOf(surface, 1.0).spc / differences, 1.0, 1e-6);
  EXPECT_NEAR(differences * kRadius, 1.0, 2e-4);
}

// cos(kx) cos(ky): peaks at half waves of both, every other one; curvature A k^2, by second differences.
TEST(Hills, OfCrossedSinesAreTheirPeaks) {
  constexpr int kWave = 20, kWaves = 6;
  constexpr double k = 2.0 * std::numbers::pi / kWave;
  Surface surface = surfaceOf(kWave * kWaves, kWave * kWaves, [](int c, int r) {
    return 3.0 * std::cos(k * (c - kWave / 4)) * std::cos(k * (r - kWave / 4));
  });
  surface.spacing_x = surface.spacing_y = 0.1;
  const FeatureParameters p = featuresOf(surface, 6.0);
  EXPECT_EQ(p.hills, 2 * kWaves * kWaves);
  EXPECT_DOUBLE_EQ(p.spd, 2.0 / (kWave * kWave * 0.01));
  EXPECT_NEAR(p.spc / (3.0 * 2.0 * (1.0 - std::cos(k)) / 0.01), 1.0, 1e-6);
  EXPECT_EQ(p.curved, p.hills);
}

TEST(Hills, OfHardSurfacesAreAFigureOrAReason) {
  const auto check = [](const Surface& surface, double sz) {
    const FeatureParameters p = featuresOf(surface, sz);
    EXPECT_EQ(std::isfinite(p.spd), p.no_spd.empty()) << p.no_spd;
    EXPECT_EQ(std::isfinite(p.spc), p.no_spc.empty()) << p.no_spc;
    return p;
  };
  EXPECT_FALSE(check(surfaceOf(0, 0, {}), 0.0).no_spd.empty());
  EXPECT_FALSE(check(surfaceOf(9, 1, [](int c, int) { return c % 2; }), 1.0).no_spd.empty());
  EXPECT_FALSE(check(surfaceOf(9, 9, [](int, int) { return 0.0; }), 0.0).no_spd.empty());
  const FeatureParameters slope = check(surfaceOf(9, 9, [](int c, int) { return c; }), 8.0);
  EXPECT_EQ(slope.hills, 1);
  EXPECT_FALSE(slope.no_spc.empty());
  EXPECT_NEAR(check(surfaceOf(9, 9, [](int c, int r) { return c == 4 && r == 4 ? 1e6 : 0.0; }), 1e6).spc, 2e6,
              1.0);
  // Two parts without a link: a hill each.
  EXPECT_EQ(check(surfaceOf(9, 9, [](int c, int r) { return c == 4 ? std::nan("") : -std::abs(r - 4); }), 4.0)
                .hills,
            2);
  JobControl job;
  job.cancel();
  EXPECT_EQ(segmentHills(surfaceOf(400, 400, [](int c, int r) { return c * r; }), 0.0, job).error().kind,
            ErrorKind::kCancelled);
}

// Its curvature needs a sample on each side, and no more than that.
TEST(Features, APeakBesideTheRimHasACurvatureAndOneOnItHasNone) {
  for (const auto& [column, row, curved] : {std::tuple{4, 3, 1},
                                            {1, 1, 1},
                                            {7, 3, 1},
                                            {4, 5, 1},
                                            {7, 5, 1},
                                            {0, 3, 0},
                                            {8, 3, 0},
                                            {4, 0, 0},
                                            {4, 6, 0}}) {
    Surface surface = surfaceOf(9, 7, [&](int c, int r) {
      return -0.125 * ((c - column) * (c - column) + 2.0 * (r - row) * (r - row));
    });
    const FeatureParameters features = featuresOf(surface, 10.0);
    EXPECT_EQ(features.hills, 1);
    EXPECT_EQ(features.curved, curved) << column << ' ' << row;
    if (curved > 0) {
      EXPECT_NEAR(features.spc, 0.5 * (0.25 + 0.5), 1e-6) << column << ' ' << row;
    }
  }
}

}  // namespace
}  // namespace fettle::engine
