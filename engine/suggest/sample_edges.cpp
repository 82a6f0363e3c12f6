#include "engine/suggest/sample_edges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/field/builder.h"
#include "engine/marks/edge_suggestion.h"

namespace fettle::engine {

namespace {

constexpr double kCoarse = 2.0 * EdgeMap::kUsualSigma;
constexpr double kSensitivity = 0.6;
constexpr std::int32_t kApart = 4,
                       kFaintApart = 2;  // lines of a later search from those of earlier ones [samples]
constexpr double kJump = 6.0, kFaintJump = 2.5;  // [sigma]

struct EdgeSamples {
  Grid grid;
  std::vector<std::uint8_t> marked;

  [[nodiscard]] std::size_t at(std::int32_t c, std::int32_t r) const noexcept {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(c);
  }
  [[nodiscard]] bool near(std::int32_t column, std::int32_t row, std::int32_t reach) const noexcept {
    for (std::int32_t r = std::max(row - reach, 0); r <= std::min(row + reach, grid.height - 1); ++r)
      for (std::int32_t c = std::max(column - reach, 0); c <= std::min(column + reach, grid.width - 1); ++c)
        if (marked[at(c, r)] != 0) return true;
    return false;
  }
};

Result<EdgeSamples> found(const Version& unmarked, double sigma, double sensitivity, JobControl& job) {
  const auto map = findEdges(unmarked, sigma, job);
  if (!map) return tl::unexpected(map.error());
  EdgeChoice line;
  line.sensitivity = sensitivity;
  line.thickness = 0.0;
  const auto edges = suggestMarks(unmarked, *map, line, job);
  if (!edges) return tl::unexpected(edges.error());
  EdgeSamples samples{unmarked.grid(), {}};
  samples.marked.resize(static_cast<std::size_t>(samples.grid.samples()));
  edges->field.reader().readMarks(0, 0, samples.grid.width, samples.grid.height, samples.marked.data(),
                                  samples.grid.width);
  return samples;
}

// Whether heights jump between b and c, with a before and d beyond them: NaN where there is none.
bool jumps(float a, float b, float c, float d, float least) noexcept {
  const float rise = c - b;
  return std::abs(rise) > least && !(std::abs(rise - (b - a)) <= least) &&
         !(std::abs(rise - (d - c)) <= least);
}

void markJumps(const std::vector<float>& z, float least, EdgeSamples& edges) {
  const std::int32_t width = edges.grid.width, height = edges.grid.height;
  const auto heightAt = [&](std::int32_t c, std::int32_t r) {
    return c < 0 || r < 0 || c >= width || r >= height ? std::nanf("") : z[edges.at(c, r)];
  };
  for (std::int32_t r = 0; r < height; ++r)
    for (std::int32_t c = 0; c < width; ++c) {
      const float here = z[edges.at(c, r)];
      if (jumps(heightAt(c - 1, r), here, heightAt(c + 1, r), heightAt(c + 2, r), least) ||
          jumps(heightAt(c, r - 1), here, heightAt(c, r + 1), heightAt(c, r + 2), least))
        edges.marked[edges.at(c, r)] = 1;
    }
}

std::vector<float> allHeights(const Version& field) {
  const Grid& grid = field.grid();
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  field.reader().readHeights(0, 0, grid.width, grid.height, z.data(), grid.width);
  return z;
}

}  // namespace

Result<Version> markSampleEdges(const Version& scan, const Version& surface, const Version& faint,
                                double sigma, JobControl& job) {
  const Version unmarked = makeField(scan.grid(), allHeights(scan));
  auto edges = found(unmarked, EdgeMap::kUsualSigma, kSensitivity, job);
  if (!edges) return tl::unexpected(edges.error());
  const std::vector<float> heights = allHeights(surface);
  markJumps(heights, static_cast<float>(kJump * sigma), *edges);
  EdgeSamples steps{surface.grid(), std::vector<std::uint8_t>(heights.size())};
  markJumps(heights, static_cast<float>(kFaintJump * sigma), steps);
  auto low = found(faint, EdgeMap::kUsualSigma, EdgeChoice{}.sensitivity, job);
  if (!low) return tl::unexpected(low.error());
  // Marks of `more` that are farther than `apart` from those there are.
  const auto add = [&edges](const EdgeSamples& more, std::int32_t apart, const EdgeSamples* beside) {
    const EdgeSamples before = *edges;
    for (std::int32_t r = 0; r < before.grid.height; ++r)
      for (std::int32_t c = 0; c < before.grid.width; ++c)
        if (more.marked[more.at(c, r)] != 0 && !before.near(c, r, apart) &&
            (beside == nullptr || beside->near(c, r, 1)))
          edges->marked[before.at(c, r)] = 1;
  };
  add(*low, kFaintApart, &steps);
  const auto coarse = found(unmarked, kCoarse, kSensitivity, job);
  if (!coarse) return tl::unexpected(coarse.error());
  add(*coarse, kApart, nullptr);
  return makeField(scan.grid(), heights, edges->marked);
}

}  // namespace fettle::engine
