#include "engine/filter/opening.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/filter/catalogue.h"
#include "engine/filter/region.h"
#include "tests/engine/filter/made_scan.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

constexpr Element kElements[] = {Element::kBall, Element::kDisk, Element::kSquare};

FilterSpec rollingSpec(FilterKind kind, Element element, double radius) {
  FilterSpec spec = nestingSpec(kind, radius);
  spec.element = element;
  return spec;
}

double rough(int c, int r) {
  return std::sin(12.9898 * c + 78.233 * r + 0.01 * c * r) + 3.0 * std::sin(0.1 * c) * std::cos(0.07 * r);
}

double holed(int c, int r) {
  return (c * 5 + r * 3) % 13 == 0 || (c > 30 && c < 60 && r > 10 && r < 30) ? std::nan("") : rough(c, r);
}

// The hard cases: holes, walls, spikes, unequal spacing, one row, bodies of less than the relief and larger than the field, in
// blocks and over the whole field at once.
std::vector<MadeScan> rolledScans() {
  return {
      {"reaches one sample", 70, 66, 0.1, 0.1, 0.1, holed},
      {"in samples", 150, 131, 1.0, 1.0, 7.0, holed},
      {"a multiple of the spacing", 90, 70, 0.1, 0.1, 0.3, holed},
      {"flat ball", 130, 66, 0.1, 0.1, 400.0, holed},
      {"spacing 1:4", 140, 70, 0.25, 1.0, 5.5, holed},
      {"heights in micrometres", 140, 70, 0.01, 0.01, 0.2, [](int c, int r) { return 40.0 * holed(c, r); },
       1e-3},
      {"a wall", 90, 70, 1.0, 1.0, 9.0, [](int c, int r) { return rough(c, r) + (c > 40 ? 50.0 : 0.0); }},
      {"spikes", 100, 90, 1.0, 1.0, 12.0,
       [](int c, int r) {
         return c == 40 && r == 50 ? 1e6 : c == 60 && r == 20 ? -1e6 : 1e-3 * rough(c, r);
       }},
      {"beyond the field", 75, 66, 1.0, 1.0, 1e7, holed},
      {"at once", 330, 24, 1.0, 1.0, 140.0, [](int c, int r) { return 200.0 * holed(c, r); }},
      {"one row", 300, 1, 1.0, 1.0, 11.0, holed},
      {"one column", 1, 300, 1.0, 1.0, 200.0, holed},
      {"one sample", 1, 1, 1.0, 1.0, 2.0, [](int, int) { return 5.0; }},
      {"few samples", 80, 80, 1.0, 1.0, 30.0,
       [](int c, int r) { return (c == 3 && r < 4) || c + r == 150 ? c + r : std::nan(""); }},
      {"denormals", 66, 65, 1.0, 1.0, 4.0, [](int c, int r) { return 1e-42 * (c * 7 % 11 + r % 5); }},
      {"huge", 66, 65, 1.0, 1.0, 4.0, [](int c, int r) { return (c * 7 % 11 - 5) * 6e37 + r; }},
  };
}

// Over the whole element around each sample: of `sign` times the heights, the least sum with the body's depth; then of what
// that leaves turned over.
std::vector<double> plainRolling(const MadeScan& scan, const std::vector<double>& z, FilterKind kind,
                                 Element element) {
  const double sign = kind == FilterKind::kOpening ? 1.0 : -1.0, radius = scan.nesting;
  const auto at = [&](int c, int r) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(scan.width) + c;
  };
  const auto depth = [&](int c, int r) {
    const double x = c * scan.spacing_x, y = r * scan.spacing_y, within = 1.0 + 1e-9;
    if (element == Element::kSquare)
      return std::max(std::fabs(x), std::fabs(y)) <= radius * within
                 ? 0.0
                 : std::numeric_limits<double>::infinity();
    const double d = x * x + y * y;
    if (d > radius * radius * within) return std::numeric_limits<double>::infinity();
    if (element == Element::kDisk) return 0.0;
    return d / (radius + std::sqrt(std::max(0.0, radius * radius - d))) / scan.height_mm;
  };
  const auto eroded = [&](const std::vector<double>& from) {
    std::vector<double> low(from.size(), std::nan(""));
    const int reach_x =
        static_cast<int>(std::min(scan.width * 1.0, std::floor(radius / scan.spacing_x) + 1.0));
    const int reach_y =
        static_cast<int>(std::min(scan.height * 1.0, std::floor(radius / scan.spacing_y) + 1.0));
    std::vector<double> depths;
    for (int v = 0; v <= reach_y; ++v)
      for (int u = 0; u <= reach_x; ++u) depths.push_back(depth(u, v));
    for (int r = 0; r < scan.height; ++r)
      for (int c = 0; c < scan.width; ++c) {
        if (std::isnan(from[at(c, r)])) continue;
        double least = std::numeric_limits<double>::infinity();
        for (int v = std::max(0, r - reach_y); v <= std::min(scan.height - 1, r + reach_y); ++v)
          for (int u = std::max(0, c - reach_x); u <= std::min(scan.width - 1, c + reach_x); ++u) {
            const double h = from[at(u, v)];
            if (!std::isnan(h))
              least = std::min(
                  least,
                  h + depths[static_cast<std::size_t>(std::abs(v - r) * (reach_x + 1) + std::abs(u - c))]);
          }
        low[at(c, r)] = least;
      }
    return low;
  };
  std::vector<double> heights;
  for (const double h : z) heights.push_back(sign * h);
  std::vector<double> low = eroded(heights);
  for (double& h : low) h = -h;
  low = eroded(low);
  for (double& h : low) h = -sign * h;
  return low;
}

