#include "engine/io/lone_value.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace fettle::engine {

namespace {

constexpr double kLeastShare = 0.01;         // of the samples that are no holes
constexpr double kLeastAmongNoise = 0.001;   // likewise, of a height among noise: a missed line of a thousand
constexpr double kNear = 0.02;               // of those with the value: samples near it
constexpr std::int64_t kFewestSamples = 16;  // samples with the value; other heights
constexpr double kFlat = 0.04;               // of the samples: share that another height may have
constexpr double kFlatNeighbour = 0.25;      // of those with the value, likewise
constexpr double kScattered = 0.1;           // of a frequent height's samples: those of a neighbouring height
constexpr double kMostEqual = 0.6;           // of neighbouring samples in coarse counts with noise
constexpr double kNoHeight = 1e20;           // no surface is that high in any unit
constexpr std::size_t kMostLoneValues = 2;
constexpr std::size_t kMostNumbers = 4;  // that stand for holes, at either end
constexpr int kMostPasses = 4;
constexpr std::int32_t kSketchSide = 256;

// Least distances, in multiples of the range of the rest.
constexpr double kFromNoise = 0.1;
constexpr double kWrittenForHoles = 1.0;
constexpr double kFromCounts = 1.0;
constexpr double kFarBeyond = 100.0;

// A height and the number of lattice samples that have it.
struct Level {
  float value = 0.0F;
  std::ptrdiff_t samples = 0;
};

// Statistics of a lattice over the field.
struct Sketch {
  std::vector<Level> levels;  // ascending
  std::ptrdiff_t samples = 0;
  std::ptrdiff_t pairs = 0;  // of neighbours in a row
  std::ptrdiff_t equal = 0;  // pairs of one height
};

Sketch sketchOf(const Version& field) {
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();
  const std::int32_t by_column = (grid.width + kSketchSide - 1) / kSketchSide;
  const std::int32_t by_row = (grid.height + kSketchSide - 1) / kSketchSide;
  Sketch sketch;
  std::vector<float> heights;
  // Each at another place of its block: a missed line lies in every row of blocks for some of their columns, whichever line it is.
  for (std::int32_t row = 0; row < grid.height; row += by_row)
    for (std::int32_t column = 0; column < grid.width; column += by_column) {
      const std::int32_t r = std::min(row + column / by_column % by_row, grid.height - 1),
                         c = std::min(column + row / by_row % by_column, grid.width - 1);
      const float z = reader.heightAt(c, r);
      if (std::isnan(z)) continue;
      heights.push_back(z);
      const float neighbour = c + 1 < grid.width ? reader.heightAt(c + 1, r) : z;
      if (c + 1 >= grid.width || std::isnan(neighbour)) continue;
      ++sketch.pairs;
      sketch.equal += static_cast<std::ptrdiff_t>(neighbour == z);
    }
  std::sort(heights.begin(), heights.end());
  sketch.samples = std::ssize(heights);
  for (auto first = heights.begin(); first != heights.end();) {
    const auto last = std::upper_bound(first, heights.end(), *first);
    sketch.levels.push_back({*first, last - first});
    first = last;
  }
  return sketch;
}

// The file's number for a height, as a float, to remove rounding digits of a scale.
float storedNumber(float height, const HeightRule& rule) {
  return HeightRule::toFloat((double{height} - rule.offset) / rule.scale);
}

// Whether programs write this number for holes.
bool writtenForHoles(float stored) {
  constexpr std::array kHoleNumbers{-32768.0F,     32767.0F,      -32767.0F, 65535.0F, -2147483648.0F,
                                    2147483648.0F, 4294967296.0F, 999.0F,    9999.0F,  99999.0F,
                                    999999.0F,     9999999.0F,    -999.0F,   -9999.0F, -99999.0F,
                                    -999999.0F,    -9999999.0F};
  return std::abs(stored) >= kNoHeight || std::ranges::find(kHoleNumbers, stored) != kHoleNumbers.end();
}

// The heights that are not lone.
struct Rest {
  float lowest = std::numeric_limits<float>::infinity();
  float highest = -std::numeric_limits<float>::infinity();
  std::ptrdiff_t heights = 0;  // different ones, of the lattice

