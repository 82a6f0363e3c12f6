#include "engine/suggest/synthetic_sample.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/piece.h"
#include "engine/scanner/scanner.h"
#include "engine/suggest/noise_source.h"

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
  const Version scan = scanOfSide(700, 300).scan;
  const Mosaic mosaic = makeMosaic(scan, 0.02);
  const FieldReader to = mosaic.field.reader();
  ASSERT_EQ(mosaic.pieces.size(), 8U);
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

TEST(SyntheticSample, HasTheNoiseOfTheScanOnASurfaceNearIt) {
  const SimulatedScan scan = scanOfSide(384, 384);
  JobControl job;
  const NoiseModel noise = *measureNoise(scan.scan, job);
  const Mosaic pieces = makeMosaic(scan.scan, noise.sigma);
  const auto sample = makeSyntheticSample(pieces, scan.scan.grid(), noise, 3, job);
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