TEST(Opening, IsWhatGoingOverTheElementFinds) {
  for (const MadeScan& scan : rolledScans())
    for (const Element element : kElements)
      for (const FilterKind kind : {FilterKind::kOpening, FilterKind::kClosing}) {
        const Version field = versionOf(scan);
        const std::vector<double> z = heightsOf(field), plain = plainRolling(scan, z, kind, element);
        const PlainField got = toPlain(filtered(field, rollingSpec(kind, element, scan.nesting)).field);
        double largest = 0.0;
        for (const double height : z)
          if (!std::isnan(height)) largest = std::max(largest, std::fabs(height));
        // The ball's depth at its rim, no farther away than a field can be wide.
        const double far = Grid::kMaxSide * std::hypot(scan.spacing_x, scan.spacing_y);
        const double rim = std::min(scan.nesting, far * far / scan.nesting) / scan.height_mm;
        const double bound = element == Element::kBall ? 0x1p-50 * (largest + rim) : 0.0;
        int wrong = 0, touched = 0, there = 0;
        for (std::size_t i = 0; i < z.size(); ++i) {
          ASSERT_EQ(std::isnan(z[i]), std::isnan(got.z[i])) << scan.name;
          if (std::isnan(z[i])) continue;
          const double rounded = element == Element::kBall ? 0.5 * static_cast<double>(ulp(got.z[i])) : 0.0;
          wrong += std::fabs(got.z[i] - plain[i]) > rounded + bound;
          wrong += kind == FilterKind::kOpening ? got.z[i] > z[i] : got.z[i] < z[i];
          touched += got.z[i] == z[i], ++there;
        }
        EXPECT_EQ(wrong, 0) << scan.name << ", " << name(kind) << ", "
                            << kElementWords[static_cast<std::size_t>(element)];
        EXPECT_GT(touched, 0) << scan.name;
      }
}

TEST(Opening, OfWhatItLeftLeavesItAsItIs) {
  for (const MadeScan& scan : rolledScans())
    for (const Element element : kElements)
      for (const FilterKind kind : {FilterKind::kOpening, FilterKind::kClosing}) {
        const FilterSpec spec = rollingSpec(kind, element, scan.nesting);
        const Version once = filtered(versionOf(scan), spec).field;
        const FilterReport again = filtered(once, spec).report;
        if (element != Element::kBall) {
          EXPECT_EQ(again.changed, 0) << scan.name;
        } else {
          // What was rounded to float may lie half of its last place above the ball.
          double largest = 0.0;
          for (const double z : heightsOf(once))
            if (!std::isnan(z)) largest = std::max(largest, static_cast<double>(ulp(static_cast<float>(z))));
          EXPECT_LE(again.max_change, 1.01 * largest) << scan.name;
        }
      }
}

// A groove of width w from above: its middle is filled to R - sqrt(R^2 - (w / 2)^2) below its rims.
TEST(Closing, OfAGrooveIsTheArcBetweenItsRims) {
  const MadeScan scan{
      "groove", 121, 41, 0.1, 0.2, 5.0, [](int c, int) { return c > 40 && c < 80 ? -50.0 : 2.0; }};
  const Version closed =
      filtered(versionOf(scan), rollingSpec(FilterKind::kClosing, Element::kBall, scan.nesting)).field;
  for (int c = 0; c <= 120; ++c) {
    const double x = 0.1 * (c - 60);
    const double arc = std::fabs(x) < 2.0 ? 2.0 + std::sqrt(25.0 - 4.0) - std::sqrt(25.0 - x * x) : 2.0;
    EXPECT_NEAR(closed.reader().heightAt(c, 20), arc, 3e-7) << c;
  }
}

