#include "engine/scanner/scanner.h"

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/field/difference.h"
#include "engine/scanner/part.h"

namespace fettle::engine {
namespace {

ScannerSpec clean(std::string part, int width, int height) {
  ScannerSpec spec;
  spec.part = std::move(part);
  spec.width = width;
  spec.height = height;
  spec.noise = 0.0;
  return spec;
}

SimulatedScan scanned(const ScannerSpec& spec) {
  JobControl job;
  Result<SimulatedScan> scan = simulateScan(spec, job);
  if (!scan) throw std::runtime_error(scan.error().line());
  return std::move(*scan);
}

bool same(float a, float b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

TEST(Scanner, TruthIsThePartsFormulaAtEverySampleOfEverySize) {
  for (const PartInfo& info : parts())
    for (const auto& [w, h] : {std::pair{1, 1}, {1, 90}, {130, 1}, {150, 97}, {64, 129}}) {
      const SimulatedScan s = scanned(clean(std::string(info.name), w, h));
      const double spacing = std::max(info.width_mm / w, info.height_mm / h);
      EXPECT_EQ(s.truth.grid().spacingXMm(), spacing);
      const Part& part = *findPart(info.name);
      for (int r = 0; r < h; ++r)
        for (int c = 0; c < w; ++c) {
          // The same expression for the place as the one in scanner.cpp, so that a sample exactly on an
          // outline falls on the same side.
          const glm::dvec2 p = glm::dvec2{c * spacing, r * spacing} -
                               glm::dvec2{0.5 * (w - 1) * spacing, 0.5 * (h - 1) * spacing};
          ASSERT_TRUE(same(s.truth.reader().heightAt(c, r), static_cast<float>(part.heightAt(p))))
              << info.name << ' ' << w << 'x' << h << " at " << c << ' ' << r;
        }
    }
}

TEST(Scanner, WithEveryAmplitudeZeroTheScanIsTheTruthToTheBit) {
  const SimulatedScan s = scanned(clean("bracket", 300, 260));
  EXPECT_EQ(contentHash(s.scan), contentHash(s.truth));
  EXPECT_EQ(s.sigma_mm, 0.0);
}

TEST(Scanner, NoiseAloneMovesSamplesEverywhereAndLosesNone) {
  ScannerSpec spec = clean("bracket", 300, 300);
  spec.noise = 1.0;
  const SimulatedScan s = scanned(spec);
  EXPECT_EQ(summarize(s.scan).no_data, summarize(s.truth).no_data);
  int moved = 0;
  for (int r = 0; r < 300; ++r)
    for (int c = 0; c < 300; ++c) {
      const float z = s.truth.reader().heightAt(c, r);
      if (std::isnan(z)) continue;
      const double e = static_cast<double>(s.scan.reader().heightAt(c, r) - z);
      // 6.8 sigma at most from each of the three normals, half a count.
      EXPECT_LE(std::abs(e), 0.02 * (6.8 * 1.75 + 0.25) + 1e-5);
      moved += e != 0.0;
    }
  // Heights that are whole counts come back to themselves when the error is below half a count, 0.22 sigma:
  // 18 % of them.
  EXPECT_GT(moved, 0.8 * 0.98 * 300 * 300);
}

TEST(Scanner, OutliersAloneTouchOnlySamplesBesideSteps) {
  ScannerSpec spec = clean("bracket", 400, 400);
  spec.outliers = 0.5;
  const SimulatedScan s = scanned(spec);
  int mixed = 0;
  for (int r = 0; r < 400; ++r)
    for (int c = 0; c < 400; ++c) {
      if (same(s.scan.reader().heightAt(c, r), s.truth.reader().heightAt(c, r))) continue;
      ++mixed;
      float z[9];
      s.truth.reader().readHeights(c - 1, r - 1, 3, 3, z, 3);
      float low = std::numeric_limits<float>::infinity();
      float high = -low;
      for (const float v : z)
        if (!std::isnan(v)) low = std::min(low, v), high = std::max(high, v);
      EXPECT_GE(high - low, 0.2F);
      EXPECT_GE(s.scan.reader().heightAt(c, r), low);
      EXPECT_LE(s.scan.reader().heightAt(c, r), high);
    }
  EXPECT_GT(mixed, 1000);
}

TEST(Scanner, DropoutsAloneLoseSamplesAndMoveNone) {
  ScannerSpec spec = clean("bracket", 400, 400);
  spec.dropouts = 1.0;
  const SimulatedScan s = scanned(spec);
  EXPECT_GT(summarize(s.scan).no_data, summarize(s.truth).no_data + 1000);
  for (int r = 0; r < 400; ++r)
    for (int c = 0; c < 400; ++c) {
      const float z = s.scan.reader().heightAt(c, r);
      EXPECT_TRUE(std::isnan(z) || z == s.truth.reader().heightAt(c, r));
    }
}

TEST(Scanner, HasTheStatedSigmaOnAFlatPlate) {
  ScannerSpec spec = clean("plate", 512, 512);
  spec.noise = 1.0;
  const SimulatedScan s = scanned(spec);
  EXPECT_DOUBLE_EQ(s.sigma_mm, 0.02);
  // Differences of neighbours along a line free the figure of line offsets; at 0.2 mm spacing the speckle's
  // kernel has three taps. Expected: 2 (sensor^2 + speckle^2 (1 - rho) + count^2 / 12), each count's error
  // nearly uniform and independent as sigma is twice the count. Correlations of the differences: the mean
  // square of n of them has a standard deviation of at most sqrt(2 * 3 / n) of it. Significance 1e-4.
  const double spacing = 100.0 / 512;
  const double sigma_k = 0.07 / spacing;
  const double side = std::exp(-0.5 / (sigma_k * sigma_k));
  const double rho = 3.0 * sigma_k < 1.0 ? 0.0 : 2.0 * side / (1.0 + 2.0 * side * side);
  const double expected = 2.0 * (0.02 * 0.02 + 0.01 * 0.01 * (1.0 - rho) + 0.01 * 0.01 / 12.0);
  double square = 0.0;
  double n = 0.0;
  for (int r = 0; r < 512; ++r)
    for (int c = 1; c < 512; ++c, n += 1.0) {
      const double d = static_cast<double>(s.scan.reader().heightAt(c, r)) -
                       static_cast<double>(s.scan.reader().heightAt(c - 1, r));
      square += d * d;
    }
  EXPECT_NEAR(square / n / expected, 1.0, 3.89 * std::sqrt(6.0 / n));
}

ScannerSpec everything() {
  ScannerSpec spec = clean("housing", 333, 290);
  spec.noise = 1.0;
  spec.outliers = 0.1;
  spec.dropouts = 1.0;
  return spec;
}

TEST(Scanner, GivesTheSameBitsForAnyNumberOfThreads) {
  std::set<std::uint64_t> hashes;
  for (const std::size_t threads : {1, 2, 3, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const SimulatedScan s = scanned(everything());
    hashes.insert(contentHash(s.scan) ^ (contentHash(s.edges) << 1));
  }
  EXPECT_EQ(hashes.size(), 1U);
}

TEST(Scanner, SeedChangesTheNoiseAndNotTheTruth) {
  ScannerSpec spec = everything();
  const SimulatedScan a = scanned(spec);
  const SimulatedScan again = scanned(spec);
  spec.seed = 2;
  const SimulatedScan b = scanned(spec);
  EXPECT_EQ(contentHash(a.scan), contentHash(again.scan));
  EXPECT_NE(contentHash(a.scan), contentHash(b.scan));
  EXPECT_EQ(contentHash(a.edges), contentHash(b.edges));
}

TEST(Scanner, EdgeMarksAreTheSamplesNearestTheLinesAndNoOthers) {
  const SimulatedScan s = scanned(clean("bracket", 500, 500));
  const double spacing = s.truth.grid().spacingXMm();
  const FieldReader f = s.edges.reader();
  std::set<std::pair<int, int>> expected;
  for (const Edge& edge : s.edge_lines)
    for (const glm::dvec2& p : edge.points_mm) {
      const int c = static_cast<int>(std::lround(p.x / spacing));
      const int r = static_cast<int>(std::lround(p.y / spacing));
      EXPECT_TRUE(f.markedAt(c, r)) << p.x << ' ' << p.y;
      expected.insert({c, r});
    }
  std::int64_t marked = 0;
  for (int r = 0; r < 500; ++r)
    for (int c = 0; c < 500; ++c) {
      if (!f.markedAt(c, r)) continue;
      ++marked;
      // Points are at most a sample apart, marks in between at most one away from an end.
      bool near = false;
      for (int dr = -1; dr <= 1; ++dr)
        for (int dc = -1; dc <= 1; ++dc) near = near || expected.contains({c + dc, r + dr});
      EXPECT_TRUE(near) << c << ' ' << r;
    }
  EXPECT_EQ(marked, summarize(s.edges).marked);
  EXPECT_GT(marked, 5000);
}

TEST(Scanner, TruthAndEdgesShareEveryTileWithoutAnEdgeAndAllShareOneMemory) {
  const SimulatedScan s = scanned(clean("bracket", 700, 700));
  for (const TileChange& change : changedTiles(s.truth, s.edges)) {
    EXPECT_GT(change.after->marked_samples, 0U);
    EXPECT_EQ(change.before->samples.size(), change.after->samples.size());
  }
  EXPECT_LT(changedTiles(s.truth, s.edges).size(), 121U);
  EXPECT_EQ(s.scan.memory(), s.truth.memory());
  EXPECT_TRUE(s.scan.grid() == s.truth.grid());
  EXPECT_EQ(summarize(s.truth).marked, 0);
  EXPECT_EQ(summarize(s.scan).marked, 0);
}

TEST(Scanner, RefusesWhatCannotBeInOneLine) {
  JobControl job;
  const auto refused = [&](auto change) {
    ScannerSpec spec = clean("bracket", 10, 10);
    change(spec);
    const auto result = simulateScan(spec, job);
    return !result && result.error().kind == ErrorKind::kInput && !result.error().line().empty();
  };
  EXPECT_TRUE(refused([](ScannerSpec& s) { s.part = "teapot"; }));
  EXPECT_TRUE(refused([](ScannerSpec& s) { s.width = 0; }));
  EXPECT_TRUE(refused([](ScannerSpec& s) { s.height = -5; }));
  EXPECT_TRUE(refused([](ScannerSpec& s) { s.width = Grid::kMaxSide + 1; }));
  EXPECT_TRUE(refused([](ScannerSpec& s) { s.noise = -1; }));
  EXPECT_TRUE(refused([](ScannerSpec& s) { s.noise = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_TRUE(refused([](ScannerSpec& s) { s.outliers = 1.5; }));
  EXPECT_TRUE(refused([](ScannerSpec& s) { s.dropouts = std::numeric_limits<double>::infinity(); }));
}

TEST(Scanner, StopsWhenCancelled) {
  JobControl job;
  job.cancel();
  const auto result = simulateScan(everything(), job);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
