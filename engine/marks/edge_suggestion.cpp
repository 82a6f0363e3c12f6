#include "engine/marks/edge_suggestion.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/field/sample_rect.h"
#include "engine/marks/chosen_lines.h"
#include "engine/marks/tile_bits.h"

namespace fettle::engine {

namespace {

// Blocks that the noise is measured on, spread over the field.
constexpr std::int64_t kNoiseBlocks = 64;
// The strength of an edge is at least this share of the strongest half per cent: in a scan without noise
// everything would be infinitely strong.
constexpr double kFaintest = 1.0 / 2000.0;
// A crease's noise is at least this share of a step's over sigma: see measureNoise().
constexpr double kLeastCrease = 0.8;
// Standard deviation of normal noise over the median of its absolute values.
constexpr double kDeviations = 1.4826;
// Rounding of the derivatives, against the heights' range: float has 24 bits, sums of some hundred terms lose
// a few of them.
constexpr double kRounding = 1.0 / (1 << 19);

tl::unexpected<Error> noMemoryForEdges() {
  return failure("memory for finding edges could not be allocated", "", "close other programs");
}

struct Blocks {
  std::int32_t side, across, up, width, height;

  Blocks(const Grid& grid, double sigma)
      : side(sigma > 3.0 ? 512 : 256),
        across((grid.width + side - 1) / side),
        up((grid.height + side - 1) / side),
        width(grid.width),
        height(grid.height) {}
  [[nodiscard]] std::int64_t count() const noexcept { return std::int64_t{across} * up; }
  // First sample and extent of block i.
  [[nodiscard]] SampleRect rect(std::int64_t i) const noexcept {
    const auto c = static_cast<std::int32_t>(i % across) * side;
    const auto r = static_cast<std::int32_t>(i / across) * side;
    return {c, r, std::min(side, width - c), std::min(side, height - r)};
  }
};

// The q-th smallest share of the values; 0 of none.
double quantile(std::vector<float>& values, double q) {
  if (values.empty()) return 0.0;
  const auto n = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + n, values.end());
  return values[static_cast<std::size_t>(n)];
}

struct Noise {
  double step = 0.0;
  double crease = 0.0;
};

Noise measureNoise(const FieldReader& reader, double sigma, const Blocks& blocks, JobControl& job) {
  struct Sampled {
    std::vector<float> step_x, step_y, bend_x, bend_y, step, crease, height;
  };
  const std::int64_t n = std::min(blocks.count(), kNoiseBlocks);
  std::vector<Sampled> sampled(static_cast<std::size_t>(n));
  tbb::enumerable_thread_specific<EdgeResponse> responses(sigma, EdgeResponse::Scatter::kMeasure);
  tbb::parallel_for(std::int64_t{0}, n, [&](std::int64_t i) {
    if (job.cancelled()) return;
    const SampleRect rect = blocks.rect(i * blocks.count() / n);
    EdgeResponse& response = responses.local();
    if (!response.run(reader, rect.column, rect.row, rect.columns, rect.rows, job)) return;
    Sampled& out = sampled[static_cast<std::size_t>(i)];
    // Neighbours are correlated: every third sample in each direction suffices.
    for (int r = 0; r < rect.rows; r += 3)
      for (int c = 0; c < rect.columns; c += 3) {
        const auto o = static_cast<std::size_t>(r * rect.columns + c);
        if (response.whole[o] == 0) continue;
        out.step_x.push_back(std::fabs(response.step_in_x[o]));
        out.step_y.push_back(std::fabs(response.step_in_y[o]));
        out.bend_x.push_back(std::fabs(response.bend_in_x[o]));
        out.bend_y.push_back(std::fabs(response.bend_in_y[o]));
        out.step.push_back(response.step[o]);
        out.crease.push_back(response.crease[o]);
        out.height.push_back(reader.heightAt(rect.column + c, rect.row + r));
      }
  });
  const auto joined = [&](std::vector<float> Sampled::*values) {
    std::vector<float> all;
    for (const Sampled& part : sampled) all.insert(all.end(), (part.*values).begin(), (part.*values).end());
    return all;
  };
  const auto medianOf = [&](std::vector<float> Sampled::*x, std::vector<float> Sampled::*y) {
    std::vector<float> a = joined(x), b = joined(y);
    return kDeviations * std::max(quantile(a, 0.5), quantile(b, 0.5));
  };
  std::vector<float> height = joined(&Sampled::height), step = joined(&Sampled::step),
                     crease = joined(&Sampled::crease);
  const double range = quantile(height, 0.99) - quantile(height, 0.01);
  const double level = std::max(std::abs(quantile(height, 0.5)), range);
  const double counts = reader.grid().height_per_count;
  const double exact = std::max(level * kRounding, 0.3 * counts);  // rounding to counts: 0.29 of one
  Noise noise;
  noise.step = std::max({medianOf(&Sampled::step_x, &Sampled::step_y), kFaintest * quantile(step, 0.995),
                         0.25 * exact / (sigma * sigma)});
  noise.crease = std::max({medianOf(&Sampled::bend_x, &Sampled::bend_y), kFaintest * quantile(crease, 0.995),
                           0.25 * exact / (sigma * sigma * sigma)});
  // White noise gives the first response sigma times that of the second. Where the surface is curved
  // everywhere, only one of them measures the noise.
  noise.step = std::max(noise.step, 0.5 * sigma * noise.crease);
  // The foot of a tall step has 0.61 / sigma of the curvature of its slope, and the step itself answers with 0.8 of that
  // slope where it lies between two samples. With a step's noise at most 1.25 sigma of a crease's (as of white noise) the
  // step is the stronger one, and thinning leaves one line instead of one at each foot.
  noise.crease = std::max(noise.crease, kLeastCrease * noise.step / sigma);
  return noise;
}

// Keeps, of a block with a rim around it, the samples that are stronger than all within `reach` across the
// edge they lie on.
class Thinning {
 public:
  Thinning(const EdgeResponse& response, const Noise& noise, const SampleRect& rect, int rim)
      : response_(response), noise_(noise), rect_(rect), rim_(rim), wide_(rect.columns + 2 * rim) {
    const std::size_t n = static_cast<std::size_t>(wide_) * static_cast<std::size_t>(rect.rows + 2 * rim);
    strength_.resize(n);
    for (std::size_t i = 0; i < n; ++i) strength_[i] = std::max(stepStrength(i), creaseStrength(i));
  }

