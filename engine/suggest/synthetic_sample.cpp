#include "engine/suggest/synthetic_sample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/field/builder.h"
#include "engine/filter/catalogue.h"
#include "engine/suggest/noise_match.h"
#include "engine/suggest/noise_source.h"
#include "engine/suggest/sample_edges.h"
#include "engine/suggest/sample_zones.h"

namespace fettle::engine {

namespace {

constexpr double kFewOutliers = 1e-4;  // of the samples
constexpr double kFaint = 0.25;        // of the noise, for edges that are lower than it
// Range of the filter that makes the surface, in noises. With 1 it loses more of the steps that it is tried on later,
// with less than this it leaves too much noise.
constexpr double kSurfaceRange = 0.92;

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
  FilterSpec spec;
  spec.kind = FilterKind::kGeneralisedVariation;
  spec.range_sigma = kSurfaceRange * filterOf(spec.kind).noises * sigma;
  auto done = applyFilter(field, field, spec, job);
  if (!done) return tl::unexpected(done.error());
  return std::move(done->field);
}

// Noise of the model for all pieces; 0 between them.
std::vector<double> noiseFor(const Mosaic& pieces, const Grid& grid, const NoiseModel& noise,
                             const HeightCounts& counts, std::uint64_t seed) {
  NoiseParts parts = noise.parts;
  // Counting adds its own: the variance of a uniform distribution.
  parts.uncorrelated = std::max(parts.uncorrelated - counts.step * counts.step / 12.0, 0.0);
  const NoiseSource source(parts);
  const std::int32_t width = pieces.field.grid().width;
  std::vector<double> all(static_cast<std::size_t>(pieces.field.grid().samples()));
  for (std::size_t p = 0; p < pieces.pieces.size(); ++p) {
    const Mosaic::Piece& piece = pieces.pieces[p];
    const SampleRect& from = piece.from;
    const std::vector<double> made = source.make(from.columns, from.rows, seed * pieces.pieces.size() + p);
    for (std::int32_t r = 0; r < from.rows; ++r)
      for (std::int32_t c = 0; c < from.columns; ++c)
        all[static_cast<std::size_t>(piece.row + r) * static_cast<std::size_t>(width) +
            static_cast<std::size_t>(piece.column + c)] =
            noise.sigmaAt(grid, from.column + c, from.row + r) / noise.sigma *
            made[static_cast<std::size_t>(r) * static_cast<std::size_t>(from.columns) +
                 static_cast<std::size_t>(c)];
  }
  return all;
}

}  // namespace

Result<SyntheticSample> makeSyntheticSample(const Mosaic& pieces, const Grid& grid, const NoiseModel& noise,
                                            const HeightCounts& counts, std::uint64_t seed, JobControl& job) {
  SyntheticSample made;
  const Samples raw = samplesOf(pieces.field);
  std::vector<float> instead = outliersOf(raw, noise.sigma, made.outliers);
  // So few are tips of ribs as likely as outliers, and one of them in the scan and not in the surface is millimetres.
  if (static_cast<double>(made.outliers) < kFewOutliers * static_cast<double>(raw.z.size()))
    std::ranges::fill(instead, std::nanf(""));
  std::vector<float> clean = raw.z;
  for (std::size_t i = 0; i < clean.size(); ++i)
    if (instead[i] == instead[i]) clean[i] = instead[i];
  // Without marks: everything is smoothed.
  auto surface = smoothed(makeField(raw.grid, clean, {}), noise.sigma, job);
  if (!surface) return tl::unexpected(surface.error());
  made.surface = *std::move(surface);

  const std::vector<double> added = noiseFor(pieces, grid, noise, counts, seed);

  Samples faint = samplesOf(made.surface);
  for (std::size_t i = 0; i < faint.z.size(); ++i) faint.z[i] += static_cast<float>(kFaint * added[i]);
  auto edges = markSampleEdges(pieces.field, made.surface, makeField(faint.grid, faint.z), noise.sigma, job);
  if (!edges) return tl::unexpected(edges.error());
  made.edges = *std::move(edges);

  const std::vector<SampleZone> zones = zonesBesideMarks(made.edges);
  const std::vector<float> smooth = samplesOf(made.surface).z;
  const auto withNoise = [&](const NoiseMatch& match) {
    std::vector<float> z(raw.z);
    for (std::size_t i = 0; i < z.size(); ++i)
      if (instead[i] != instead[i])
        z[i] = static_cast<float>(
            counts.nearest(static_cast<double>(smooth[i]) + match.in(zones[i]) * added[i]));
    return makeField(raw.grid, z, raw.marks);
  };
  const auto match = matchNoise(pieces.field, withNoise({}), zones, noise.sigma, job);
  if (!match) return tl::unexpected(match.error());
  made.scan = withNoise(*match);

  std::vector<float> judged(raw.z.size(), std::nanf(""));
  for (const Mosaic::Piece& piece : pieces.pieces) {
    const SampleRect& in = piece.judged;
    made.surface.reader().readHeights(
        in.column, in.row, in.columns, in.rows,
        judged.data() + static_cast<std::ptrdiff_t>(in.row) * raw.grid.width + in.column, raw.grid.width);
  }
  made.surface = makeField(raw.grid, judged);

  return made;
}

}  // namespace fettle::engine
