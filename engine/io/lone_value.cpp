#include "engine/io/lone_value.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <fmt/format.h>

namespace fettle::engine {

namespace {

constexpr double kLeastShare = 0.01;         // of the samples that are no holes
constexpr double kLeastDistance = 0.1;       // of the range of the other heights
constexpr std::int64_t kFewestSamples = 16;  // samples with the value; other heights
constexpr double kFlat = 0.04;               // of the samples: another height that so many have
constexpr double kFlatBeside = 0.25;         // of those with the value, likewise
constexpr std::size_t kMostLoneValues = 2;
constexpr std::int32_t kLattice = 256;

// Heights on a lattice over the field, ascending.
std::vector<float> sampledHeights(const Version& field) {
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();
  const std::int32_t by_column = (grid.width + kLattice - 1) / kLattice;
  const std::int32_t by_row = (grid.height + kLattice - 1) / kLattice;
  std::vector<float> heights;
  for (std::int32_t r = 0; r < grid.height; r += by_row)
    for (std::int32_t c = 0; c < grid.width; c += by_column)
      if (const float z = reader.heightAt(c, r); !std::isnan(z)) heights.push_back(z);
  std::sort(heights.begin(), heights.end());
  return heights;
}

// A value and the heights around it.
struct Lone {
  float value = 0.0F;
  std::int64_t samples = 0, all = 0;                      // with the value; that are no holes
  float below = -std::numeric_limits<float>::infinity();  // nearest other heights
  float above = std::numeric_limits<float>::infinity();
  float lowest = std::numeric_limits<float>::infinity();  // of the others
  float highest = -std::numeric_limits<float>::infinity();

  void take(float z) {
    if (std::isnan(z)) return;
    ++all;
    if (z == value) {
      ++samples;
      return;
    }
    if (z < value)
      below = std::max(below, z);
    else
      above = std::min(above, z);
    lowest = std::min(lowest, z);
    highest = std::max(highest, z);
  }
  [[nodiscard]] double distance() const {
    return std::min(double{value} - double{below}, double{above} - double{value});
  }
  [[nodiscard]] bool far() const {
    return lowest < highest && distance() >= kLeastDistance * (double{highest} - double{lowest});
  }
  [[nodiscard]] double share() const { return static_cast<double>(samples) / static_cast<double>(all); }
};

// The values of the sampled heights that may be lone ones; a value has half its share there at least.
std::vector<float> candidates(const std::vector<float>& sampled) {
  std::vector<float> found;
  const auto fewest = std::max<std::ptrdiff_t>(
      kFewestSamples / 4,
      static_cast<std::ptrdiff_t>(0.5 * kLeastShare * static_cast<double>(sampled.size())));
  for (auto first = sampled.begin(); first != sampled.end();) {
    const auto last = std::upper_bound(first, sampled.end(), *first);
    if (last - first >= fewest) {
      Lone lone{*first};
      if (first != sampled.begin()) {
        lone.lowest = std::min(lone.lowest, sampled.front());
        lone.below = *(first - 1);
        lone.highest = std::max(lone.highest, lone.below);
      }
      if (last != sampled.end()) {
        lone.highest = std::max(lone.highest, sampled.back());
        lone.above = *last;
        lone.lowest = std::min(lone.lowest, lone.above);
      }
      if (lone.far()) found.push_back(*first);
    }
    first = last;
  }
  return found;
}

// Whether the other heights are those of a noisy surface: many, none of them nearly as frequent.
bool amongNoise(const std::vector<float>& sampled, float value) {
  std::ptrdiff_t distinct = 0, most = 0, here = 0;
  for (auto first = sampled.begin(); first != sampled.end();) {
    const auto last = std::upper_bound(first, sampled.end(), *first);
    if (*first == value) {
      here = last - first;
    } else {
      ++distinct;
      most = std::max(most, last - first);
    }
    first = last;
  }
  const double flat =
      std::max(kFlat * static_cast<double>(sampled.size()), kFlatBeside * static_cast<double>(here));
  return distinct >= kFewestSamples && static_cast<double>(most) <= flat;
}

}  // namespace

void doubtLoneValues(const Version& field, const HeightRule& rule, std::vector<std::string>& warnings) {
  const std::vector<float> sampled = sampledHeights(field);
  std::vector<Lone> lone;
  for (const float value : candidates(sampled))
    if (amongNoise(sampled, value)) lone.push_back({value});
  if (lone.empty() || lone.size() > kMostLoneValues) return;
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();
  std::vector<float> row(static_cast<std::size_t>(grid.width));
  for (std::int32_t r = 0; r < grid.height; ++r) {
    reader.readHeights(0, r, grid.width, 1, row.data(), grid.width);
    for (Lone& one : lone)
      for (const float z : row) one.take(z);
  }
  for (const Lone& one : lone) {
    if (one.samples < kFewestSamples || one.share() <= kLeastShare || !one.far()) continue;
    // As a float, so that a scale leaves no digits of its rounding behind.
    const float stored = HeightRule::toFloat((double{one.value} - rule.offset) / rule.scale);
    warnings.push_back(
        fmt::format("{:.3g} % of the samples are exactly {} {}, {:.6g} away from every other height: if they "
                    "are holes, give "
                    "--no-data {}",
                    100.0 * one.share(), one.value, grid.height_unit.name, one.distance(), stored));
  }
}

}  // namespace fettle::engine