  void take(float z) {
    lowest = std::min(lowest, z);
    highest = std::max(highest, z);
  }
  [[nodiscard]] double range() const { return double{highest} - double{lowest}; }
  // From outside the range; negative inside.
  [[nodiscard]] double distance(float z) const {
    return std::max(double{lowest} - double{z}, double{z} - double{highest});
  }
};

bool isOneOf(const std::vector<float>& values, float z) {
  return std::find(values.begin(), values.end(), z) != values.end();
}

Rest restOf(const std::vector<Level>& levels, const std::vector<float>& without) {
  Rest rest;
  for (const Level& level : levels)
    if (!isOneOf(without, level.value)) {
      rest.take(level.value);
      ++rest.heights;
    }
  return rest;
}

// Whether a number that is written for holes is too far from the surface to be a height.
bool isFarFromSurface(float value, const Rest& rest, const HeightRule& rule) {
  const bool levels = rest.lowest < rest.highest || std::abs(storedNumber(value, rule)) >= kNoHeight;
  return levels && rest.distance(value) >= kWrittenForHoles * rest.range() && rest.distance(value) > 0.0;
}

// Of the numbers that are written for holes, those that are far from all the rest.
std::vector<float> holeNumbers(const std::vector<Level>& levels, const HeightRule& rule) {
  std::vector<float> found;
  const auto take = [&](auto first, auto last) {
    for (std::size_t k = 0; k < kMostNumbers && first != last; ++k, ++first) {
      if (!writtenForHoles(storedNumber(first->value, rule))) return;
      if (!isOneOf(found, first->value)) found.push_back(first->value);
    }
  };
  // They lie outside of the rest.
  take(levels.begin(), levels.end());
  take(levels.rbegin(), levels.rend());
  // A number that may be a height belongs to the rest; the nearest first, since others may be far from it.
  while (!found.empty()) {
    const Rest rest = restOf(levels, found);
    if (rest.heights == 0) return {};
    const auto nearest = std::min_element(
        found.begin(), found.end(), [&](float a, float b) { return rest.distance(a) < rest.distance(b); });
    if (isFarFromSurface(*nearest, rest, rule)) break;
    found.erase(nearest);
  }
  return found;
}

// Least distance of a height from the others, in multiples of their range, to be lone among their noise;
// nothing where they are not those of a noisy surface.
std::optional<double> leastFromNoise(const Sketch& sketch, std::size_t lone) {
  std::vector<Level> others = sketch.levels;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(lone));
  if (std::ssize(others) < kFewestSamples) return std::nullopt;
  const auto flat = std::max(kFlat * static_cast<double>(sketch.samples),
                             kFlatNeighbour * static_cast<double>(sketch.levels[lone].samples));
  bool any = false;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const auto most = static_cast<double>(others[i].samples);
    if (most <= flat) continue;
    any = true;
    const auto neighbour = std::max(i > 0 ? others[i - 1].samples : 0,
                                    i + 1 < others.size() ? others[i + 1].samples : std::ptrdiff_t{0});
    if (static_cast<double>(neighbour) < kScattered * most) return std::nullopt;
  }
  if (!any) return kFromNoise;
  // Steps or a slope in coarse counts but without noise: neighbours are equal.
  if (static_cast<double>(sketch.equal) > kMostEqual * static_cast<double>(sketch.pairs)) return std::nullopt;
  return kFromCounts;
}

// A value that may stand for holes, with counts from the whole field.
struct Suspect {
  float value = 0.0F;
  double least_ranges = 0.0;    // from the rest
  double least_distance = 0.0;  // [height unit], likewise
  double least_share = 0.0;     // of the samples that are no holes
  bool among_noise = false;     // a few others may lie nearer
  bool hole_number = false;     // a number that is written for holes
  double reach = 0.0;           // [height unit] within which others are counted
  std::int64_t samples = 0, near = 0;
  float below = -std::numeric_limits<float>::infinity();  // nearest of the rest
  float above = std::numeric_limits<float>::infinity();

  [[nodiscard]] double distance() const {
    return std::min(double{value} - double{below}, double{above} - double{value});
  }
};

// Limit for heights as frequent as a lone value: at least half of its share is on the lattice.
std::ptrdiff_t fewestOnLattice(const Sketch& sketch, double share) {
  return std::max<std::ptrdiff_t>(
      kFewestSamples / 4, static_cast<std::ptrdiff_t>(0.5 * share * static_cast<double>(sketch.samples)));
}

