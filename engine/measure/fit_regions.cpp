#include "engine/measure/fit_regions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "engine/field/tile.h"

namespace fettle::engine {

namespace {

// Columns of a row that a line's margin covers.
struct Covered {
  std::int32_t row = 0, from = 0, to = 0;  // to: behind the last
};

// The samples within `margin` of a segment, row by row: of a row these are one stretch, since the set is convex.
void addSegment(const glm::dvec2& a, const glm::dvec2& b, double margin, const Grid& grid,
                std::vector<Covered>& covered) {
  const double low = std::min(a.y, b.y) - margin, high = std::max(a.y, b.y) + margin;
  if (!(high >= 0.0 && low <= grid.height - 1.0)) return;
  const auto first = static_cast<std::int32_t>(std::ceil(std::max(low, 0.0)));
  const auto last = static_cast<std::int32_t>(std::floor(std::min(high, grid.height - 1.0)));
  const glm::dvec2 along = b - a;
  const double length = std::hypot(along.x, along.y);
  for (std::int32_t row = first; row <= last; ++row) {
    double from = 1e300, to = -1e300;
    const auto take = [&](double x) {
      from = std::min(from, x);
      to = std::max(to, x);
    };
    for (const glm::dvec2& end : {a, b})
      if (const double across = margin * margin - (row - end.y) * (row - end.y); across >= 0.0) {
        take(end.x - std::sqrt(across));
        take(end.x + std::sqrt(across));
      }
    // The two straight borders, beside the segment; along a row they lie where its ends reach.
    if (along.y != 0.0)
      for (const double side : {-margin, margin}) {
        const glm::dvec2 start = a + side / length * glm::dvec2(-along.y, along.x);
        if (const double share = (row - start.y) / along.y; share >= 0.0 && share <= 1.0)
          take(start.x + share * along.x);
      }
    if (!(to >= 0.0 && from <= grid.width - 1.0)) continue;
    const auto begin = static_cast<std::int32_t>(std::ceil(std::max(from, 0.0)));
    const auto end = static_cast<std::int32_t>(std::floor(std::min(to, grid.width - 1.0))) + 1;
    if (end > begin) covered.push_back({row, begin, end});
  }
}

std::vector<Covered> coveredBy(std::span<const EdgeLine> lines, double margin, const Grid& grid) {
  std::vector<Covered> covered;
  for (const EdgeLine& line : lines) {
    const std::size_t n = line.points.size();
    if (n == 1) addSegment(line.points[0].position, line.points[0].position, margin, grid, covered);
    for (std::size_t i = 0; i + (line.closed ? 0 : 1) < n; ++i)
      addSegment(line.points[i].position, line.points[(i + 1) % n].position, margin, grid, covered);
  }
  std::ranges::sort(covered, {}, [](const Covered& c) { return std::pair(c.row, c.from); });
  return covered;
}

// Calls take(run) for each run of samples of a region, without what is covered, by row, then column.
template <class Take>
Status forEachRun(const Version& field, Region region, std::span<const Covered> covered, JobControl& job,
                  Take&& take) {
  const FieldReader reader = field.reader();
  const std::int32_t width = reader.width(), height = reader.height();
  std::vector<float> row(static_cast<std::size_t>(width));
  job.begin("finding regions", static_cast<std::uint64_t>(height));
  std::size_t next = 0;
  for (std::int32_t r = 0; r < height; ++r) {
    if (job.cancelled()) return cancelled();
    for (std::int32_t c = 0; c < width; c += kTileSide)
      readRegion(reader, region, {c, r, std::min(kTileSide, width - c), 1}, row.data() + c, kTileSide);
    for (; next < covered.size() && covered[next].row == r; ++next)
      std::fill(row.begin() + covered[next].from, row.begin() + covered[next].to, std::nanf(""));
    for (std::int32_t c = 0; c < width;) {
      std::int32_t end = c;
      while (end < width && !std::isnan(row[static_cast<std::size_t>(end)])) ++end;
      if (end > c) take(SampleRun{r, c, end - c});
      c = end + 1;
    }
    job.advance();
  }
  return {};
}

std::size_t rootOf(std::vector<std::size_t>& parent, std::size_t i) noexcept {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

}  // namespace

Result<std::vector<FitRegion>> regionsBetween(const Version& field, std::span<const EdgeLine> lines,
                                              const FitRegionOptions& options, JobControl& job) {
  const std::vector<Covered> covered = coveredBy(lines, std::max(1.0, options.margin), field.grid());
  std::vector<SampleRun> runs;
  if (auto status =
          forEachRun(field, options.region, covered, job, [&](const SampleRun& run) { runs.push_back(run); });
      !status)
    return tl::unexpected(status.error());
  // Runs that touch runs of the row before are of one region: the earlier one becomes the root.
  std::vector<std::size_t> parent(runs.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  for (std::size_t i = 0, before = 0; i < runs.size(); ++i) {
    const SampleRun& run = runs[i];
    while (runs[before].row < run.row - 1 ||
           (runs[before].row == run.row - 1 && runs[before].column + runs[before].columns <= run.column))
      ++before;
    for (std::size_t j = before;
         j < i && runs[j].row == run.row - 1 && runs[j].column < run.column + run.columns; ++j) {
      const std::size_t a = rootOf(parent, i), b = rootOf(parent, j);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<std::int64_t> samples(runs.size(), 0);
  for (std::size_t i = 0; i < runs.size(); ++i) samples[rootOf(parent, i)] += runs[i].columns;
  std::vector<std::size_t> roots;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (samples[i] >= std::max<std::int64_t>(1, options.least)) roots.push_back(i);
  std::ranges::stable_sort(roots, std::greater<>(), [&](std::size_t i) { return samples[i]; });
  std::vector<FitRegion> regions(roots.size());
  std::vector<std::size_t> place(runs.size(), roots.size());
  for (std::size_t k = 0; k < roots.size(); ++k) {
    place[roots[k]] = k;
    regions[k].samples = samples[roots[k]];
  }
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (const std::size_t k = place[rootOf(parent, i)]; k < regions.size())
      regions[k].runs.push_back(runs[i]);
  return regions;
}

Result<FitRegion> wholeRegion(const Version& field, Region region, JobControl& job) {
  FitRegion whole;
  if (auto status = forEachRun(field, region, {}, job,
                               [&](const SampleRun& run) {
                                 whole.runs.push_back(run);
                                 whole.samples += run.columns;
                               });
      !status)
    return tl::unexpected(status.error());
  return whole;
}

int regionAt(std::span<const FitRegion> regions, const glm::dvec2& place) noexcept {
  const auto row = std::lround(place.y), column = std::lround(place.x);
  for (std::size_t k = 0; k < regions.size(); ++k) {
    const auto run =
        std::ranges::upper_bound(regions[k].runs, std::pair<long, long>(row, column), {},
                                 [](const SampleRun& r) { return std::pair<long, long>(r.row, r.column); });
    if (run == regions[k].runs.begin()) continue;
    const SampleRun& found = *std::prev(run);
    if (found.row == row && column < found.column + found.columns) return static_cast<int>(k);
  }
  return -1;
}

}  // namespace fettle::engine
