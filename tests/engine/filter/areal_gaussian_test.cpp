#include "engine/filter/areal_gaussian.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/filter/gaussian_plane.h"
#include "engine/filter/gaussian_strip.h"
#include "engine/filter/middle_distance.h"
#include "engine/filter/region.h"
#include "engine/filter/robust_weights.h"
#include "tests/engine/filter/made_scan.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

using std::numbers::pi;

// The hard cases: short and long cut-offs (nodes of 1 to 64 samples), holes, walls, spikes, unequal spacing, one row.
std::vector<MadeScan> standardScans() {
  const auto noise = [](int c, int r) { return std::sin(12.9898 * c + 78.233 * r + 0.01 * c * r); };
  const auto holed = [noise](int c, int r) {
    return (c * 5 + r * 3) % 13 == 0 || (c > 30 && c < 60 && r > 10 && r < 30) ? std::nan("") : noise(c, r);
  };
  return {
      {"below two nodes", 90, 70, 0.1, 0.1, 0.65, holed},
      {"two nodes", 120, 90, 0.1, 0.1, 3.0, holed},
      {"eight nodes", 150, 130, 0.1, 0.1, 10.5,
       [noise](int c, int r) { return noise(c, r) + (c > 70 ? 50.0 : 0.0); }},
      {"spacing 1:4", 140, 70, 0.25, 1.0, 9.0, holed},
      {"beyond the field", 130, 100, 1.0, 1.0, 1e7, holed},
      {"a spike", 100, 100, 1.0, 1.0, 30.0,
       [noise](int c, int r) { return c == 40 && r == 50 ? 1e6 : noise(c, r); }},
      {"one row", 300, 1, 1.0, 1.0, 40.0, noise},
      {"one column", 1, 300, 1.0, 1.0, 40.0, noise},
      {"one sample", 1, 1, 1.0, 1.0, 2.0, [](int, int) { return 5.0; }},
      {"few samples", 80, 80, 1.0, 1.0, 30.0,
       [](int c, int r) { return (c == 3 && r < 4) || c + r == 150 ? c + r : std::nan(""); }},
  };
}

// Of all samples there are, without an end of the weights: along x, then along y.
std::vector<double> plainGaussian(const MadeScan& scan, const std::vector<double>& z,
                                  const std::vector<double>& weights) {
  const auto weightsOf = [&](int count, double spacing) {
    std::vector<double> all;
    for (int d = 0; d < count; ++d)
      all.push_back(std::exp(-pi * pi / std::numbers::ln2 * std::pow(d * spacing / scan.nesting, 2)));
    return all;
  };
  const std::vector<double> wx = weightsOf(scan.width, scan.spacing_x),
                            wy = weightsOf(scan.height, scan.spacing_y);
  const auto at = [&](int c, int r) { return static_cast<std::size_t>(r * scan.width + c); };
  std::vector<double> sums(z.size()), totals(z.size()), means(z.size());
  for (int r = 0; r < scan.height; ++r)
    for (int c = 0; c < scan.width; ++c)
      for (int u = 0; u < scan.width; ++u) {
        const double w =
            std::isnan(z[at(u, r)]) ? 0.0 : weights[at(u, r)] * wx[static_cast<std::size_t>(std::abs(u - c))];
        if (w > 0.0) sums[at(c, r)] += w * z[at(u, r)];
        totals[at(c, r)] += w;
      }
  for (int r = 0; r < scan.height; ++r)
    for (int c = 0; c < scan.width; ++c) {
      double sum = 0.0, total = 0.0;
      for (int v = 0; v < scan.height; ++v) {
        sum += wy[static_cast<std::size_t>(std::abs(v - r))] * sums[at(c, v)];
        total += wy[static_cast<std::size_t>(std::abs(v - r))] * totals[at(c, v)];
      }
      means[at(c, r)] = sum / total;
    }
  return means;
}

// The mean distance of a window's samples from its mean.
double meanDistance(const MadeScan& scan, const std::vector<double>& z, double mean, int c, int r) {
  double sum = 0.0, total = 0.0;
  for (int v = 0; v < scan.height; ++v)
    for (int u = 0; u < scan.width; ++u) {
      const double height = z[static_cast<std::size_t>(v * scan.width + u)];
      if (std::isnan(height)) continue;
      const double x = (u - c) * scan.spacing_x, y = (v - r) * scan.spacing_y;
      const double w =
          std::exp(-pi * pi / std::numbers::ln2 * (x * x + y * y) / (scan.nesting * scan.nesting));
      sum += w * std::fabs(height - mean), total += w;
    }
  return sum / total;
}

