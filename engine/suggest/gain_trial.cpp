#include "engine/suggest/gain_trial.h"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/field/builder.h"
#include "engine/filter/filter.h"
#include "engine/scanner/counter_random.h"

namespace fettle::engine {

namespace {

constexpr std::uint64_t kTrialSeed = 1979, kTrialStream = 1;
constexpr float kOutlier = 6.0F;  // [sigma]

std::vector<float> heightsOf(const Version& field) {
  const FieldReader reader = field.reader();
  std::vector<float> heights(static_cast<std::size_t>(field.grid().samples()));
  reader.readHeights(0, 0, reader.width(), reader.height(), heights.data(), reader.width());
  return heights;
}

Result<Version> filtered(const Version& field, double sigma, int threads, const JobControl& job) {
  FilterSpec spec;
  spec.kind = FilterKind::kGeneralisedVariation;
  spec.range_sigma = sigma;
  spec.threads = threads;
  JobControl quiet = JobControl::partOf(job);
  auto result = applyFilter(field, field, spec, quiet);
  if (!result) return tl::unexpected(result.error());
  return std::move(result->field);
}

}  // namespace

Result<GainTrial> tryLines(const Version& piece, const EdgeLines& lines, double sigma, std::int32_t column,
                           std::int32_t row, int threads, const JobControl& job) {
  const auto alone = filtered(piece, sigma, threads, job);
  if (!alone) return tl::unexpected(alone.error());
  const auto surface = filtered(piece.withLines(lines), sigma, threads, job);
  if (!surface) return tl::unexpected(surface.error());
  const std::vector<float> heights = heightsOf(piece), truth = heightsOf(*surface), plain = heightsOf(*alone);

  const CounterRandom random(kTrialSeed, kTrialStream);
  const auto s = static_cast<float>(sigma);
  const Grid& grid = piece.grid();
  std::vector<float> noisy(heights.size());
  std::size_t i = 0;
  for (std::int32_t r = 0; r < grid.height; ++r)
    for (std::int32_t c = 0; c < grid.width; ++c, ++i)
      noisy[i] = std::abs(heights[i] - truth[i]) > kOutlier * s
                     ? heights[i]
                     : truth[i] + s * static_cast<float>(random.normal(column + c, row + r));
  std::vector<std::uint8_t> marks(heights.size());
  piece.reader().readMarks(0, 0, grid.width, grid.height, marks.data(), grid.width);
  const Version scan = makeField(grid, noisy, marks);
  const auto without = filtered(scan.withLines(piece.lines()), sigma, threads, job);
  if (!without) return tl::unexpected(without.error());
  const auto with = filtered(scan.withLines(lines), sigma, threads, job);
  if (!with) return tl::unexpected(with.error());
  const std::vector<float> bare = heightsOf(*without), lined = heightsOf(*with);
  GainTrial trial;
  trial.change.resize(heights.size());
  trial.gain.resize(heights.size());
  trial.left.resize(heights.size());
  for (i = 0; i < heights.size(); ++i) {
    const double a = static_cast<double>(bare[i]) - static_cast<double>(truth[i]);
    const double b = static_cast<double>(lined[i]) - static_cast<double>(truth[i]);
    const double d = static_cast<double>(plain[i]) - static_cast<double>(truth[i]);
    if (a != a || b != b || d != d) continue;
    trial.change[i] = d * d;
    trial.left[i] = a * a;
    trial.gain[i] = a * a - b * b;
  }
  return trial;
}

}  // namespace fettle::engine
