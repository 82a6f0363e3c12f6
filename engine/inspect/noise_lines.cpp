#include "engine/inspect/noise_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <tbb/parallel_for.h>

namespace fettle::engine {

namespace {

constexpr std::int32_t kMostAlong = 512,
                       kPiece = 16;   // samples of a line that are read, and of them beside each other
constexpr std::size_t kFewAlong = 6;  // of half a line
constexpr std::size_t kFewLines = 12;
constexpr double kFourth = 70.0;  // sum of the squares of a fourth difference's weights
// By this a mean of squared fourth differences varies more than one of independent squares: 1 + 2 sum of their squared
// correlations (56, 28, 8 and 1 of 70).
constexpr double kOfFourth = 2.63;
constexpr double kSure =
    3.5;  // standard errors from 0, which few lines know badly: a share of kBadly / lines more
constexpr double kBadly = 12.0;
constexpr double kLeast = 0.003;  // of the variance of a sample
// Correlation of fourth differences that follow each other: -0.8 of independent offsets, known to 0.4 / sqrt(differences) (M. Bartlett, 1946),
// -0.5 of offsets that two lines share by halves, the cosine of the angle from line to line of a wave, of which 3 and more lines are one.
constexpr double kAlike = -0.5, kAlikeScatter = 3.0 * 0.4;
constexpr double kFar = 3.5;   // standard deviations of samples
constexpr double kEdge = 3.5;  // standard deviations of the other lines
constexpr std::size_t kBesideEdge = 3;
constexpr double kMostOfSpreads = 1.3;               // of the middle one
constexpr double kQuartiles = 1.349;                 // between those of normal numbers of deviation 1
constexpr double kQuarter = 0.3186, kHalf = 0.6745;  // |x| of standard normal numbers at these ranks

// The places along the lines that are read, in pieces.
std::vector<std::int32_t> placesAlong(std::int32_t side) {
  std::vector<std::int32_t> places;
  if (side <= kMostAlong) {
    for (std::int32_t i = 0; i < side; ++i) places.push_back(i);
    return places;
  }
  constexpr std::int32_t kPieces = kMostAlong / kPiece;
  for (std::int32_t k = 0; k < kPieces; ++k) {
    const auto from = static_cast<std::int32_t>(std::int64_t{k} * (side - kPiece) / (kPieces - 1));
    for (std::int32_t i = 0; i < kPiece; ++i) places.push_back(from + i);
  }
  return places;
}

// The value of this rank; reorders. Not empty.
double rankOf(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The median, the same upside down; reorders. Not empty.
double medianOf(std::vector<double>& values) {
  const double upper = rankOf(values, 0.5);
  if (values.size() % 2 == 1) return upper;
  return 0.5 * (upper + *std::min_element(values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                                          values.end()));
}

// The mean of what is within kFar standard deviations of it, from the median on: edges do not count at all. Not empty.
double meanOfNear(std::vector<double>& values, double deviation) {
  double middle = medianOf(values);
  for (int round = 0; round < 3; ++round) {
    double sum = 0.0, count = 0.0;
    for (const double value : values) {
      if (!(std::abs(value - middle) <= kFar * deviation)) continue;
      sum += value - middle;
      ++count;
    }
    if (count > 0.0) middle += sum / count;
  }
  return middle;
}

// A fourth difference of lines.
struct Differing {
  std::size_t first = 0;  // line
  double common = 0.0;    // mean of both halves' means
  double apart = 0.0;     // half of their difference
  bool edge = false;
};

struct LineHeights {
  std::vector<float> z;  // [line][place]
  std::size_t along = 0;

  [[nodiscard]] const float* line(std::size_t i) const { return z.data() + i * along; }
  void read(const FieldReader& reader, LineDirection direction, std::span<const std::int32_t> lines,
            const std::vector<std::int32_t>& places) {
    along = places.size();
    z.resize(lines.size() * along);
    tbb::parallel_for(std::size_t{0}, (lines.size() + kPiece - 1) / kPiece, [&](std::size_t group) {
      std::array<float, kPiece * kMostAlong> block;
      const std::size_t first = group * kPiece, end = std::min(first + kPiece, lines.size());
      for (std::size_t i = first; i < end; ++i)
        for (std::size_t p = 0; p < along;) {
          std::size_t q = p + 1;
          while (q < along && places[q] == places[q - 1] + 1) ++q;
          const auto count = static_cast<std::int32_t>(q - p);
          float* out = z.data() + i * along + p;
          if (direction == LineDirection::kRows)
            reader.readHeights(places[p], lines[i], count, 1, out, count);
          else
            reader.readHeights(lines[i], places[p], 1, count, block.data(), 1),
                std::copy_n(block.data(), count, out);
          p = q;
        }
    });
  }
};

using Halves = std::array<std::vector<double>, 2>;

// Fourth differences of five lines, of both halves; false: too few.
bool fourthDifferences(const LineHeights& heights, std::size_t first, Halves& half) {
  const std::size_t along = heights.along;
  std::array<const float*, 5> z{};
  for (std::size_t k = 0; k < z.size(); ++k) z[k] = heights.line(first + k);
  for (std::vector<double>& values : half) values.clear();
  for (std::size_t p = 0; p < along; ++p) {
    const double d = (double{z[0][p]} + double{z[4][p]}) - 4.0 * (double{z[1][p]} + double{z[3][p]}) +
                     6.0 * double{z[2][p]};
    // Quarters in turn: a surface that changes along the line is in both.
    if (!std::isnan(d)) half[p * 4 / along % 2].push_back(d);
  }
  return std::min(half[0].size(), half[1].size()) >= kFewAlong;
}

// The standard deviation of a sample's, by its quartiles; reorders.
double deviationOf(Halves& half) {
  double squares = 0.0;
  for (std::vector<double>& values : half) {
    const double low = rankOf(values, 0.25), high = rankOf(values, 0.75);
    squares += 0.5 * (high - low) * (high - low) / (kQuartiles * kQuartiles);
  }
  return std::sqrt(squares);
}

// The correlation of fourth differences with the next ones, without edges; below kAlike without any.
double neighbourCorrelation(std::span<const Differing> all) {
  double squares = 0.0, products = 0.0, count = 0.0, pairs = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].edge) continue;
    squares += all[i].common * all[i].common;
    ++count;
    if (i + 1 == all.size() || all[i + 1].edge || all[i + 1].first != all[i].first + 1) continue;
    products += all[i].common * all[i + 1].common;
    ++pairs;
  }
  return pairs > 0.0 && squares > 0.0 ? products / pairs / (squares / count) : -1.0;
}

