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
  const auto map = mapHills(surface, least, job);
  EXPECT_TRUE(map) << map.error().line();
  return map ? map->hills : std::vector<Hill>{};
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

// Ways between neighbours of a surface: over the lower one, and over passes across cells.
struct Way {
  int a, b;
  double height;
};
std::vector<Way> waysOf(const Surface& surface) {
  const int width = surface.width;
  const auto z = [&](int i) { return static_cast<double>(surface.heights[static_cast<std::size_t>(i)]); };
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
  return ways;
}

// Watersheds by the words of their definition: each sample follows its highest neighbour up to a peak; then, as long as a hill is lower than `least` over
// its highest saddle, the lowest of these becomes part of the hill across that saddle. Saddles are the lower of two neighbours of
// different hills, and passes across cells.
std::vector<int> plainMap(const Surface& surface, double least) {
  const int width = surface.width, n = surface.width * surface.height;
  const auto z = [&](int i) { return static_cast<double>(surface.heights[static_cast<std::size_t>(i)]); };
  const std::vector<Way> ways = waysOf(surface);
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

// The highest way out of a hill, whether higher ground or lower lies beyond: a hill is no lower over it than pruning demands.
TEST(Hills, SaddlesAreTheHighestWaysToOtherHills) {
  int met = 0, open = 0, cut = 0, closed = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const Surface surface = surfaceOf(31, 27, [&](int c, int r) {
      const double z = 0.2 * normal(random) + std::sin(c * 0.8) + std::cos(r * 0.7);
      return seed > 6 && z < -1.8 ? std::nan("") : z;
    });
    const std::vector<Way> ways = waysOf(surface);
    for (const double least : {0.0, 0.4, 1.2}) {
      JobControl job;
      const auto map = mapHills(surface, least, job);
      ASSERT_TRUE(map);
      const auto figures = figuresOfHills(surface, *map);
      for (std::size_t i = 0; i < figures.size(); ++i) {
        const auto number = static_cast<std::int32_t>(i);
        double saddle = -std::numeric_limits<double>::infinity();
        for (const Way& way : ways) {
          const bool from = map->of[static_cast<std::size_t>(way.a)] == number,
                     to = map->of[static_cast<std::size_t>(way.b)] == number;
          if (from != to) saddle = std::max(saddle, way.height);
        }
        const HillFigures& of = figures[i];
        if (std::isfinite(saddle)) {
          ++met;
          EXPECT_EQ(of.saddle, saddle);
          EXPECT_GE(of.hill.peak - of.saddle, least);
          EXPECT_GE(of.saddle, of.hill.peak - of.hill.height - 1e-12);
        } else {
          EXPECT_DOUBLE_EQ(of.saddle, of.hill.peak - of.hill.height);
        }
        bool reaches = false, reaches_above = false;
        std::int64_t samples = 0;
        double volume = 0.0;
        for (int r = 0; r < surface.height; ++r)
          for (int c = 0; c < surface.width; ++c) {
            if (map->of[static_cast<std::size_t>(r * surface.width + c)] != number) continue;
            bool rim = c == 0 || r == 0 || c + 1 == surface.width || r + 1 == surface.height;
            for (const auto& [dc, dr] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
              rim = rim || std::isnan(surface.at(c + dc, r + dr));
            const double over = surface.at(c, r) - of.saddle;
            ++samples;
            volume += std::max(over, 0.0);
            reaches = reaches || rim;
            reaches_above = reaches_above || (rim && over > 0.0);
          }
        EXPECT_EQ(of.samples, samples);
        EXPECT_NEAR(of.volume_mm3, volume, 1e-12 * volume);
        EXPECT_EQ(of.cut, reaches);
        EXPECT_EQ(of.open, reaches_above);
        open += of.open ? 1 : 0;
        cut += of.cut && !of.open ? 1 : 0;
        closed += of.cut ? 0 : 1;
      }
    }
  }
  EXPECT_GT(met, 500);
  EXPECT_GT(open, 50);
  EXPECT_GT(cut, 10);
  EXPECT_GT(closed, 50);
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
  // The saddle lies at about -0.04, of the higher one too; a cone of height h and slope 0.1 has a volume of pi h (10 h)^2 / 3, with its foot of the plane above the saddle.
  EXPECT_NEAR(figures[1].saddle, -0.04, 0.002);
  EXPECT_EQ(figures[0].saddle, figures[1].saddle);
  const auto cone = [](double height) { return std::numbers::pi * height * 100.0 * height * height / 3.0; };
  EXPECT_NEAR(figures[1].volume_mm3 / (0.25 * 0.01), cone(2.0),
              0.05 * cone(2.0) + 0.04 * static_cast<double>(figures[1].samples));
  EXPECT_GT(figures[1].volume_mm3 / (0.25 * 0.01), 0.97 * cone(2.0));
  EXPECT_DOUBLE_EQ(figures[0].area_mm2, 0.25 * static_cast<double>(figures[0].samples));
  EXPECT_NEAR(figures[0].volume_mm3 / (0.25 * 0.01), cone(3.0),
              0.05 * cone(3.0) + 0.04 * static_cast<double>(figures[0].samples));
  // The border is as low as the saddle between them, and lower.
  EXPECT_TRUE(figures[0].cut);
  EXPECT_FALSE(figures[0].open);
}

TEST(Hills, StopWhenTheJobIsCancelled) {
  JobControl job;
  job.cancel();
  EXPECT_EQ(mapHills(surfaceOf(400, 400, [](int c, int r) { return c * r; }), 0.0, job).error().kind,
            ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