// Of a sphere larger than the ball nothing is taken from below but at borders, of a smaller one all that is beside its top from
// above is filled: to the surface of the ball of radius R on that of radius r.
// A ball whose middle could lie anywhere leaves an arc of its own radius that touches both sides of a sharp groove. The one that lies
// on samples alone lies higher by what a side rises from the groove's line to the nearest of them: docs/decisions/rolled-balls.md.
TEST(Closing, OfASharpGrooveIsHalfASpacingTimesTheSlopeTooHighAtMost) {
  constexpr int kAcross = 160, kAlong = 64, kMiddle = 80;
  for (const double degrees : {10.0, 30.0, 60.0}) {
    const double slope = std::tan(degrees * std::numbers::pi / 180.0);
    for (const double radius : {5.0, 20.0}) {
      double most = 0.0;
      for (const double beside : {0.0, 0.25, 0.5}) {
        const auto groove = [&](int c) { return slope * std::abs(c - kMiddle - beside); };
        const MadeScan scan{
            "groove", kAcross, kAlong, 1.0, 1.0, radius, [&](int c, int) { return groove(c); }};
        const Version closed =
            filtered(versionOf(scan), rollingSpec(FilterKind::kClosing, Element::kBall, radius)).field;
        for (int c = 40; c < 120; ++c) {
          const double u = c - kMiddle - beside;
          const bool on_ball = std::abs(u) < radius * std::sin(std::atan(slope));
          const double arc =
              on_ball ? radius * std::hypot(1.0, slope) - std::sqrt(radius * radius - u * u) : groove(c);
          const double height = closed.reader().heightAt(c, kAlong / 2);
          // Where it touches, too, it lies on samples: a parabola over half a spacing.
          EXPECT_GT(height - arc, -0.5 / radius * std::pow(std::hypot(1.0, slope), 3))
              << degrees << " " << radius;
          most = std::max(most, height - arc);
        }
      }
      fmt::print("{} degrees, radius {} samples: {:.3f} spacings too high, half of the slope {:.3f}\n",
                 degrees, radius, most, 0.5 * slope);
      EXPECT_LT(most, 0.5 * slope + 0.5 / radius) << degrees << " " << radius;
      EXPECT_GT(most, 0.35 * slope) << degrees << " " << radius;
    }
  }
}

// On a plane of any slope the middles are where they would be.
TEST(Closing, OfATiltedPlaneIsThatPlane) {
  for (const double slope : {0.1, 1.0, 3.0}) {
    const MadeScan scan{"plane", 100, 90, 1.0, 1.0, 7.0, [&](int c, int r) { return slope * (c + 0.5 * r); }};
    const Version closed =
        filtered(versionOf(scan), rollingSpec(FilterKind::kClosing, Element::kBall, 7.0)).field;
    for (int c = 20; c < 80; c += 3)
      EXPECT_NEAR(closed.reader().heightAt(c, 45), slope * (c + 22.5), 1e-6 * slope * 150.0);
  }
}

TEST(Opening, OfALargerSphereIsThatSphere) {
  const MadeScan scan{"sphere", 161, 161, 0.1, 0.1, 6.0, [](int c, int r) {
                        const double x = 0.1 * (c - 80), y = 0.1 * (r - 80);
                        return std::sqrt(400.0 - x * x - y * y);
                      }};
  const Version opened =
      filtered(versionOf(scan), rollingSpec(FilterKind::kOpening, Element::kBall, scan.nesting)).field;
  // It touches at R / 20 of the way to the middle, between samples: (spacing / 2)^2 (1 / R - 1 / 20) / 2 twice at most.
  const double between = 2.0 * 0.05 * 0.05 * 2.0 * (1.0 / 6.0 - 1.0 / 20.0);
  for (int r = 40; r <= 120; r += 8)
    for (int c = 40; c <= 120; c += 8) {
      const double off = scan.z(c, r) - opened.reader().heightAt(c, r);
      EXPECT_GE(off, -1e-5);
      EXPECT_LE(off, between) << c << ", " << r;
    }
}

TEST(Opening, HasTheSameBitsForAnyThreadsBlocksAndLevels) {
  const MadeScan scan{"rough", 333, 275, 1.0, 2.0, 0.0, [](int c, int r) {
                        return c % 17 == 3 && r % 5 == 1 ? std::nan("")
                                                         : 20.0 * rough(c, r) + (c == 90 ? 0.0 : -0.0);
                      }};
  const Version field = versionOf(scan);
  JobControl job;
  for (const FilterKind kind : {FilterKind::kOpening, FilterKind::kClosing})
    for (const Element element : kElements)
      for (const double radius : {2.5, 9.0, 33.0, 150.0}) {
        FilterSpec spec = rollingSpec(kind, element, radius);
        spec.threads = 1;
        const std::uint64_t one = contentHash(applyFilter(field, field, spec, job)->field);
        for (const int threads : {2, 5})
          for (const int side : {0, 64, 256})
            for (const CpuLevel level : {CpuLevel::kPlain, CpuLevel::kAvx2, CpuLevel::kAvx512}) {
              if (threads == 5 && side == 256) continue;
              spec.threads = threads;
              FilterTuning tuning;
              tuning.block_side = side;
              tuning.level = level;
              ASSERT_EQ(contentHash(applyFilter(field, field, spec, tuning, job)->field), one) << radius;
            }
        ASSERT_EQ(contentHash(applyFilter(field.inverted(), field, spec, job)->field.inverted()), one)
            << radius;
      }
}

