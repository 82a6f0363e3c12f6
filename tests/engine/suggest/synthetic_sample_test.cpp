#include "engine/suggest/synthetic_sample.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/field/piece.h"
#include "engine/scanner/scanner.h"
#include "engine/suggest/noise_source.h"
#include "engine/suggest/sample_edges.h"
#include "engine/suggest/sample_errors.h"

namespace fettle::engine {
namespace {

// Mean product of samples (across, up) apart.
double product(const std::vector<double>& z, int columns, int rows, int across, int up) {
  double sum = 0.0;
  for (int r = 0; r + up < rows; ++r)
    for (int c = 0; c + across < columns; ++c)
      sum += z[static_cast<std::size_t>(r * columns + c)] *
             z[static_cast<std::size_t>((r + up) * columns + c + across)];
  return sum / ((rows - up) * (columns - across));
}

// 500 x 400 samples: products of independent ones have a standard error of 1 / 447; correlated ones count for less.
// Four errors of half of them.
constexpr double kFourErrorsOfProducts = 0.013;

TEST(NoiseSource, MakesUncorrelatedNoise) {
  NoiseParts parts;
  parts.uncorrelated = 4.0;
  const auto z = NoiseSource(parts).make(500, 400, 7);
  EXPECT_NEAR(product(z, 500, 400, 0, 0) / 4.0, 1.0, std::sqrt(2.0) * kFourErrorsOfProducts);
  for (const auto& [across, up] : {std::pair{1, 0}, std::pair{0, 1}, std::pair{3, 2}})
    EXPECT_NEAR(product(z, 500, 400, across, up) / 4.0, 0.0, kFourErrorsOfProducts);
}

TEST(NoiseSource, MakesTheCovariancesThatItIsGiven) {
  NoiseParts parts;
  parts.uncorrelated = 1.0;
  parts.along_row = {0.5, 0.2, 0.05, 0.0, 0.0, 0.0};
  parts.along_column = {-0.2, 0.0, 0.0, 0.0, 0.0, 0.0};
  const auto z = NoiseSource(parts).make(500, 400, 8);
  EXPECT_NEAR(product(z, 500, 400, 0, 0), 1.0, 2.0 * kFourErrorsOfProducts);
  EXPECT_NEAR(product(z, 500, 400, 1, 0), 0.5, 2.0 * kFourErrorsOfProducts);
  EXPECT_NEAR(product(z, 500, 400, 2, 0), 0.2, 2.0 * kFourErrorsOfProducts);
  EXPECT_NEAR(product(z, 500, 400, 3, 0), 0.05, 2.0 * kFourErrorsOfProducts);
  EXPECT_NEAR(product(z, 500, 400, 4, 0), 0.0, 2.0 * kFourErrorsOfProducts);
  EXPECT_NEAR(product(z, 500, 400, 0, 1), -0.2, 2.0 * kFourErrorsOfProducts);
}

// As when counting the heights has more variance than the uncorrelated part.
TEST(NoiseSource, OfNothingUncorrelatedIsFinite) {
  NoiseParts parts;
  parts.along_row = {0.5, 0.2, 0.0, 0.0, 0.0, 0.0};
  parts.row_offset = 1.0;
  for (const double z : NoiseSource(parts).make(20, 30, 8)) ASSERT_TRUE(std::isfinite(z));
}

TEST(NoiseSource, MakesOffsetsOfRowsAndColumns) {
  NoiseParts parts;
  parts.row_offset = 1.0;
  const auto z = NoiseSource(parts).make(100, 400, 9);
  for (int r = 0; r < 400; r += 57)
    EXPECT_EQ(z[static_cast<std::size_t>(r * 100)], z[static_cast<std::size_t>(r * 100 + 99)]);
  // 400 of them: four times sqrt(2 / 400).
  EXPECT_NEAR(product(z, 100, 400, 0, 0), 1.0, 0.29);
  std::swap(parts.row_offset, parts.column_offset);
  const auto turned = NoiseSource(parts).make(400, 100, 9);
  EXPECT_EQ(turned[5], turned[99 * 400 + 5]);
  EXPECT_NE(turned[5], turned[6]);
}

TEST(NoiseSource, MakesTheSameOfTheSameSeedAlone) {
  NoiseParts parts;
  parts.uncorrelated = 1.0;
  parts.along_row = {0.3, 0.0, 0.0, 0.0, 0.0, 0.0};
  const NoiseSource source(parts);
  EXPECT_EQ(source.make(30, 20, 1), source.make(30, 20, 1));
  EXPECT_NE(source.make(30, 20, 1), source.make(30, 20, 2));
}

SimulatedScan scanOfSide(int width, int height) {
  ScannerSpec spec;
  spec.width = width;
  spec.height = height;
  JobControl job;
  return *simulateScan(spec, job);
}

TEST(Mosaic, HoldsPiecesOfTheScanWithHolesBetween) {
  const Version scan = scanOfSide(5300, 300).scan;
  const Mosaic mosaic = makeMosaic(scan, 0.02);
  const FieldReader to = mosaic.field.reader();
  ASSERT_EQ(mosaic.pieces.size(), 10U);
  std::vector<bool> covered(static_cast<std::size_t>(mosaic.field.grid().samples()));
  for (const Mosaic::Piece& p : mosaic.pieces) {
    EXPECT_EQ(p.column % 256, 0);
    EXPECT_EQ(p.row % 256, 0);
    EXPECT_EQ(contentHash(pieceOf(mosaic.field, p.column, p.row, p.from.columns, p.from.rows)),
              contentHash(pieceOf(scan, p.from.column, p.from.row, p.from.columns, p.from.rows)));
    for (int r = 0; r < p.from.rows; ++r)
      for (int c = 0; c < p.from.columns; ++c)
        covered[static_cast<std::size_t>((p.row + r) * to.width() + p.column + c)] = true;
    // Judged up to the scan's own border, and not next to a cut.
    EXPECT_EQ(p.judged.column - p.column, p.from.column > 0 ? kMosaicMargin : 0);
  }
  for (int r = 0; r < to.height(); ++r)
    for (int c = 0; c < to.width(); ++c)
      ASSERT_TRUE(covered[static_cast<std::size_t>(r * to.width() + c)] || std::isnan(to.heightAt(c, r)));
}

TEST(Mosaic, OfASmallScanIsTheScan) {
  const Version scan = scanOfSide(120, 90).scan;
  const Mosaic mosaic = makeMosaic(scan, 0.02);
  ASSERT_EQ(mosaic.pieces.size(), 1U);
  EXPECT_EQ(contentHash(mosaic.field), contentHash(scan));
  EXPECT_EQ(mosaic.pieces[0].judged, (SampleRect{0, 0, 120, 90}));
}

TEST(SyntheticSample, HasTheCountsOfTheScan) {
  const SimulatedScan scan = scanOfSide(256, 256);
  const HeightCounts counts = findHeightCounts(scan.scan);
  ASSERT_GT(counts.step, 0.0);
  JobControl job;
  const NoiseModel noise = *measureNoise(scan.scan, job);
  const auto sample =
      makeSyntheticSample(makeMosaic(scan.scan, noise.sigma), scan.scan.grid(), noise, counts, 3, job);
  ASSERT_TRUE(sample);
  const HeightCounts found = findHeightCounts(sample->scan);
  EXPECT_NEAR(found.step, counts.step, 1e-6 * counts.step);
}

constexpr double kEdgeNoise = 0.02;

double noEdges(int, int) {
  return 0.0;
}

// The edges of a sample of 256 x 256: of the heights of its surface, of what a scan with noise shows of them, and of what one
// with a quarter of that shows.
template <class Surface, class Scan, class Faint>
Result<Version> sampleEdgesOf(Surface&& surface, Scan&& scan, Faint&& faint, std::uint64_t seed) {
  Grid grid;
  grid.width = grid.height = 256;
  NoiseParts parts;
  parts.uncorrelated = 1.0;
  const auto noise = NoiseSource(parts).make(grid.width, grid.height, seed);
  std::vector<float> surface_z, scan_z, faint_z;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const double n = kEdgeNoise * noise[surface_z.size()];
      surface_z.push_back(static_cast<float>(surface(c, r)));
      scan_z.push_back(static_cast<float>(scan(c, r) + n));
      faint_z.push_back(static_cast<float>(faint(c, r) + 0.25 * n));
    }
  JobControl job;
  return markSampleEdges(makeField(grid, scan_z), makeField(grid, surface_z), makeField(grid, faint_z),
                         kEdgeNoise, job);
}

// A groove 60 samples from a rib of one sample, a step of a fifth of the rib, and a hill without edges.
TEST(SampleEdges, AreThoseOfRibsAndStepsAndNotOfCurves) {
  const auto heights = [](int c, int r) {
    const double z = c == 40 ? 0.5 : c >= 200 ? 0.1 : 0.0;
    return r >= 100 && r <= 150 ? z + 2e-4 * (r - 100) * (150 - r) : z;  // creases where it ends
  };
  const auto edges = sampleEdgesOf(heights, heights, heights, 21);
  ASSERT_TRUE(edges);
  const FieldReader reader = edges->reader();
  const auto marked = [&reader](int column, int row) {
    for (int c = column - 1; c <= column + 1; ++c)
      if (reader.markedAt(c, row)) return true;
    return false;
  };
  int rib = 0, step = 0, plain = 0;
  for (int r = 20; r < 90; ++r) {
    rib += marked(40, r) ? 1 : 0;
    step += marked(200, r) ? 1 : 0;
    for (int c = 60; c < 180; ++c) plain += reader.markedAt(c, r) ? 1 : 0;
  }
  EXPECT_EQ(rib, 70);
  EXPECT_GE(step, 56);  // thinning leaves gaps
  EXPECT_LE(plain, 10);
  int hill = 0;
  for (int r = 108; r < 143; ++r)
    for (int c = 60; c < 180; ++c) hill += reader.markedAt(c, r) ? 1 : 0;
  EXPECT_LE(hill, 10);
}

// What generalised variation makes of noise is as high as the lower of these.
TEST(SampleEdges, OfTheSurfaceAreStepsOfTwoAndAHalfNoisesAtLeast) {
  const auto heights = [](int c, int) {
    return (c >= 80 ? 2.3 * kEdgeNoise : 0.0) + (c >= 180 ? 2.7 * kEdgeNoise : 0.0);
  };
  // In the scan neither is seen: the search there is not what is tested.
  const auto edges = sampleEdgesOf(heights, noEdges, heights, 22);
  ASSERT_TRUE(edges);
  int low = 0, high = 0;
  for (int r = 20; r < 236; ++r)
    for (int c = -2; c <= 2; ++c) {
      low += edges->reader().markedAt(80 + c, r) ? 1 : 0;
      high += edges->reader().markedAt(180 + c, r) ? 1 : 0;
    }
  EXPECT_EQ(low, 0);
  EXPECT_GE(high, 216 * 8 / 10);  // thinning leaves gaps
}

// Across rows, where the scan shows none: a rib of one row jumps up to it and down from it, a ramp nowhere, however steep.
TEST(SampleEdges, OfTheSurfaceLieBetweenTheTwoRowsOfAJump) {
  constexpr double kRise = 15.0 * kEdgeNoise;
  const auto heights = [](int, int r) { return (r == 40 ? 0.5 : 0.0) + kRise * std::clamp(r - 150, 0, 10); };
  const auto edges = sampleEdgesOf(heights, noEdges, noEdges, 23);
  ASSERT_TRUE(edges);
  const auto marked = [&](int row) {
    int count = 0;
    for (int c = 20; c < 236; ++c) count += edges->reader().markedAt(c, row) ? 1 : 0;
    return count;
  };
  EXPECT_EQ(marked(39), 216);
  EXPECT_EQ(marked(40), 216);
  // The search finds some in the noise.
  for (const int row : {37, 38, 41, 42}) EXPECT_LE(marked(row), 10) << row;
  for (int row = 145; row < 166; ++row) EXPECT_LE(marked(row), 10) << row;
}

// Heights of plain places, and of those with steps, of which the noise is a fiftieth. Both are of one kind where neither is
// twelve noises high, and of two kinds on both sides of that and of twice that.
struct Relief {
  float plain, steps;
};

class SampleJudgeKinds : public testing::TestWithParam<Relief> {};

// Nineteen parts of twenty of the scan are plain, their errors 1; the rest has steps, its errors 3.
TEST_P(SampleJudgeKinds, CountsPlainPlacesAsOftenAsTheScanHasThem) {
  const auto [plain, steps] = GetParam();
  Grid grid;
  grid.width = 1280;
  grid.height = 1280;
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  for (std::size_t i = 0; i < z.size(); ++i) {
    const std::size_t c = i % 1280;
    z[i] = static_cast<float>((c / 32) % 2) * (c < 1216 ? plain : steps);
  }
  const Version scan = makeField(grid, z);
  const Mosaic pieces = makeMosaic(scan, 0.02);
  ASSERT_EQ(pieces.pieces.size(), 25U);
  SyntheticSample sample;
  // No edges, so that all are flats.
  std::vector<float> surface(static_cast<std::size_t>(pieces.field.grid().samples()), std::nanf(""));
  std::vector<float> filtered(surface.size());
  for (const Mosaic::Piece& piece : pieces.pieces)
    for (int r = piece.judged.row; r < piece.judged.row + piece.judged.rows; ++r)
      for (int c = piece.judged.column; c < piece.judged.column + piece.judged.columns; ++c) {
        const std::size_t i =
            static_cast<std::size_t>(r) * static_cast<std::size_t>(pieces.field.grid().width) +
            static_cast<std::size_t>(c);
        surface[i] = 0.0F;
        filtered[i] = piece.from.column + c - piece.column < 1216 ? 1.0F : 3.0F;
      }
  sample.surface = makeField(pieces.field.grid(), surface);
  sample.edges = sample.surface;
  const SampleJudge judge(scan, pieces, sample, 0.02);
  const SampleErrors errors =
      judge.errorsOf(makeField(pieces.field.grid(), filtered), SampleJudge::Rare::kCount);
  EXPECT_NEAR(errors.flat, std::sqrt((19.0 * 1.0 + 1.0 * 9.0) / 20.0), 0.01);
  EXPECT_TRUE(std::isnan(errors.edge));
  EXPECT_EQ(judge.edgeShare(), 0.0);
}

// 0.24 is twelve noises.
INSTANTIATE_TEST_SUITE_P(Reliefs, SampleJudgeKinds,
                         testing::Values(Relief{0.0F, 10.0F}, Relief{0.0F, 0.27F}, Relief{0.45F, 0.5F}));

TEST(SampleJudge, LeavesOutTheLargestFewWhereAsked) {
  Grid grid;
  grid.width = grid.height = 200;
  std::vector<float> z(40000);
  const Version flat = makeField(grid, z);
  const SyntheticSample sample{flat, flat, flat, 0};
  const SampleJudge judge(flat, makeMosaic(flat, 0.02), sample, 0.02);
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = i % 2 == 0 ? 1.0F : -1.0F;
  z[7] = 400.0F, z[30000] = -700.0F, z[20000] = 500.0F;
  // As many as a filter takes for lone samples at the tips of a rib.
  for (std::size_t i = 100; i < 105; ++i) z[i] = 300.0F;
  const Version filtered = makeField(grid, z);
  EXPECT_NEAR(judge.errorsOf(filtered, SampleJudge::Rare::kLeftOut).flat, 1.0, 1e-12);
  EXPECT_NEAR(judge.errorsOf(filtered, SampleJudge::Rare::kCount).flat,
              std::sqrt((39992.0 + 160000.0 + 490000.0 + 250000.0 + 5.0 * 90000.0) / 40000.0), 1e-9);
}

// Outliers along the upper rim of a step: three of an outlier's neighbours are low, five are high.
TEST(SyntheticSample, AnOutliersPlaceIsAsHighAsMostOfItsNeighbours) {
  constexpr int kSide = 256, kStep = 128;
  constexpr double kNoise = 0.01;
  Grid grid;
  grid.width = grid.height = kSide;
  NoiseParts parts;
  parts.uncorrelated = 1.0;
  const auto noise = NoiseSource(parts).make(kSide, kSide, 24);
  std::vector<float> z;
  for (std::size_t i = 0; i < noise.size(); ++i)
    z.push_back(static_cast<float>((i % kSide >= kStep ? 1.0 : 0.0) + kNoise * noise[i]));
  std::vector<int> rows;
  for (int r = 10; r < kSide - 10; r += 8) {
    rows.push_back(r);
    z[static_cast<std::size_t>(r * kSide + kStep)] = 5.0F;
  }
  const Version scan = makeField(grid, z);
  JobControl job;
  const NoiseModel model = *measureNoise(scan, job);
  const auto sample = makeSyntheticSample(makeMosaic(scan, model.sigma), grid, model, {}, 3, job);
  ASSERT_TRUE(sample);
  EXPECT_GE(sample->outliers, static_cast<std::int64_t>(rows.size()));
  for (const int r : rows) EXPECT_NEAR(sample->surface.reader().heightAt(kStep, r), 1.0F, 0.1F) << r;
}

TEST(SyntheticSample, HasTheNoiseOfTheScanOnASurfaceNearIt) {
  const SimulatedScan scan = scanOfSide(384, 384);
  JobControl job;
  const NoiseModel noise = *measureNoise(scan.scan, job);
  const Mosaic pieces = makeMosaic(scan.scan, noise.sigma);
  const auto sample = makeSyntheticSample(pieces, scan.scan.grid(), noise, {}, 3, job);
  ASSERT_TRUE(sample);
  const Grid& grid = pieces.field.grid();
  double squares = 0.0;
  std::int64_t count = 0;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const double off = static_cast<double>(sample->scan.reader().heightAt(c, r)) -
                         static_cast<double>(sample->surface.reader().heightAt(c, r));
      if (std::isnan(off)) continue;
      squares += off * off;
      ++count;
    }
  // Offsets of some 400 rows have a part of 5 % in the variance.
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(count)) / noise.sigma, 1.0, 0.03);
  std::int64_t judged = 0;
  for (const Mosaic::Piece& p : pieces.pieces) judged += std::int64_t{p.judged.columns} * p.judged.rows;
  EXPECT_GT(count, judged * 9 / 10);  // the scan has through holes
  EXPECT_LE(count, judged);
}

}  // namespace
}  // namespace fettle::engine