// Whether few samples lie nearer to a height than that, beside those that have it.
bool standsApart(const std::vector<Level>& levels, std::size_t height, double distance) {
  const double most = kNear * static_cast<double>(levels[height].samples);
  std::ptrdiff_t near = 0;
  const auto isNear = [&](std::size_t i) {
    return std::abs(double{levels[i].value} - double{levels[height].value}) < distance;
  };
  for (std::size_t i = height; i > 0 && isNear(i - 1); --i)
    if (static_cast<double>(near += levels[i - 1].samples) > most) return false;
  for (std::size_t i = height + 1; i < levels.size() && isNear(i); ++i)
    if (static_cast<double>(near += levels[i].samples) > most) return false;
  return true;
}

std::vector<Suspect> amongNoise(const Sketch& sketch) {
  std::vector<Suspect> found;
  const std::vector<Level>& levels = sketch.levels;
  if (levels.size() < 3) return found;
  const std::ptrdiff_t fewest = fewestOnLattice(sketch, kLeastAmongNoise);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (levels[i].samples < fewest) continue;
    const double range = double{levels[i + 1 < levels.size() ? levels.size() - 1 : i - 1].value} -
                         double{levels[i > 0 ? 0 : 1].value};
    if (!(range > 0.0) || !standsApart(levels, i, kFromNoise * range)) continue;
    const auto least = leastFromNoise(sketch, i);
    if (!least || !standsApart(levels, i, *least * range)) continue;
    found.push_back({.value = levels[i].value,
                     .least_ranges = *least,
                     .least_share = kLeastAmongNoise,
                     .among_noise = true,
                     .reach = *least * range});
  }
  // Rare ones of a field that has many say nothing of those that are frequent.
  if (found.size() > kMostLoneValues)
    std::erase_if(found, [&](const Suspect& one) {
      const auto level = std::ranges::find(levels, one.value, &Level::value);
      return level->samples < fewestOnLattice(sketch, kLeastShare);
    });
  return found.size() > kMostLoneValues ? std::vector<Suspect>() : found;
}

// The outermost heights that are far beyond all others.
std::vector<Suspect> farBeyond(const Sketch& sketch, double least_distance) {
  const std::vector<Level>& levels = sketch.levels;
  for (std::size_t count = kMostLoneValues; count > 0; --count)
    for (std::size_t low = 0; low <= count && levels.size() > count; ++low) {
      std::vector<Suspect> outer;
      std::vector<float> values;
      for (std::size_t k = 0; k < count; ++k) {
        const Level& level = k < low ? levels[k] : levels[levels.size() - 1 - (k - low)];
        if (level.samples < fewestOnLattice(sketch, kLeastShare)) break;
        outer.push_back({.value = level.value,
                         .least_ranges = kFarBeyond,
                         .least_distance = least_distance,
                         .least_share = kLeastShare});
        values.push_back(level.value);
      }
      const Rest rest = restOf(levels, values);
      if (outer.size() == count && rest.heights >= kFewestSamples &&
          std::all_of(values.begin(), values.end(), [&](float value) {
            return rest.distance(value) >= std::max(kFarBeyond * rest.range(), least_distance);
          }))
        return outer;
    }
  return {};
}

// Counts over all samples of the field for the suspects.
struct Tally {
  Rest rest;
  std::int64_t all = 0;  // samples that are not holes
};

Tally tallyOf(const Version& field, std::vector<Suspect>& suspects) {
  Tally tally;
  for (Suspect& one : suspects) {
    one.samples = one.near = 0;
    one.below = -std::numeric_limits<float>::infinity();
    one.above = std::numeric_limits<float>::infinity();
  }
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();
  std::vector<float> row(static_cast<std::size_t>(grid.width));
  for (std::int32_t r = 0; r < grid.height; ++r) {
    reader.readHeights(0, r, grid.width, 1, row.data(), grid.width);
    for (const float z : row) {
      if (std::isnan(z)) continue;
      ++tally.all;
      const auto same =
          std::find_if(suspects.begin(), suspects.end(), [&](const Suspect& s) { return s.value == z; });
      if (same != suspects.end()) {
        ++same->samples;
        continue;
      }
      tally.rest.take(z);
      for (Suspect& one : suspects) {
        if (z < one.value)
          one.below = std::max(one.below, z);
        else
          one.above = std::min(one.above, z);
        one.near += static_cast<std::int64_t>(std::abs(double{z} - double{one.value}) < one.reach);
      }
    }
  }
  return tally;
}