TEST(Opening, OfARangeIsThatOfTheField) {
  const MadeScan scan{"rough", 500, 430, 1.0, 1.0, 0.0, [](int c, int r) {
                        return c % 11 == 3 ? std::nan("") : 9.0 * rough(c, r);
                      }};
  const Version field = versionOf(scan);
  JobControl job;
  for (const FilterKind kind : {FilterKind::kOpening, FilterKind::kClosing})
    for (const Element element : kElements)
      for (const double radius : {4.0, 20.0}) {
        const FilterSpec spec = rollingSpec(kind, element, radius);
        const Version turned = radius < 10.0 ? field : field.inverted();  // the scan's peaks all the same
        const Version whole = applyFilter(turned, turned, spec, job)->field;
        for (const TileRange& range : {TileRange{1, 1, 2, 1}, {0, 5, 1, 2}, {5, 5, 1, 1}}) {
          const auto part = filterRange(turned, turned, turned, spec, range, job);
          ASSERT_TRUE(part);
          for (int tr = range.row; tr < std::min(range.row + range.rows, 7); ++tr)
            for (int k = 0; k < 64 * 64; ++k) {
              const int c = range.column * 64 + k % 64, r = tr * 64 + k / 64;
              if (r < 430 && c < 500) {
                ASSERT_TRUE(sameBits(part->reader().heightAt(c, r), whole.reader().heightAt(c, r))) << radius;
              }
            }
        }
      }
}

// Peaks are those of the scan, whichever way up it is shown; of a scan that is itself turned over they are pits.
TEST(Closing, IsTheOpeningOfASurfaceTurnedOver) {
  const MadeScan scan{"rough", 100, 90, 1.0, 1.0, 6.0, holed};
  const MadeScan turned{"turned", 100, 90, 1.0, 1.0, 6.0, [](int c, int r) { return -holed(c, r); }};
  for (const Element element : kElements) {
    const auto opened =
        heightsOf(filtered(versionOf(scan), rollingSpec(FilterKind::kOpening, element, 6.0)).field);
    const auto closed =
        heightsOf(filtered(versionOf(turned), rollingSpec(FilterKind::kClosing, element, 6.0)).field);
    int different = 0;
    for (std::size_t i = 0; i < opened.size(); ++i)
      different += !std::isnan(opened[i]) && opened[i] != -closed[i];
    EXPECT_EQ(different, 0);
  }
}

TEST(Opening, DependsOnSamplesWithinTwoElementsAndNoMoreThanThereCanBe) {
  const Version field = versionOf(MadeScan{"spacing 1:4", 20, 20, 0.25, 1.0, 0.0, rough});
  for (const FilterKind kind : {FilterKind::kOpening, FilterKind::kClosing})
    for (const Element element : kElements) {
      const auto reach = [&](double radius) {
        const FilterSpec spec = rollingSpec(kind, element, radius);
        return reachOf(spec, field.grid(), false);
      };
      EXPECT_EQ(reach(2.0), 16);  // along the finer spacing, both times
      EXPECT_EQ(reach(2.1), 18);
      EXPECT_EQ(reach(1e12), Grid::kMaxSide);
    }
}

TEST(Opening, RefusesWhatItCannotDo) {
  const MadeScan scan{"plain", 20, 20, 1.0, 4.0, 0.0, [](int c, int) { return c; }};
  const Version field = versionOf(scan);
  for (const FilterKind kind : {FilterKind::kOpening, FilterKind::kClosing}) {
    JobControl job;
    for (const double wrong : {0.0, -1.0, 3.9, std::numeric_limits<double>::infinity(), std::nan("")})
      EXPECT_EQ(applyFilter(field, field, rollingSpec(kind, Element::kDisk, wrong), job).error().kind,
                ErrorKind::kInput)
          << wrong;
    job.cancel();
    for (const double radius : {5.0, 600.0})
      EXPECT_EQ(applyFilter(field, field, rollingSpec(kind, Element::kBall, radius), job).error().kind,
                ErrorKind::kCancelled);
  }
  JobControl job;
  FilterSpec box;
  box.element = Element::kDisk;
  EXPECT_EQ(applyFilter(field, field, box, job).error().where, "element");
}

}  // namespace
}  // namespace fettle::engine::tests