TEST(ArealGaussian, IsWhatPlainSumsFindWithinItsStatedError) {
  for (const MadeScan& scan : standardScans()) {
    const Version field = versionOf(scan);
    const PlainField got =
        toPlain(filtered(field, nestingSpec(FilterKind::kArealGaussian, scan.nesting)).field);
    const std::vector<double> z = heightsOf(field);
    const auto plain = plainGaussian(scan, z, std::vector<double>(z.size(), 1.0));
    double largest = 0.0, worst = 0.0;
    for (const double height : z)
      if (!std::isnan(height)) largest = std::max(largest, std::fabs(height));
    // What a sample beyond the weights' end is of a quarter of a full window.
    const double beyond =
        4.0 * 4e-8 * largest / (0.22 * std::pow(scan.nesting, 2) / (scan.spacing_x * scan.spacing_y));
    for (std::size_t i = 0; i < z.size(); ++i) {
      ASSERT_EQ(std::isnan(z[i]), std::isnan(got.z[i])) << scan.name;
      if (std::isnan(z[i]) || (i % 7 != 0 && z.size() > 100)) continue;
      const double off = std::fabs(got.z[i] - plain[i]) - 0.5 * static_cast<double>(ulp(got.z[i])) - beyond;
      const int c = static_cast<int>(i) % scan.width, r = static_cast<int>(i) / scan.width;
      worst = std::max(worst, off / (meanDistance(scan, z, plain[i], c, r) + 1e-300));
    }
    EXPECT_LE(worst, 1e-6) << scan.name;
  }
}

// exp(-pi (alpha L / wave)^2), half at the cut-off, whether samples or nodes are summed, along x, y and askew.
TEST(ArealGaussian, TransmitsWhatTheStandardStates) {
  for (const double cut_off : {2.0, 8.0, 40.0})
    for (const double degrees : {0.0, 90.0, 37.0})
      for (const double waves : {0.5, 1.0, 1.7, 4.0}) {
        const double wave = waves * cut_off, spacing = cut_off / 40.0;
        const double kx = 2.0 * pi / wave * std::cos(degrees * pi / 180.0),
                     ky = 2.0 * pi / wave * std::sin(degrees * pi / 180.0);
        const MadeScan scan{"wave", 280, 140, spacing, 2.0 * spacing, cut_off, [&](int c, int r) {
                              return std::cos(kx * spacing * (c - 140) + ky * 2.0 * spacing * (r - 70));
                            }};
        const PlainField got =
            toPlain(filtered(versionOf(scan), nestingSpec(FilterKind::kArealGaussian, cut_off)).field);
        const double passed = std::exp2(-1.0 / (waves * waves));
        // Farther than 1.2 cut-offs from the border: less than 1e-9 of the weights lie beyond.
        for (int r = 50; r <= 90; r += 5)
          for (int c = 60; c <= 220; c += 9)
            ASSERT_NEAR(got.at(c, r), passed * scan.z(c, r), 1e-6)
                << cut_off << ", " << degrees << ", " << waves;
      }
}

TEST(ArealGaussian, OfAConstantIsThatConstant) {
  for (const FilterKind kind : {FilterKind::kArealGaussian, FilterKind::kRobustGaussian})
    for (const double cut_off : {5.0, 60.0}) {
      const MadeScan scan{
          "flat", 130, 90, 1.0, 1.0, cut_off, [](int c, int r) { return c == r ? std::nan("") : 0.1; }};
      const Version field = versionOf(scan);
      EXPECT_EQ(contentHash(filtered(field, nestingSpec(kind, cut_off)).field), contentHash(field));
    }
}

TEST(ArealGaussian, HasTheSameBitsForAnyThreadsBlocksAndLevels) {
  const MadeScan scan{"rough", 333, 275, 1.0, 2.0, 0.0, [](int c, int r) {
                        return c % 17 == 3 && r % 5 == 1 ? std::nan("")
                                                         : std::sin(3.1 * c + 1.7 * r * r) + 0.01 * c;
                      }};
  const Version field = versionOf(scan);
  JobControl job;
  for (const FilterKind kind : {FilterKind::kArealGaussian, FilterKind::kRobustGaussian})
    for (const double cut_off : {9.0, 30.0, 70.0, 1e5}) {
      FilterSpec spec = nestingSpec(kind, cut_off);
      spec.threads = 1;
      const std::uint64_t one = contentHash(applyFilter(field, field, spec, job)->field);
      for (const int threads : {2, 5})
        for (const int side : {0, 64, 256})
          for (const CpuLevel level : {CpuLevel::kPlain, CpuLevel::kAvx2, CpuLevel::kAvx512}) {
            // Rounds do not go by these blocks.
            if (kind == FilterKind::kRobustGaussian && side != 64) continue;
            spec.threads = threads;
            FilterTuning tuning;
            tuning.block_side = side;
            tuning.level = level;
            ASSERT_EQ(contentHash(applyFilter(field, field, spec, tuning, job)->field), one) << cut_off;
          }
      ASSERT_EQ(contentHash(applyFilter(field.inverted(), field, spec, job)->field.inverted()), one)
          << cut_off;
    }
}

