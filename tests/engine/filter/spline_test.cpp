#include "engine/filter/spline.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/filter/made_scan.h"
#include "tests/engine/filter/reference.h"
#include "tests/engine/filter/robust_reference.h"

namespace fettle::engine::tests {
namespace {

using Real = long double;

// Rows of a least-squares problem, each with its right side at the end, solved by Givens rotations.
class LeastSquares {
 public:
  explicit LeastSquares(std::size_t unknowns) : n_(unknowns), upper_(n_ * (n_ + 1)) {}

  void add(std::vector<Real> row) {
    for (std::size_t k = 0; k < n_; ++k) {
      if (row[k] == 0) continue;
      Real* const mine = upper_.data() + k * (n_ + 1);
      const Real length = std::hypot(mine[k], row[k]), c = mine[k] / length, s = row[k] / length;
      for (std::size_t j = k; j <= n_; ++j) {
        const Real a = mine[j], b = row[j];
        mine[j] = c * a + s * b;
        row[j] = c * b - s * a;
      }
    }
  }

  [[nodiscard]] std::vector<Real> solution() const {
    std::vector<Real> x(n_);
    for (std::size_t k = n_; k-- > 0;) {
      const Real* const mine = upper_.data() + k * (n_ + 1);
      Real sum = mine[n_];
      for (std::size_t j = k + 1; j < n_; ++j) sum -= mine[j] * x[j];
      x[k] = sum / mine[k];
    }
    return x;
  }

 private:
  std::size_t n_;
  std::vector<Real> upper_;
};

// a^2 of an axis.
Real stiffness(double cut_off, double spacing) {
  const Real a = 1 / (2 * std::sin(std::numbers::pi_v<Real> * spacing / cut_off));
  return a * a;
}

// A line after its definition: a row for each sample and each second difference.
std::vector<Real> plainLine(const std::vector<Real>& z, double cut_off, double spacing) {
  const std::size_t n = z.size();
  const Real a2 = stiffness(cut_off, spacing);
  LeastSquares problem(n);
  for (std::size_t i = 0; i + 2 < n; ++i) {
    std::vector<Real> row(n + 1);
    row[i] = row[i + 2] = a2;
    row[i + 1] = -2 * a2;
    problem.add(std::move(row));
  }
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<Real> row(n + 1);
    row[i] = 1;
    row[n] = z[i];
    problem.add(std::move(row));
  }
  return problem.solution();
}

std::vector<Real> plainTensor(const MadeScan& scan, const std::vector<double>& z) {
  const auto wide = static_cast<std::size_t>(scan.width), high = static_cast<std::size_t>(scan.height);
  std::vector<Real> s(z.begin(), z.end());
  for (std::size_t r = 0; r < high; ++r) {
    const std::vector<Real> line(s.begin() + r * wide, s.begin() + (r + 1) * wide);
    std::ranges::copy(plainLine(line, scan.nesting, scan.spacing_x), s.begin() + r * wide);
  }
  for (std::size_t c = 0; c < wide; ++c) {
    std::vector<Real> line;
    for (std::size_t r = 0; r < high; ++r) line.push_back(s[r * wide + c]);
    line = plainLine(line, scan.nesting, scan.spacing_y);
    for (std::size_t r = 0; r < high; ++r) s[r * wide + c] = line[r];
  }
  return s;
}

// With weights: a row for each sample, for each second difference along x, along y and of both.
std::vector<Real> plainWeighted(const MadeScan& scan, const std::vector<double>& z,
                                const std::vector<double>& weights) {
  const int wide = scan.width, high = scan.height;
  const std::size_t n = z.size();
  const Real ax = stiffness(scan.nesting, scan.spacing_x), ay = stiffness(scan.nesting, scan.spacing_y);
  const Real bend[] = {1, -2, 1};
  LeastSquares problem(n);
  const auto at = [wide](int c, int r) { return static_cast<std::size_t>(r * wide + c); };
  for (int r = 0; r < high; ++r)
    for (int c = 0; c < wide; ++c) {
      std::vector<Real> x(n + 1), y(n + 1), both(n + 1);
      for (int i = 0; i < 3; ++i) {
        if (c + 2 < wide) x[at(c + i, r)] += ax * bend[i];
        if (r + 2 < high) y[at(c, r + i)] += ay * bend[i];
        for (int j = 0; j < 3; ++j)
          if (c + 2 < wide && r + 2 < high) both[at(c + i, r + j)] += ax * ay * bend[i] * bend[j];
      }
      problem.add(std::move(both));
      problem.add(std::move(x));
      problem.add(std::move(y));
    }
  for (std::size_t i = 0; i < n; ++i) {
    if (!(weights[i] > 0.0)) continue;
    std::vector<Real> row(n + 1);
    row[i] = std::sqrt(static_cast<Real>(weights[i]));
    row[n] = row[i] * z[i];
    problem.add(std::move(row));
  }
  return problem.solution();
}

double roughness(int c, int r) {
  return std::sin(12.9898 * c + 78.233 * r + 0.01 * c * r);
}

// Largest distance from a plane is not larger than the range of heights less a trend that the tests put in.
double rangeOf(const std::vector<double>& z) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double each : z)
    if (!std::isnan(each)) low = std::min(low, each), high = std::max(high, each);
  return high - low;
}