  void run(std::vector<EdgeCandidate>& out) const {
    for (int r = 0; r < rect_.rows; ++r)
      for (int c = 0; c < rect_.columns; ++c) {
        const std::size_t i = at(c + rim_, r + rim_);
        const float s = strength_[i];
        if (s >= EdgeMap::kLeastStrength && isPeak(c + rim_, r + rim_, s))
          out.push_back({rect_.column + c, rect_.row + r, s});
      }
  }

 private:
  [[nodiscard]] std::size_t at(int c, int r) const noexcept {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(wide_) + static_cast<std::size_t>(c);
  }
  [[nodiscard]] float stepStrength(std::size_t i) const noexcept {
    return noise_.step > 0.0 ? static_cast<float>(response_.step[i] / noise_.step) : 0.0F;
  }
  [[nodiscard]] float creaseStrength(std::size_t i) const noexcept {
    return noise_.crease > 0.0 ? static_cast<float>(response_.crease[i] / noise_.crease) : 0.0F;
  }
  [[nodiscard]] bool isPeak(int c, int r, float s) const noexcept {
    const std::size_t i = at(c, r);
    const bool step = stepStrength(i) >= creaseStrength(i);
    float nx = step ? response_.step_x[i] : response_.crease_x[i];
    float ny = step ? response_.step_y[i] : response_.crease_y[i];
    // Of two equals one is kept: the first along a direction that is the same for both.
    if (nx < 0.0F || (nx == 0.0F && ny < 0.0F)) nx = -nx, ny = -ny;
    for (int d = 1; d <= rim_; ++d) {
      const int dx = static_cast<int>(std::lround(nx * static_cast<float>(d)));
      const int dy = static_cast<int>(std::lround(ny * static_cast<float>(d)));
      if (strength_[at(c + dx, r + dy)] > s || strength_[at(c - dx, r - dy)] >= s) return false;
    }
    return true;
  }

  const EdgeResponse& response_;
  const Noise& noise_;
  const SampleRect rect_;
  const int rim_;
  const int wide_;
  std::vector<float> strength_;
};

// Half widths of the rows of a disc, lowest row first.
std::vector<std::int32_t> disc(double radius) {
  const auto reach = static_cast<std::int32_t>(std::floor(radius));
  std::vector<std::int32_t> half;
  for (std::int32_t dr = -reach; dr <= reach; ++dr)
    half.push_back(static_cast<std::int32_t>(std::floor(std::sqrt(radius * radius - double(dr) * dr))));
  return half;
}

}  // namespace