// Short cut-offs go by strips, whose sums are those of planes.
TEST(ArealGaussian, HasTheBitsOfPlanesInStrips) {
  JobControl job;
  for (const bool holes : {false, true})
    for (const auto& [width, height] : {std::pair{150, 130}, {70, 3}, {1, 90}, {65, 66}}) {
      const MadeScan scan{"rough", width, height, 1.0, 1.0, 0.0, [holes](int c, int r) {
                            return holes && c > 20 && c < 40 && r > 60 && r < 75
                                       ? std::nan("")
                                       : std::sin(3.1 * c + 1.7 * r * r) + 0.01 * c;
                          }};
      const Version field = versionOf(scan);
      const FieldReader reader = field.reader();
      const SampleRect all{0, 0, width, height};
      for (const double cut_off : {0.5, 2.0, 6.5, 17.0}) {
        const GaussianAxis x = gaussianAxis(cut_off, width), y = gaussianAxis(1.3 * cut_off, height);
        if (x.step != 1 || y.step != 1) continue;
        const std::ptrdiff_t stride = (width + 31) / 16 * 16;
        std::vector<float> of_plane(static_cast<std::size_t>(stride * height + 16)), of_strips = of_plane;
        GaussianPlane plane(x, y, CpuLevel::kPlain);
        ASSERT_TRUE(plane.make(reader, {}, all, false, job));
        GaussianPlane::Scratch scratch;
        plane.fill(all, scratch, of_plane.data(), stride);
        GaussianStrips::Scratch strip_scratch;
        ASSERT_TRUE(GaussianStrips(x, y, bestCpuLevel())
                        .fill(reader, all, strip_scratch, of_strips.data(), stride, job));
        for (int r = 0; r < height; ++r)
          for (int c = 0; c < width; ++c) {
            const auto at = static_cast<std::size_t>(r * stride + c);
            ASSERT_TRUE(sameBits(of_strips[at], of_plane[at]) ||
                        (std::isnan(of_strips[at]) && std::isnan(of_plane[at])))
                << cut_off << ", " << c << ", " << r;
          }
      }
    }
}

// Of a piece, with as much around it as the filter reaches: what a preview shows.
TEST(ArealGaussian, OfARangeIsThatOfTheField) {
  const MadeScan scan{"rough", 700, 600, 1.0, 1.0, 0.0, [](int c, int r) {
                        return c % 11 == 3 ? std::nan("") : std::sin(3.1 * c + 1.7 * r * r);
                      }};
  const Version field = versionOf(scan);
  JobControl job;
  for (const FilterKind kind : {FilterKind::kArealGaussian, FilterKind::kRobustGaussian})
    for (const double cut_off : {9.0, 60.0, 110.0}) {
      const FilterSpec spec = nestingSpec(kind, cut_off);
      const Version whole = applyFilter(field, field, spec, job)->field;
      for (const TileRange& range : {TileRange{1, 1, 2, 1}, {0, 8, 1, 5}, {5, 5, 1, 1}}) {
        const auto part = filterRange(field, field, field, spec, range, job);
        ASSERT_TRUE(part);
        for (int tr = range.row; tr < std::min(range.row + range.rows, 10); ++tr)
          for (int k = 0; k < 64 * 64; ++k) {
            const int c = range.column * 64 + k % 64, r = tr * 64 + k / 64;
            if (r < 600 && c < 700) {
              ASSERT_TRUE(sameBits(part->reader().heightAt(c, r), whole.reader().heightAt(c, r))) << cut_off;
            }
          }
      }
    }
}

TEST(ArealGaussian, RefusesWhatItCannotDo) {
  const MadeScan scan{"plain", 20, 20, 1.0, 4.0, 0.0, [](int c, int) { return c; }};
  const Version field = versionOf(scan);
  for (const FilterKind kind : {FilterKind::kArealGaussian, FilterKind::kRobustGaussian}) {
    JobControl job;
    for (const double wrong : {0.0, -1.0, 7.9, std::numeric_limits<double>::infinity(), std::nan("")})
      EXPECT_EQ(applyFilter(field, field, nestingSpec(kind, wrong), job).error().kind, ErrorKind::kInput)
          << wrong;
    EXPECT_EQ(applyFilter(field, field, nestingSpec(FilterKind::kBox, 8.0), job).error().kind,
              ErrorKind::kInput);
    job.cancel();
    EXPECT_EQ(applyFilter(field, field, nestingSpec(kind, 8.0), job).error().kind, ErrorKind::kCancelled);
  }
  const MadeScan holes{"holes", 90, 90, 1.0, 1.0, 0.0, [](int, int) { return std::nan(""); }};
  EXPECT_EQ(filtered(versionOf(holes), nestingSpec(FilterKind::kRobustGaussian, 8.0)).report.changed, 0);
}

}  // namespace
}  // namespace fettle::engine::tests