double rankedSize(std::vector<double> values, double share) {
  for (double& value : values) value = std::abs(value);
  return rankOf(values, share);
}

// Differences of a line to the one before it.
void differencesTo(const LineHeights& heights, std::size_t line, std::vector<double>& differences) {
  differences.clear();
  const float *before = heights.line(line - 1), *here = heights.line(line);
  for (std::size_t p = 0; p < heights.along; ++p)
    if (const double d = double{here[p]} - double{before[p]}; !std::isnan(d)) differences.push_back(d);
}

// What lines are off from the first of those that follow each other.
std::vector<double> offsetsOf(const LineHeights& heights, std::span<const std::int32_t> lines) {
  std::vector<double> steps(lines.size(), 0.0), spreads(lines.size(), -1.0), known;
  const auto forEachNext = [&](const auto& use) {
    tbb::parallel_for(std::size_t{1}, lines.size(), [&](std::size_t i) {
      if (lines[i] != lines[i - 1] + 1) return;
      thread_local std::vector<double> differences;
      differencesTo(heights, i, differences);
      if (!differences.empty()) use(i, differences);
    });
  };
  forEachNext([&](std::size_t i, std::vector<double>& differences) {
    const double low = rankOf(differences, 0.25), high = rankOf(differences, 0.75);
    spreads[i] = (high - low) / kQuartiles;
  });
  known.reserve(spreads.size());
  for (const double spread : spreads)
    if (spread >= 0.0) known.push_back(spread);
  // By the spread of the surface, which is rougher than the noise: what of it is left out would change from line to line. That of a line
  // beside an edge along a quarter of it has the edge.
  const double most = known.empty() ? 0.0 : kMostOfSpreads * rankOf(known, 0.5);
  forEachNext([&](std::size_t i, std::vector<double>& differences) {
    steps[i] = meanOfNear(differences, std::min(spreads[i], most));
  });
  std::vector<double> offsets(lines.size(), 0.0);
  for (std::size_t i = 1; i < lines.size(); ++i)
    if (lines[i] == lines[i - 1] + 1) offsets[i] = offsets[i - 1] + steps[i];
  return offsets;
}

}  // namespace

