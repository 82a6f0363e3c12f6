#include "engine/measure/align_repeat.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "engine/measure/align_search.h"
#include "engine/measure/spatial.h"
#include "engine/measure/surface.h"

namespace fettle::engine {

namespace {

constexpr double kNoPlace = std::numeric_limits<double>::quiet_NaN();

// Means of n x n places; of fewer than half of them a hole.
HeightMap coarserMap(const HeightMap& map, std::int32_t n) {
  HeightMap out = map;
  out.width = map.width / n;
  out.height = map.height / n;
  out.x0 += 0.5 * (n - 1) * map.spacing_x;
  out.y0 += 0.5 * (n - 1) * map.spacing_y;
  out.spacing_x *= n;
  out.spacing_y *= n;
  out.own_x = std::hypot(map.own_x, map.spacing_x * std::sqrt((static_cast<double>(n) * n - 1.0) / 12.0));
  out.own_y = std::hypot(map.own_y, map.spacing_y * std::sqrt((static_cast<double>(n) * n - 1.0) / 12.0));
  out.z.assign(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height), kNoPlace);
  for (std::int32_t r = 0; r < out.height; ++r)
    for (std::int32_t c = 0; c < out.width; ++c) {
      double sum = 0.0;
      std::int32_t count = 0;
      for (std::int32_t j = 0; j < n; ++j)
        for (std::int32_t i = 0; i < n; ++i) {
          const double z = map.at(c * n + i, r * n + j);
          if (std::isnan(z)) continue;
          sum += z;
          ++count;
        }
      if (2 * count >= n * n) out.z[out.index(c, r)] = sum / count;
    }
  return out;
}

// By as much that no more than so many places are left.
std::int32_t reductionTo(const HeightMap& map, double places) {
  return std::max(1, static_cast<std::int32_t>(
                         std::ceil(std::sqrt(static_cast<double>(map.width) * map.height / places))));
}

// The map without waves longer than about a tenth of it, which are taken of a coarser one.
Surface shortWavesOf(const HeightMap& map) {
  constexpr double kFew = 64.0 * 64.0;
  const HeightMap coarse = coarserMap(map, reductionTo(map, kFew));
  const double sigma = 0.1 * std::max(map.width * map.spacing_x, map.height * map.spacing_y);
  const MapSpline waves(smoothed(coarse, sigma, AtHoles::kStay, Borders::kStay).value);
  HeightMap rest = map;
  for (std::int32_t r = 0; r < map.height; ++r)
    for (std::int32_t c = 0; c < map.width; ++c) {
      const MapSpline::Place wave = waves.at(map.x0 + c * map.spacing_x, map.y0 + r * map.spacing_y);
      double& z = rest.z[rest.index(c, r)];
      z = wave.there ? z - wave.z : kNoPlace;
    }
  clipSpikes(rest);
  Surface surface;
  surface.width = rest.width;
  surface.height = rest.height;
  surface.spacing_x = rest.spacing_x;
  surface.spacing_y = rest.spacing_y;
  double sum = 0.0;
  for (const double z : rest.z)
    if (!std::isnan(z)) {
      sum += z;
      ++surface.samples;
    }
  const double mean = surface.samples > 0 ? sum / static_cast<double>(surface.samples) : 0.0;
  surface.heights.reserve(rest.z.size());
  for (const double z : rest.z) surface.heights.push_back(static_cast<float>(z - mean));
  return surface;
}

struct RepeatPeak {
  std::int32_t x = 0, y = 0;  // [lags]
  double value = 0.0;
  double length = 0.0;  // [mm]
};

double lengthOf(const Autocorrelation& of, std::int32_t x, std::int32_t y) noexcept {
  return std::hypot(x * of.spacing_x, y * of.spacing_y);
}

// Its local maxima above a level, of a half plane.
std::vector<RepeatPeak> peaksOf(const Autocorrelation& of, double level) {
  std::vector<RepeatPeak> peaks;
  const auto isGreatest = [&of](std::int32_t x, std::int32_t y) {
    for (std::int32_t j = -1; j <= 1; ++j)
      for (std::int32_t i = -1; i <= 1; ++i) {
        if (std::abs(x + i) > of.lags_x || std::abs(y + j) > of.lags_y) return false;
        if (!(of.at(x + i, y + j) <= of.at(x, y))) return false;
      }
    return true;
  };
  for (std::int32_t y = 0; y < of.lags_y; ++y)
    for (std::int32_t x = y == 0 ? 1 : -of.lags_x + 1; x < of.lags_x; ++x)
      if (of.at(x, y) > level && isGreatest(x, y)) peaks.push_back({x, y, of.at(x, y), lengthOf(of, x, y)});
  return peaks;
}

// Whether nothing within half of its length is greater: else it is a ripple, as on the slope of the maximum without a lag.
bool standsAlone(const Autocorrelation& of, const RepeatPeak& peak) noexcept {
  const double reach = 0.5 * peak.length;
  const auto across = static_cast<std::int32_t>(reach / of.spacing_x),
             up = static_cast<std::int32_t>(reach / of.spacing_y);
  for (std::int32_t j = -up; j <= up; ++j)
    for (std::int32_t i = -across; i <= across; ++i) {
      if (lengthOf(of, i, j) > reach) continue;
      const std::int32_t x = peak.x + i, y = peak.y + j;
      if (std::abs(x) <= of.lags_x && std::abs(y) <= of.lags_y && of.at(x, y) > peak.value) return false;
    }
  return true;
}

// Tukey's loss of a residual, 0 .. 1: a place where one field differs counts no more than any other.
double lossOf(double residual, double size) noexcept {
  constexpr double kBiweight = 4.685;
  const double x = residual / (kBiweight * size);
  if (std::abs(x) >= 1.0) return 1.0;
  const double rest = 1.0 - x * x;
  return 1.0 - rest * rest * rest;
}

}  // namespace