TEST(Spline, IsTheLeastSumOfItsDefinition) {
  const auto tilted = [](int c, int r) { return 7.0 + 0.3 * c - 0.2 * r + roughness(c, r); };
  std::vector<MadeScan> scans;
  for (const double cut_off : {2.0, 3.7, 12.0, 90.0, 2000.0, 1e5, 1e9})
    scans.push_back({"rough", 45, 38, 1.0, 1.0, cut_off, tilted});
  scans.push_back({"spacing 1:4", 60, 20, 0.25, 1.0, 5.0, tilted});
  scans.push_back({"a wall", 50, 30, 0.1, 0.1, 1.3,
                   [](int c, int r) { return roughness(c, r) + (c > 20 ? 50.0 : 0.0); }});
  scans.push_back({"a spike", 50, 30, 0.1, 0.1, 1.3,
                   [](int c, int r) { return c == 9 && r == 8 ? 1e6 : roughness(c, r); }});
  scans.push_back({"one row", 150, 1, 1.0, 1.0, 30.0, tilted});
  scans.push_back({"one column", 1, 150, 1.0, 1.0, 30.0, tilted});
  for (const int side : {1, 2, 3, 4}) scans.push_back({"few", side, 5 - side, 1.0, 1.0, 4.0, tilted});
  for (const MadeScan& scan : scans) {
    const Version field = versionOf(scan);
    const std::vector<double> z = heightsOf(field);
    const std::vector<Real> plain = plainTensor(scan, z);
    const PlainField got = toPlain(filtered(field, nestingSpec(FilterKind::kSpline, scan.nesting)).field);
    const double bound =
        0x1p-49 * std::max(scan.nesting / std::min(scan.spacing_x, scan.spacing_y), 8.0) * rangeOf(z);
    for (std::size_t i = 0; i < z.size(); ++i)
      ASSERT_LE(std::fabs(got.z[i] - plain[i]), 0.5L * ulp(got.z[i]) + std::min(bound, 1e-9 * rangeOf(z)))
          << scan.name << " " << scan.nesting << ", " << i;
  }
}