double EdgeChoice::strength() const noexcept {
  return 32.0 * std::exp2(-4.0 * sensitivity);
}

Result<EdgeMap> findEdges(const Version& field, double sigma, JobControl& job) try {
  if (!(sigma >= EdgeResponse::kSmallestSigma && sigma <= EdgeResponse::kLargestSigma))
    return inputError(
        fmt::format("edges cannot be found at a scale of {} samples", sigma), "scale",
        fmt::format("give {} to {}", EdgeResponse::kSmallestSigma, EdgeResponse::kLargestSigma));
  const FieldReader reader = field.reader();
  const Blocks blocks(field.grid(), sigma);
  job.begin("finding edges", static_cast<std::uint64_t>(field.grid().samples()));
  const Noise noise = measureNoise(reader, sigma, blocks, job);
  if (job.cancelled()) return cancelled();

  // A step's own curvature maxima lie one sigma from it and must not become separate lines.
  const int rim = std::max(1, static_cast<int>(std::lround(1.5 * sigma)));
  std::vector<std::vector<EdgeCandidate>> found(static_cast<std::size_t>(blocks.count()));
  tbb::enumerable_thread_specific<EdgeResponse> responses(sigma);
  tbb::parallel_for(
      tbb::blocked_range<std::int64_t>(0, blocks.count(), 1),
      [&](const auto& range) {
        for (std::int64_t i = range.begin(); i != range.end() && !job.cancelled(); ++i) {
          const SampleRect rect = blocks.rect(i);
          EdgeResponse& response = responses.local();
          if (!response.run(reader, rect.column - rim, rect.row - rim, rect.columns + 2 * rim,
                            rect.rows + 2 * rim, job))
            return;
          Thinning(response, noise, rect, rim).run(found[static_cast<std::size_t>(i)]);
          job.advance(static_cast<std::uint64_t>(rect.columns) * static_cast<std::uint64_t>(rect.rows));
        }
      },
      tbb::simple_partitioner());
  if (job.cancelled()) return cancelled();
  EdgeMap map;
  map.sigma = sigma;
  map.step_noise = noise.step;
  map.crease_noise = noise.crease;
  std::size_t count = 0;
  for (const auto& part : found) count += part.size();
  map.candidates.reserve(count);
  for (const auto& part : found) map.candidates.insert(map.candidates.end(), part.begin(), part.end());
  return map;
} catch (const std::bad_alloc&) {
  return noMemoryForEdges();
}

Result<EdgeSuggestion> suggestMarks(const Version& field, const EdgeMap& map, const EdgeChoice& choice,
                                    JobControl& job) try {
  if (!(choice.thickness >= 0.0 && choice.thickness <= 64.0))
    return inputError(fmt::format("a thickness of {} samples cannot be used", choice.thickness), "thickness",
                      "give 0 to 64");
  const Grid& grid = field.grid();
  const auto lines = chosenLines(grid, map, choice, job);
  if (!lines) return tl::unexpected(lines.error());
  EdgeSuggestion suggestion;
  TileBits chosen(grid);
  const std::vector<std::int32_t> half = disc(choice.thickness);
  const auto reach = static_cast<std::int32_t>(half.size() / 2);
  for (const EdgePiece& line : *lines) {
    if (job.cancelled()) return cancelled();
    ++suggestion.lines;
    suggestion.samples += static_cast<std::int64_t>(line.size());
    for (const EdgeSpot& s : line)
      for (std::int32_t dr = -reach; dr <= reach; ++dr) {
        const std::int32_t h = half[static_cast<std::size_t>(dr + reach)];
        chosen.setSpan(s.column - h, s.column + h + 1, s.row + dr);
      }
  }
  auto marked = changeMarks(
      field, allTiles(grid),
      [&](std::int32_t tc, std::int32_t tr, const Tile& tile, MarkRows& rows) {
        applyChange(tile, chosen.tile(tc, tr), MarkChange::kMark, rows);
      },
      job);
  if (!marked) return tl::unexpected(marked.error());
  suggestion.field = std::move(*marked);
  return suggestion;
} catch (const std::bad_alloc&) {
  return noMemoryForEdges();
}

}  // namespace fettle::engine
