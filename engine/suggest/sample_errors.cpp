#include "engine/suggest/sample_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace fettle::engine {

namespace {

constexpr int kKinds = 12;
constexpr double kPlain = 12.0;         // [sigma]; what a tile of noise alone has is 8 to 9
constexpr double kLeastOfKind = 0.005;  // of the judged samples; fewer count with those of less relief
constexpr std::size_t kMostRare = 8;
constexpr std::size_t kRareOf = 5000;

std::vector<float> sampleHeights(const Version& field) {
  const Grid& grid = field.grid();
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  field.reader().readHeights(0, 0, grid.width, grid.height, z.data(), grid.width);
  return z;
}

// Of a tile of the scan, by its range of heights.
std::size_t kindOf(const HeightBounds& bounds, double sigma) noexcept {
  if (bounds.empty()) return 0;
  const double relief =
      (static_cast<double>(bounds.max) - static_cast<double>(bounds.min)) / (kPlain * sigma);
  return relief > 1.0 ? static_cast<std::size_t>(std::min(1.0 + std::log2(relief), kKinds - 1.0)) : 0;
}

// How often a judged sample counts, by the kind of its tile.
std::array<double, kKinds> countsOf(std::array<double, kKinds> scanned, std::array<double, kKinds> judged) {
  double all = 0.0;
  for (const double n : judged) all += n;
  std::array<bool, kKinds> few{};
  for (std::size_t k = kKinds - 1; k > 0; --k) {
    few[k] = judged[k] < kLeastOfKind * all;
    if (!few[k]) continue;
    scanned[k - 1] += scanned[k];
    judged[k - 1] += judged[k];
  }
  std::array<double, kKinds> counts;
  for (std::size_t k = 0; k < kKinds; ++k)
    counts[k] = few[k] ? counts[k - 1] : judged[k] > 0.0 ? scanned[k] / judged[k] : 1.0;
  return counts;
}

std::vector<float> weightsOf(const Version& scan, const Mosaic& pieces, const std::vector<float>& surface,
                             double sigma) {
  const FieldReader reader = scan.reader();
  const auto side = static_cast<std::size_t>(pieces.field.grid().width);
  std::array<double, kKinds> scanned{}, judged{};
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc) {
      const Tile& tile = reader.tile(tc, tr);
      if (!tile.bounds.empty())
        scanned[kindOf(tile.bounds, sigma)] += static_cast<double>(kTileSamples) - tile.nan_samples;
    }
  // visit(index in the mosaic, kind)
  const auto each = [&](auto&& visit) {
    for (const Mosaic::Piece& piece : pieces.pieces)
      for (std::int32_t r = piece.judged.row; r < piece.judged.row + piece.judged.rows; ++r)
        for (std::int32_t c = piece.judged.column; c < piece.judged.column + piece.judged.columns; ++c) {
          const std::size_t i = static_cast<std::size_t>(r) * side + static_cast<std::size_t>(c);
          if (std::isnan(surface[i])) continue;
          const std::int32_t column = piece.from.column + c - piece.column,
                             row = piece.from.row + r - piece.row;
          visit(i, kindOf(reader.tile(column / kTileSide, row / kTileSide).bounds, sigma));
        }
  };
  each([&judged](std::size_t, std::size_t kind) { judged[kind] += 1.0; });
  const std::array<double, kKinds> counts = countsOf(scanned, judged);
  std::vector<float> weights(surface.size());
  each([&](std::size_t i, std::size_t kind) { weights[i] = static_cast<float>(counts[kind]); });
  return weights;
}

// The mean of squares, with the largest few or without.
class ErrorMean {
 public:
  void add(double square, double weight) {
    ++samples_;
    squares_ += weight * square;
    weights_ += weight;
    if (square <= largest_.back().square) return;
    largest_.back() = {square, weight};
    for (std::size_t i = largest_.size() - 1; i > 0 && largest_[i].square > largest_[i - 1].square; --i)
      std::swap(largest_[i], largest_[i - 1]);
  }
  // NaN without samples.
  [[nodiscard]] double rms(SampleJudge::Rare rare) const {
    double squares = squares_, weights = weights_;
    const std::size_t left_out =
        rare == SampleJudge::Rare::kLeftOut ? std::min(kMostRare, samples_ / kRareOf) : 0;
    for (std::size_t i = 0; i < left_out; ++i) {
      squares -= largest_[i].weight * largest_[i].square;
      weights -= largest_[i].weight;
    }
    return weights > 0.0 ? std::sqrt(std::max(squares, 0.0) / weights)
                         : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  struct Large {
    double square = 0.0, weight = 0.0;
  };
  std::size_t samples_ = 0;
  double squares_ = 0.0, weights_ = 0.0;
  std::array<Large, kMostRare> largest_{};  // the largest first
};

}  // namespace

SampleJudge::SampleJudge(const Version& scan, const Mosaic& pieces, const SyntheticSample& sample,
                         double sigma)
    : surface_(sampleHeights(sample.surface)), zones_(zonesBesideMarks(sample.edges)) {
  if (pieces.field.grid().samples() != scan.grid().samples())
    weights_ = weightsOf(scan, pieces, surface_, sigma);
  double judged = 0.0, near = 0.0;
  for (std::size_t i = 0; i < zones_.size(); ++i) {
    if (std::isnan(surface_[i])) continue;
    const double weight = weights_.empty() ? 1.0 : static_cast<double>(weights_[i]);
    judged += weight;
    if (zones_[i] == SampleZone::kEdge) near += weight;
  }
  edge_share_ = judged > 0.0 ? near / judged : 0.0;
}

SampleErrors SampleJudge::errorsOf(const Version& filtered, Rare rare) const {
  const std::vector<float> heights = sampleHeights(filtered);
  ErrorMean flat, edge;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (zones_[i] == SampleZone::kBetween) continue;
    const double error = static_cast<double>(heights[i]) - static_cast<double>(surface_[i]);
    if (std::isnan(error)) continue;
    (zones_[i] == SampleZone::kFlat ? flat : edge)
        .add(error * error, weights_.empty() ? 1.0 : static_cast<double>(weights_[i]));
  }
  return {flat.rms(rare), edge.rms(rare)};
}

}  // namespace fettle::engine