std::vector<MadeScan> holedScans() {
  const auto scattered = [](int c, int r) {
    return (c * 5 + r * 3) % 7 == 0 ? std::nan("") : 3.0 + 0.2 * c - 0.1 * r + roughness(c, r);
  };
  return {
      {"scattered", 19, 17, 1.0, 1.0, 6.0, scattered},
      {"short", 19, 17, 1.0, 1.0, 2.0, scattered},
      {"long", 18, 16, 1.0, 1.0, 40.0, scattered},
      {"spacing 1:4", 24, 13, 0.25, 1.0, 4.0, scattered},
      {"a block", 20, 18, 1.0, 1.0, 5.0,
       [](int c, int r) {
         return c > 3 && c < 15 && r > 2 && r < 12 ? std::nan("") : 0.2 * c + roughness(c, r);
       }},
      {"half", 20, 18, 1.0, 1.0, 7.0,
       [](int c, int r) { return c + r > 18 ? std::nan("") : 0.2 * c + roughness(c, r); }},
      {"one row", 100, 1, 1.0, 1.0, 9.0,
       [](int c, int) { return c % 5 == 2 || (c > 40 && c < 60) ? std::nan("") : roughness(c, 0); }},
  };
}

TEST(Spline, OverHolesIsTheLeastSumOverTheSamplesThereAre) {
  for (const MadeScan& scan : holedScans()) {
    const Version field = versionOf(scan);
    const std::vector<double> z = heightsOf(field);
    std::vector<double> weights;
    for (const double each : z) weights.push_back(std::isnan(each) ? 0.0 : 1.0);
    const std::vector<Real> plain = plainWeighted(scan, z, weights);
    const PlainField got = toPlain(filtered(field, nestingSpec(FilterKind::kSpline, scan.nesting)).field);
    for (std::size_t i = 0; i < z.size(); ++i) {
      ASSERT_EQ(std::isnan(z[i]), std::isnan(got.z[i]));
      if (!std::isnan(z[i])) {
        // The standard deviation of a unit sine is 0.7.
        ASSERT_LE(std::fabs(got.z[i] - plain[i]), 0.5L * ulp(got.z[i]) + 0.7e-7) << scan.name << ", " << i;
      }
    }
  }
}

// The search ends by errors relative to the surface's height: heights 2^30 times smaller have the same results, 2^30 times smaller.
TEST(Spline, OverHolesIsTheSameInAnyUnit) {
  for (const FilterKind kind : {FilterKind::kSpline, FilterKind::kRobustSpline})
    for (const MadeScan& scan : holedScans()) {
      MadeScan small = scan;
      small.z = [&](int c, int r) { return 0x1p-30 * scan.z(c, r); };
      const PlainField one = toPlain(filtered(versionOf(scan), nestingSpec(kind, scan.nesting)).field),
                       other = toPlain(filtered(versionOf(small), nestingSpec(kind, scan.nesting)).field);
      for (std::size_t i = 0; i < one.z.size(); ++i) {
        ASSERT_EQ(std::isnan(one.z[i]), std::isnan(other.z[i]));
        if (!std::isnan(one.z[i])) {
          ASSERT_EQ(one.z[i], 0x1p30 * other.z[i]) << scan.name << ", " << i;
        }
      }
    }
}

// 1 / (1 + (sin(pi / l) / sin(pi / L))^4) along an axis, half at the cut-off, and the product of both askew.
TEST(Spline, TransmitsWhatTheStandardStates) {
  for (const double cut_off : {2.5, 10.0, 25.0})
    for (const double waves : {0.9, 1.0, 1.6, 3.0})
      for (const double degrees : {0.0, 90.0, 45.0}) {
        const double kx = 2.0 * std::numbers::pi / (waves * cut_off) *
                          std::cos(degrees * std::numbers::pi / 180.0),
                     ky = 2.0 * std::numbers::pi / (waves * cut_off) *
                          std::sin(degrees * std::numbers::pi / 180.0);
        const MadeScan scan{"wave",
                            420,
                            420,
                            1.0,
                            1.0,
                            cut_off,
                            [&](int c, int r) { return std::cos(kx * (c - 210) + ky * (r - 210)); }};
        const auto passed = [&](double k) {
          return 1.0 / (1.0 + std::pow(std::sin(0.5 * k) / std::sin(std::numbers::pi / cut_off), 4));
        };
        const PlainField got =
            toPlain(filtered(versionOf(scan), nestingSpec(FilterKind::kSpline, cut_off)).field);
        // The ends have fallen by exp(-pi sqrt(2) x / L): less than 1e-9 from 5 cut-offs on.
        for (int r = 150; r <= 270; r += 7)
          for (int c = 150; c <= 270; c += 11)
            ASSERT_NEAR(got.at(c, r), passed(kx) * passed(ky) * scan.z(c, r), 1e-6)
                << cut_off << ", " << waves << ", " << degrees;
      }
}