bool isLone(const Suspect& one, const Tally& tally, const HeightRule& rule) {
  if (one.hole_number) {
    const std::int64_t fewest = std::abs(storedNumber(one.value, rule)) >= kNoHeight ? 1 : kFewestSamples;
    return one.samples >= fewest && isFarFromSurface(one.value, tally.rest, rule);
  }
  if (one.samples < kFewestSamples || !(tally.rest.lowest < tally.rest.highest) ||
      static_cast<double>(one.samples) <= one.least_share * static_cast<double>(tally.all))
    return false;
  if (one.among_noise) return static_cast<double>(one.near) <= kNear * static_cast<double>(one.samples);
  return one.distance() >= std::max(one.least_ranges * tally.rest.range(), one.least_distance);
}

std::vector<Suspect> suspectsOf(const Version& field, const HeightRule& rule) {
  Sketch sketch = sketchOf(field);
  // The lattice may have missed a rare value, the bounds have not.
  const HeightBounds bounds = field.reader().bounds();
  if (!bounds.empty() && !sketch.levels.empty()) {
    if (bounds.min < sketch.levels.front().value)
      sketch.levels.insert(sketch.levels.begin(), Level{bounds.min, 0});
    if (bounds.max > sketch.levels.back().value) sketch.levels.push_back({bounds.max, 0});
  }
  std::vector<Suspect> suspects;
  const std::vector<float> numbers = holeNumbers(sketch.levels, rule);
  suspects.reserve(numbers.size());
  for (const float value : numbers)
    suspects.push_back({.value = value, .least_ranges = kWrittenForHoles, .hole_number = true});
  if (rule.user_no_data) return suspects;
  for (const float value : numbers)
    std::erase_if(sketch.levels, [&](const Level& level) {
      if (level.value != value) return false;
      sketch.samples -= level.samples;
      return true;
    });
  const Grid& grid = field.grid();
  const double longest = std::max(grid.width * grid.spacingXMm(), grid.height * grid.spacingYMm());
  std::vector<Suspect> others = amongNoise(sketch);
  if (others.empty()) others = farBeyond(sketch, longest / grid.height_unit.mm);
  suspects.insert(suspects.end(), others.begin(), others.end());
  return suspects;
}

}  // namespace

std::vector<LoneValue> doubtLoneValues(const Version& field, const HeightRule& rule,
                                       std::vector<std::string>& warnings) {
  std::vector<Suspect> suspects = suspectsOf(field, rule);
  if (suspects.empty()) return {};
  Tally tally;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    tally = tallyOf(field, suspects);
    // What is said below is of these counts.
    if (pass + 1 == kMostPasses) break;
    // Heights that the lattice has missed may make the range larger.
    bool reach = true;
    for (Suspect& one : suspects) {
      if (!one.among_noise) continue;
      const double before = std::exchange(one.reach, one.least_ranges * tally.rest.range());
      reach = reach && one.reach == before;
    }
    // Beyond a rare number there may be another, which the lattice missed as well.
    const std::size_t known = suspects.size();
    for (const float end : {tally.rest.lowest, tally.rest.highest})
      if (std::isfinite(end) && writtenForHoles(storedNumber(end, rule)) && tally.rest.range() > 0.0)
        suspects.push_back({.value = end, .least_ranges = kWrittenForHoles, .hole_number = true});
    if (suspects.size() == known && reach) break;
  }
  std::vector<LoneValue> lone;
  lone.reserve(suspects.size());
  for (const Suspect& one : suspects) {
    if (!isLone(one, tally, rule)) continue;
    const float stored = storedNumber(one.value, rule);
    const std::string& unit = field.grid().height_unit.name;
    const std::string alone =
        one.near > 0 ? fmt::format("only {} within {:.6g} {} of that",
                                   one.near == 1 ? "1 other is" : fmt::format("{} others are", one.near),
                                   one.reach, unit)
                     : fmt::format("no other height is within {:.6g} {} of that", one.distance(), unit);
    warnings.push_back(fmt::format(
        "{:.3g} % of the samples are exactly {} {}, and {}: if they are holes{}",
        100.0 * static_cast<double>(one.samples) / static_cast<double>(tally.all), one.value, unit, alone,
        lone.empty()
            ? fmt::format(", give --no-data {}", stored)
            : fmt::format(" too, convert with the other number and read the result with --no-data {}, "
                          "which accepts one at a time",
                          stored)));
    lone.push_back({one.value, stored});
  }
  return lone;
}

}  // namespace fettle::engine