Result<std::vector<glm::dvec2>> likelyRepeats(const HeightMap& map, JobControl& job) {
  constexpr double kMostPlaces = 1 << 18, kLeast = 0.3, kOfGreatest = 0.8;
  constexpr std::size_t kMostPeaks = 64, kMost = 4;
  const Surface surface = shortWavesOf(coarserMap(map, reductionTo(map, kMostPlaces)));
  std::vector<glm::dvec2> shifts;
  if (surface.samples < 64) return shifts;
  JobControl own = JobControl::partOf(job);  // whose stages are not shown
  const auto analysis = correlate(surface, own);
  if (!analysis) return tl::unexpected(analysis.error());
  const Autocorrelation& correlation = analysis->correlation;
  if (correlation.values.empty()) return shifts;  // it is flat, or a line
  std::vector<RepeatPeak> peaks = peaksOf(correlation, kLeast);
  std::ranges::stable_sort(peaks, std::greater<>(), &RepeatPeak::value);
  peaks.resize(std::min(peaks.size(), kMostPeaks));
  std::erase_if(peaks, [&](const RepeatPeak& peak) { return !standsAlone(correlation, peak); });
  if (peaks.empty()) return shifts;
  const double least = kOfGreatest * peaks.front().value;
  std::erase_if(peaks, [least](const RepeatPeak& peak) { return peak.value < least; });
  std::ranges::stable_sort(peaks, std::less<>(), &RepeatPeak::length);
  peaks.resize(std::min(peaks.size(), kMost));
  for (const RepeatPeak& peak : peaks)
    shifts.emplace_back(peak.x * correlation.spacing_x, peak.y * correlation.spacing_y);
  return shifts;
}

bool fitsAsWell(const AlignLevel& level, const std::vector<AlignLevel::Under>& best,
                const std::vector<AlignLevel::Under>& other, const AlignSpread& spread) {
  constexpr int kBlocks = AlignLevel::kBlocks;
  constexpr double kErrors = 4.0, kOfOne = 6.0, kOfLeast = 3.0, kNormal = 1.4826;
  const auto both = [&](std::size_t i) {
    return !std::isnan(best[i].residual) && !std::isnan(other[i].residual);
  };
  // The blocks are of what both have, which may be a small region of the field.
  const std::vector<AlignLevel::Point>& points = level.points();
  double left = kNoPlace, right = kNoPlace, low = kNoPlace, high = kNoPlace;
  std::size_t of_best = 0, common = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    of_best += std::isnan(best[i].residual) ? 0 : 1;
    if (!both(i)) continue;
    ++common;
    left = std::fmin(left, points[i].x);
    right = std::fmax(right, points[i].x);
    low = std::fmin(low, points[i].y);
    high = std::fmax(high, points[i].y);
  }
  if (common < 12 || 2 * common < of_best) return false;
  const auto blockOf = [](double at, double from, double to) {
    return std::clamp(static_cast<int>(kBlocks * (at - from) / std::max(to - from, 1e-300)), 0, kBlocks - 1);
  };
  std::vector<double> sums(static_cast<std::size_t>(kBlocks * kBlocks), kNoPlace);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!both(i)) continue;
    const double size = spread.at(best[i]);
    const double more = lossOf(other[i].residual, size) - lossOf(best[i].residual, size);
    double& sum = sums[static_cast<std::size_t>(blockOf(points[i].y, low, high) * kBlocks +
                                                blockOf(points[i].x, left, right))];
    sum = std::isnan(sum) ? more : sum + more;
  }
  std::erase_if(sums, [](double sum) { return std::isnan(sum); });
  double all = 0.0, squares = 0.0;
  std::vector<double> sizes;
  for (const double sum : sums) {
    all += sum;
    squares += sum * sum;
    sizes.push_back(std::abs(sum));
  }
  if (all > kErrors * std::sqrt(squares)) return false;
  // One place that only the best motion brings onto itself stands out from how the other blocks scatter; where either field is damaged one
  // motion is as much better in one block as the other in another.
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::ranges::nth_element(sizes, middle);
  const auto [least, most] = std::ranges::minmax(sums);
  return !(most > kOfOne * kNormal * *middle && most > -kOfLeast * least);
}

}  // namespace fettle::engine