TEST(Spline, LeavesPlanesToTheirEnds) {
  for (const FilterKind kind : {FilterKind::kSpline, FilterKind::kRobustSpline})
    for (const double cut_off : {3.0, 40.0, 1e6}) {
      const MadeScan scan{"plane", 130, 90, 1.0, 1.0, cut_off, [](int c, int r) {
                            return (c * 7 + r) % 11 == 0 || (c > 50 && c < 80 && r > 20 && r < 60)
                                       ? std::nan("")
                                       : 100.0 + 0.5 * c - 0.25 * r;
                          }};
      const Version field = versionOf(scan);
      // Exact heights, so that nothing is rounded before.
      EXPECT_LE(filtered(field, nestingSpec(kind, cut_off)).report.max_change, 2e-5) << cut_off;
    }
}

// Nothing is left to find once the plane is taken out, so that heights near 0 come back too.
TEST(Spline, LeavesPlanesThroughZeroToTheDigitsOfDouble) {
  for (const double cut_off : {3.0, 40.0}) {
    const MadeScan scan{"plane", 130, 90, 1.0, 1.0, cut_off, [](int c, int r) {
                          return (c * 7 + r) % 11 == 0 || (c > 50 && c < 80 && r > 20 && r < 60)
                                     ? std::nan("")
                                     : 1024.0 * (c - 65) - 512.0 * (r - 45);
                        }};
    // Roundings of heights of 1e5, 1e-11 each, over the windows of a cut-off.
    EXPECT_LE(filtered(versionOf(scan), nestingSpec(FilterKind::kSpline, cut_off)).report.max_change, 1e-8)
        << cut_off;
  }
}

TEST(Spline, OfAConstantIsThatConstant) {
  for (const FilterKind kind : {FilterKind::kSpline, FilterKind::kRobustSpline})
    for (const double cut_off : {5.0, 60.0}) {
      const MadeScan scan{
          "flat", 130, 90, 1.0, 1.0, cut_off, [](int c, int r) { return c == r ? std::nan("") : 0.1; }};
      const Version field = versionOf(scan);
      EXPECT_EQ(contentHash(filtered(field, nestingSpec(kind, cut_off)).field), contentHash(field));
    }
}

TEST(Spline, HasTheSameBitsForAnyThreadsBlocksAndLevels) {
  const Version whole = versionOf({"rough", 203, 175, 1.0, 2.0, 0.0, roughness});
  const Version holed =
      versionOf({"holed", 203, 175, 1.0, 2.0, 0.0, [](int c, int r) {
                   return c % 17 == 3 && r % 5 == 1 ? std::nan("") : roughness(c, r) + 0.01 * c;
                 }});
  JobControl job;
  for (const Version& field : {whole, holed})
    for (const FilterKind kind : {FilterKind::kSpline, FilterKind::kRobustSpline})
      for (const double cut_off : {9.0, 70.0}) {
        FilterSpec spec = nestingSpec(kind, cut_off);
        spec.threads = 1;
        const std::uint64_t one = contentHash(applyFilter(field, field, spec, job)->field);
        for (const int threads : {2, 5})
          for (const CpuLevel level : {CpuLevel::kPlain, CpuLevel::kAvx2, CpuLevel::kAvx512}) {
            spec.threads = threads;
            FilterTuning tuning;
            tuning.block_side = threads == 2 ? 64 : 256;
            tuning.level = level;
            ASSERT_EQ(contentHash(applyFilter(field, field, spec, tuning, job)->field), one) << cut_off;
          }
        ASSERT_EQ(contentHash(applyFilter(field.inverted(), field, spec, job)->field.inverted()), one)
            << cut_off;
      }
}

