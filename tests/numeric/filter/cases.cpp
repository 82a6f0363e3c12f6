#include "tests/numeric/filter/cases.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>

#include "tests/support/no_data.h"

namespace fettle::engine::tests {

namespace {

// Gaussian: filter.h, (n + 4) * 2^-51.
FilterCase gaussian(std::string name, int window, double sigma) {
  return {std::move(name), makeSpec(FilterKind::kGaussian, window, sigma), true, window + 4.0, false};
}

}  // namespace

std::vector<FilterCase> filterCases() {
  return {
      // Box: two roundings in double, each at most 2^-53 of the mean.
      {"box 3", makeSpec(FilterKind::kBox, 3), true, 0.5},
      {"box 5", makeSpec(FilterKind::kBox, 5), true, 0.5},
      {"box 41", makeSpec(FilterKind::kBox, 41), true, 0.5},
      gaussian("gaussian 3", 3, 0.0),
      gaussian("gaussian 7", 7, 0.0),
      gaussian("gaussian 15 sigma 2.7", 15, 2.7),
      gaussian("gaussian 41 sigma 1e6", 41, 1e6),
      {"median 3", makeSpec(FilterKind::kMedian, 3)},
      {"median 5", makeSpec(FilterKind::kMedian, 5)},
      {"median 7", makeSpec(FilterKind::kMedian, 7)},
      {"median 15", makeSpec(FilterKind::kMedian, 15)},
  };
}

long double FilterCase::errorOf(long double magnitude) const {
  return error * std::ldexp(magnitude, -51);
}

float WindowExtremes::magnitude(std::size_t i) const {
  return std::fmax(std::fabs(low[i]), std::fabs(high[i]));
}

WindowExtremes windowExtremes(const PlainField& field, int window) {
  const int radius = window / 2;
  const auto at = [&](int c, int r) { return static_cast<std::size_t>(r) * field.width + c; };
  WindowExtremes rows{std::vector<float>(field.z.size(), kInf), std::vector<float>(field.z.size(), -kInf)};
  WindowExtremes all = rows;
  for (int r = 0; r < field.height; ++r)
    for (int c = 0; c < field.width; ++c)
      for (int x = std::max(c - radius, 0); x <= std::min(c + radius, field.width - 1); ++x) {
        rows.low[at(c, r)] = std::fmin(rows.low[at(c, r)], field.at(x, r));
        rows.high[at(c, r)] = std::fmax(rows.high[at(c, r)], field.at(x, r));
      }
  for (int r = 0; r < field.height; ++r)
    for (int y = std::max(r - radius, 0); y <= std::min(r + radius, field.height - 1); ++y)
      for (int c = 0; c < field.width; ++c) {
        all.low[at(c, r)] = std::fmin(all.low[at(c, r)], rows.low[at(c, y)]);
        all.high[at(c, r)] = std::fmax(all.high[at(c, r)], rows.high[at(c, y)]);
      }
  return all;
}

std::vector<std::uint8_t> wholeWindows(const PlainField& field, int window) {
  const int radius = window / 2;
  // Holes before a sample, row by row and column by column, as a table of sums.
  const auto width = static_cast<std::size_t>(field.width) + 1;
  std::vector<int> holes(width * (static_cast<std::size_t>(field.height) + 1));
  const auto sum = [&](int c, int r) -> int& {
    return holes[static_cast<std::size_t>(r) * width + static_cast<std::size_t>(c)];
  };
  for (int r = 0; r < field.height; ++r)
    for (int c = 0; c < field.width; ++c)
      sum(c + 1, r + 1) = sum(c, r + 1) + sum(c + 1, r) - sum(c, r) + (std::isnan(field.at(c, r)) ? 1 : 0);
  std::vector<std::uint8_t> whole;
  for (int r = 0; r < field.height; ++r)
    for (int c = 0; c < field.width; ++c) {
      const bool inside = c >= radius && r >= radius && c + radius < field.width && r + radius < field.height;
      whole.push_back(inside && sum(c + radius + 1, r + radius + 1) - sum(c - radius, r + radius + 1) -
                                        sum(c + radius + 1, r - radius) + sum(c - radius, r - radius) ==
                                    0);
    }
  return whole;
}

Filtered filteredFrom(const Version& input, const Version& original, const FilterSpec& spec) {
  JobControl job;
  Result<Filtered> result = applyFilter(input, original, spec, job);
  if (!result) {
    fmt::print(stderr, "{}\n", result.error().line());
    std::abort();
  }
  return std::move(*result);
}

}  // namespace fettle::engine::tests