LineNoise noiseOfLines(const FieldReader& reader, LineDirection direction,
                       std::span<const std::int32_t> lines) {
  LineNoise noise;
  const Grid& grid = reader.grid();
  LineHeights heights;
  heights.read(reader, direction, lines,
               placesAlong(direction == LineDirection::kRows ? grid.width : grid.height));
  const std::size_t fours = lines.size() >= 5 ? lines.size() - 4 : 0;
  std::vector<double> deviations(fours, -1.0);
  tbb::parallel_for(std::size_t{0}, fours, [&](std::size_t i) {
    thread_local Halves half;
    if (lines[i + 4] == lines[i] + 4 && fourthDifferences(heights, i, half))
      deviations[i] = deviationOf(half);
  });
  std::vector<Differing> all;
  std::vector<double> known;
  for (std::size_t i = 0; i < fours; ++i)
    if (deviations[i] >= 0.0) all.push_back({i}), known.push_back(deviations[i]);
  if (all.size() < kFewLines) return noise;
  const double deviation = rankOf(known, 0.5);
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    thread_local Halves half;
    fourthDifferences(heights, all[i].first, half);
    const double a = meanOfNear(half[0], deviation), b = meanOfNear(half[1], deviation);
    all[i].common = 0.5 * (a + b);
    all[i].apart = 0.5 * (a - b);
  });
  std::vector<double> common;
  common.reserve(all.size());
  for (const Differing& d : all) common.push_back(d.common);
  // The quieter quarter has no edge; from it to all that is like it.
  double most = kEdge * rankedSize(common, 0.25) / kQuarter;
  double products = 0.0, apart = 0.0, count = 0.0;
  constexpr int kRounds = 5;
  for (int round = 0; round < kRounds; ++round) {
    for (Differing& d : all) d.edge = false;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (std::abs(all[i].common) <= most) continue;
      // A step shows in four of them, the middle two most.
      for (std::size_t k = i - std::min(i, kBesideEdge); k <= i + kBesideEdge && k < all.size(); ++k)
        all[k].edge = true;
    }
    double squares = 0.0;
    products = apart = count = 0.0;
    for (const Differing& d : all) {
      if (d.edge) continue;
      squares += d.common * d.common;
      apart += d.apart * d.apart;
      products += d.common * d.common - d.apart * d.apart;  // of both halves
      ++count;
    }
    if (!(count >= kFewLines)) return noise;
    most = std::max(most, kEdge * std::sqrt(squares / count));
  }
  const double variance = products / count / kFourth;
  // What samples of both halves make of a product of means that are independent.
  const double by_samples = 2.0 * apart / count / kFourth * std::sqrt(kOfFourth / count);
  const double sample = deviation * deviation / kFourth;
  if (!(variance > kSure * (1.0 + kBadly / count) * by_samples && variance > kLeast * sample)) return noise;
  // Of offsets the half of the lines that is less off has as large a variance as all, but for its own scatter; edges are few.
  const double half = rankedSize(common, 0.5) / kHalf, scatter = std::sqrt(2.0 * kOfFourth / (0.37 * count));
  if (half * half < std::clamp(1.0 - 2.5 * scatter, 0.3, 0.5) * (products + apart) / count) return noise;
  if (neighbourCorrelation(all) > kAlike + kAlikeScatter / std::sqrt(count)) return noise;
  noise.variance = variance;
  noise.error = std::hypot(by_samples, variance * std::sqrt(2.0 * kOfFourth / count));
  noise.offsets = offsetsOf(heights, lines);
  return noise;
}

}  // namespace fettle::engine