// Weights of the robust Gaussian's rounds, then the least sum with them, each after its definition.
TEST(RobustSpline, IsTheLeastSumWithTheWeightsOfTheRobustGaussian) {
  for (MadeScan scan : holedScans()) {
    const auto under = scan.z;
    // Distances of normal ones: of a sine's half would be near the limit.
    std::mt19937_64 random(11);
    std::normal_distribution<double> noise(0.0, 0.5);
    std::vector<double> noises;
    for (int i = 0; i < 1000; ++i) noises.push_back(noise(random));
    scan.z = [under, noises](int c, int r) {
      return under(c, r) + noises[static_cast<std::size_t>((c * 61 + r * 37) % 1000)] -
             (c % 9 == 4 && r % 4 == 1 ? 30.0 : 0.0);
    };
    const Version field = versionOf(scan);
    const std::vector<double> z = heightsOf(field);
    const PlainRobust robust = plainRobust(scan, z);
    std::vector<double> weights = robust.weights;
    for (std::size_t i = 0; i < z.size(); ++i)
      if (std::isnan(z[i])) weights[i] = 0.0;
    const std::vector<Real> plain = plainWeighted(scan, z, weights);
    const PlainField got =
        toPlain(filtered(field, nestingSpec(FilterKind::kRobustSpline, scan.nesting)).field);
    for (std::size_t i = 0; i < z.size(); ++i)
      if (!std::isnan(z[i])) {
        ASSERT_LE(std::fabs(got.z[i] - plain[i]), 1e-4 * robust.limit + 0.5L * ulp(got.z[i]))
            << scan.name << ", " << i;
      }
  }
}

// A groove of a tenth of the width and 40 times the noise: the linear surface sinks into it, the robust one does not.
TEST(RobustSpline, PassesOverGrooves) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 1.0);
  const MadeScan scan{"groove", 300, 120, 1.0, 1.0, 80.0, [&](int c, int) {
                        return noise(random) - (c >= 140 && c < 150 ? 40.0 : 0.0);
                      }};
  const Version field = versionOf(scan);
  const float
      linear = filtered(field, nestingSpec(FilterKind::kSpline, 80.0)).field.reader().heightAt(145, 60),
      robust = filtered(field, nestingSpec(FilterKind::kRobustSpline, 80.0)).field.reader().heightAt(145, 60);
  // The weight of the middle of a line is pi / (sqrt(2) L) for each sample.
  EXPECT_NEAR(linear, -40.0 * 10.0 * std::numbers::pi / std::sqrt(2.0) / 80.0, 1.0);
  EXPECT_NEAR(robust, 0.0, 0.15);
}

TEST(Spline, RefusesWhatItCannotDoAndLeavesHolesAlone) {
  const Version field = versionOf({"plain", 20, 20, 1.0, 4.0, 0.0, [](int c, int) { return c; }});
  const Version holes = versionOf({"holes", 90, 90, 1.0, 1.0, 0.0, [](int, int) { return std::nan(""); }});
  const Version one = versionOf(
      {"one", 90, 90, 1.0, 1.0, 0.0, [](int c, int r) { return c == 7 && r == 9 ? 3.25 : std::nan(""); }});
  for (const FilterKind kind : {FilterKind::kSpline, FilterKind::kRobustSpline}) {
    JobControl job;
    for (const double wrong : {0.0, -1.0, 7.9, std::numeric_limits<double>::infinity(), std::nan("")})
      EXPECT_EQ(applyFilter(field, field, nestingSpec(kind, wrong), job).error().kind, ErrorKind::kInput)
          << wrong;
    job.cancel();
    EXPECT_EQ(applyFilter(field, field, nestingSpec(kind, 8.0), job).error().kind, ErrorKind::kCancelled);
    EXPECT_EQ(filtered(holes, nestingSpec(kind, 8.0)).report.changed, 0);
    EXPECT_EQ(filtered(one, nestingSpec(kind, 8.0)).report.changed, 0);
  }
}

}  // namespace
}  // namespace fettle::engine::tests
