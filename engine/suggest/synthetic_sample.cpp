#include "engine/suggest/synthetic_sample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/field/builder.h"
#include "engine/filter/catalogue.h"
#include "engine/marks/edge_suggestion.h"
#include "engine/scanner/counter_random.h"

namespace fettle::engine {

namespace {

struct Samples {
  Grid grid;
  std::vector<float> z;
  std::vector<std::uint8_t> marks;
};

Samples samplesOf(const Version& field) {
  Samples s{field.grid(), {}, {}};
  s.z.resize(static_cast<std::size_t>(s.grid.samples()));
  s.marks.resize(s.z.size());
  field.reader().readHeights(0, 0, s.grid.width, s.grid.height, s.z.data(), s.grid.width);
  field.reader().readMarks(0, 0, s.grid.width, s.grid.height, s.marks.data(), s.grid.width);
  return s;
}

// Samples that differ strongly from all their neighbours, and the median of these; NaN elsewhere.
std::vector<float> outliersOf(const Samples& s, double sigma, std::int64_t& count) {
  std::vector<float> instead(s.z.size(), std::nanf(""));
  const int w = s.grid.width, h = s.grid.height;
  const auto at = [w](int c, int r) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(w) + static_cast<std::size_t>(c);
  };
  std::array<float, 9> around;
  for (int r = 0; r < h; ++r)
    for (int c = 0; c < w; ++c) {
      std::size_t n = 0;
      for (int y = std::max(r - 1, 0); y <= std::min(r + 1, h - 1); ++y)
        for (int x = std::max(c - 1, 0); x <= std::min(c + 1, w - 1); ++x)
          if (const float v = s.z[at(x, y)]; v == v && (x != c || y != r)) around[n++] = v;
      const auto z = static_cast<double>(s.z[at(c, r)]);
      if (z != z || n < 4) continue;
      const auto end = around.begin() + static_cast<std::ptrdiff_t>(n);
      const auto [lowest, highest] = std::minmax_element(around.begin(), end);
      const bool above = z - static_cast<double>(*highest) > 6.0 * sigma;
      const bool below = static_cast<double>(*lowest) - z > 6.0 * sigma;
      if (!above && !below) continue;
      std::nth_element(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(n / 2), end);
      instead[at(c, r)] = around[n / 2];
      ++count;
    }
  return instead;
}

Result<Version> smoothed(const Version& field, double sigma, JobControl& job) {
  FilterSpec first;
  first.kind = FilterKind::kBilateral;
  first.window = 7;
  first.range_sigma = filterOf(first.kind).noises * sigma;
  auto once = applyFilter(field, field, first, job);
  if (!once) return tl::unexpected(once.error());
  FilterSpec second;
  second.kind = FilterKind::kTotalVariation;
  second.window = 41;
  second.range_sigma = filterOf(second.kind).noises * sigma;
  auto twice = applyFilter(once->field, field, second, job);
  if (!twice) return tl::unexpected(twice.error());
  return std::move(twice->field);
}

}  // namespace

Result<SyntheticSample> makeSyntheticSample(const Version& piece, double sigma, std::uint64_t seed,
                                            JobControl& job) {
  SyntheticSample made;
  Samples clean = samplesOf(piece);
  const std::vector<float> raw = clean.z;
  const std::vector<float> instead = outliersOf(clean, sigma, made.outliers);
  for (std::size_t i = 0; i < raw.size(); ++i)
    if (instead[i] == instead[i]) clean.z[i] = instead[i];
  // Without marks: everything is smoothed.
  auto surface = smoothed(makeField(clean.grid, clean.z, {}), sigma, job);
  if (!surface) return tl::unexpected(surface.error());
  made.surface = *std::move(surface);

  Samples noisy = samplesOf(made.surface);
  const CounterRandom random(seed, 0);
  for (std::int32_t r = 0; r < noisy.grid.height; ++r)
    for (std::int32_t c = 0; c < noisy.grid.width; ++c) {
      const std::size_t i = static_cast<std::size_t>(r) * static_cast<std::size_t>(noisy.grid.width) +
                            static_cast<std::size_t>(c);
      noisy.z[i] = instead[i] == instead[i]
                       ? raw[i]
                       : static_cast<float>(static_cast<double>(noisy.z[i]) + sigma * random.normal(c, r));
    }
  made.scan = makeField(noisy.grid, noisy.z, clean.marks);

  const auto map = findEdges(piece, EdgeMap::kUsualSigma, job);
  if (!map) return tl::unexpected(map.error());
  EdgeChoice line;
  line.thickness = 0.0;
  auto edges = suggestMarks(makeField(clean.grid, raw, {}), *map, line, job);
  if (!edges) return tl::unexpected(edges.error());
  made.edges = std::move(edges->field);
  return made;
}

}  // namespace fettle::engine
