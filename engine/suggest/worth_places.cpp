#include "engine/suggest/worth_places.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "engine/edges/locate.h"
#include "engine/field/piece.h"
#include "engine/field/sample_rect.h"
#include "engine/marks/edge_traces.h"
#include "engine/suggest/continued_paths.h"
#include "engine/suggest/gain_trial.h"

namespace fettle::engine {

namespace {

using Path = std::vector<glm::dvec2>;

// Weak edges are sought: each sample that stands out of the noise by two standard deviations counts.
constexpr double kEdgeScale = 2.0;  // [samples]
constexpr EdgeChoice kEveryEdge{.sensitivity = 1.0, .thickness = 0.0, .shortest = 12};
constexpr std::size_t kLeastPoints = 12;
constexpr double kShortestStroke = 16.0;
constexpr double kBeside = 6.0;        // [samples] on either side of a line, where its gain is counted
constexpr double kKnown = 4.0;         // [samples] of a line of the field: an edge there needs no other
constexpr std::ptrdiff_t kAlong = 40;  // points on either side over which gains are averaged
constexpr double kFlatShare = 0.12;    // of the noise: what the filter leaves on flats
constexpr double kLeastShare = 0.001;  // of what is left: no place gains less

// Cells of the field, side by side, and what is tried for each: it with the margin around it.
constexpr std::int32_t kCellSide = 448, kMargin = 32;

std::pair<std::int32_t, std::int32_t> cellOf(glm::dvec2 at) {
  return {static_cast<std::int32_t>(std::floor(at.y / kCellSide)),
          static_cast<std::int32_t>(std::floor(at.x / kCellSide))};
}

// Where the field has lines.
class KnownLines {
 public:
  explicit KnownLines(const EdgeLines& lines) {
    if (lines == nullptr) return;
    for (const EdgeLine& line : *lines)
      for (const EdgePoint& point : line.points)
        // Only these have an influence on the filter.
        if (point.located && point.kind == LineKind::kStep)
          points_[keyOf(point.position)].push_back(point.position);
  }
  [[nodiscard]] bool isNear(glm::dvec2 at) const {
    if (points_.empty()) return false;
    for (const double dy : {-kKnown, 0.0, kKnown})
      for (const double dx : {-kKnown, 0.0, kKnown})
        if (const auto found = points_.find(keyOf(at + glm::dvec2(dx, dy))); found != points_.end())
          for (const glm::dvec2& p : found->second)
            if (glm::distance(p, at) <= kKnown) return true;
    return false;
  }

 private:
  static std::pair<std::int64_t, std::int64_t> keyOf(glm::dvec2 at) {
    return {static_cast<std::int64_t>(std::floor(at.y / kKnown)),
            static_cast<std::int64_t>(std::floor(at.x / kKnown))};
  }
  std::map<std::pair<std::int64_t, std::int64_t>, Path> points_;
};

// The runs of points that are kept.
std::vector<Path> keptRuns(const std::vector<Path>& paths, auto&& keep) {
  std::vector<Path> runs;
  for (const Path& path : paths) {
    Path run;
    const auto end = [&] {
      if (run.size() >= kLeastPoints) runs.push_back(std::exchange(run, {}));
      run.clear();
    };
    for (const glm::dvec2& p : path)
      if (keep(p))
        run.push_back(p);
      else
        end();
    end();
  }
  return runs;
}

// Cells in the order of their rows, each with its number; those with the most edges where there are too many.
std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> chosenCells(const std::vector<Path>& paths,
                                                                         std::size_t& all) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> counts;
  for (const Path& path : paths)
    for (const glm::dvec2& p : path) ++counts[cellOf(p)];
  using Entry = std::pair<std::pair<std::int32_t, std::int32_t>, std::size_t>;
  std::vector<Entry> order(counts.begin(), counts.end());
  std::ranges::sort(order, [](const Entry& a, const Entry& b) {
    return a.second != b.second ? a.second > b.second : a.first < b.first;
  });
  all = order.size();
  if (order.size() > WorthRequest::kMostPieces) order.resize(WorthRequest::kMostPieces);
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> chosen;
  for (const Entry& entry : order) chosen.emplace(entry.first, 0);
  std::size_t number = 0;
  for (auto& cell : chosen) cell.second = number++;
  return chosen;
}

// A point of a line, and what a line is worth there by both estimates.
struct LineSpot {
  glm::dvec2 at{0.0};
  double change = 0.0, gain = 0.0;
};

// Which spot each sample of a cell belongs to: the nearest within kBeside.
class Owners {
 public:
  explicit Owners(const SampleRect& cell) : cell_(cell) {
    const std::size_t n = static_cast<std::size_t>(cell.columns) * static_cast<std::size_t>(cell.rows);
    owner_.assign(n, kNone);
    distance_.assign(n, std::numeric_limits<double>::infinity());
  }
  void add(std::size_t spot, glm::dvec2 at) {
    const auto from = [](double v, std::int32_t low) {
      return std::max(static_cast<std::int32_t>(std::ceil(v - kBeside)), low);
    };
    const auto to = [](double v, std::int32_t high) {
      return std::min(static_cast<std::int32_t>(std::floor(v + kBeside)), high);
    };
    for (std::int32_t r = from(at.y, cell_.row); r <= to(at.y, cell_.row + cell_.rows - 1); ++r)
      for (std::int32_t c = from(at.x, cell_.column); c <= to(at.x, cell_.column + cell_.columns - 1); ++c) {
        const auto i = static_cast<std::size_t>((r - cell_.row) * cell_.columns + (c - cell_.column));
        const double d = glm::distance(glm::dvec2(c, r), at);
        if (d > kBeside || d >= distance_[i]) continue;
        distance_[i] = d;
        owner_[i] = spot;
      }
  }
  // visit(column, row of the field, spot)
  void forEach(auto&& visit) const {
    std::size_t i = 0;
    for (std::int32_t r = cell_.row; r < cell_.row + cell_.rows; ++r)
      for (std::int32_t c = cell_.column; c < cell_.column + cell_.columns; ++c, ++i) visit(c, r, owner_[i]);
  }
  static constexpr auto kNone = std::numeric_limits<std::size_t>::max();

 private:
  SampleRect cell_;
  std::vector<std::size_t> owner_;
  std::vector<double> distance_;
};

SampleRect clipped(const SampleRect& rect, const Grid& grid) {
  const std::int32_t left = std::max(rect.column, 0), low = std::max(rect.row, 0);
  return {left, low, std::min(rect.column + rect.columns, grid.width) - left,
          std::min(rect.row + rect.rows, grid.height) - low};
}

// What the filter leaves, and how many samples that was counted on.
struct LeftSum {
  double squares = 0.0;
  std::int64_t samples = 0;
};

// Tries the lines on one cell and adds to its spots.
Result<LeftSum> tryCell(const Version& field, const Version& lined, const SampleRect& cell,
                        const std::vector<std::size_t>& near, std::vector<LineSpot>& spots,
                        const WorthRequest& request, const JobControl& job) {
  const SampleRect rect = clipped(
      {cell.column - kMargin, cell.row - kMargin, cell.columns + 2 * kMargin, cell.rows + 2 * kMargin},
      field.grid());
  const auto cut = [&](const Version& version) {
    return pieceOf(version, rect.column, rect.row, rect.columns, rect.rows);
  };
  const Version piece = cut(field);
  const auto trial =
      tryLines(piece, cut(lined).lines(), request.noise, rect.column, rect.row, request.threads, job);
  if (!trial) return tl::unexpected(trial.error());
  Owners owners(cell);
  for (const std::size_t spot : near) owners.add(spot, spots[spot].at);
  LeftSum left;
  const FieldReader reader = piece.reader();
  owners.forEach([&](std::int32_t c, std::int32_t r, std::size_t spot) {
    const std::int32_t x = c - rect.column, y = r - rect.row;
    const float height = reader.heightAt(x, y);
    if (height != height) return;
    const auto i = static_cast<std::size_t>(y * rect.columns + x);
    left.squares += trial->left[i];
    ++left.samples;
    if (spot == Owners::kNone) return;
    spots[spot].change += trial->change[i];
    spots[spot].gain += trial->gain[i];
  });
  return left;
}

// Each estimate fails in its own way: where a line moves an edge from one place to another as good, only the change is
// large; where the filter's surface is wrong to begin with, only the synthetic gain. The smaller one counts.
std::vector<double> gainsOf(std::span<const LineSpot> spots) {
  const auto n = std::ssize(spots);
  std::vector<double> gains(spots.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t first = std::max<std::ptrdiff_t>(i - kAlong, 0), last = std::min(i + kAlong, n - 1);
    double change = 0.0, gain = 0.0;
    for (std::ptrdiff_t k = first; k <= last; ++k) {
      change += spots[static_cast<std::size_t>(k)].change;
      gain += spots[static_cast<std::size_t>(k)].gain;
    }
    gains[static_cast<std::size_t>(i)] = std::min(change, gain) / static_cast<double>(last - first + 1);
  }
  return gains;
}

// The lines of the field and others.
EdgeLines withOthers(const EdgeLines& known, std::span<const EdgeLine> others) {
  auto all = std::make_shared<std::vector<EdgeLine>>();
  if (known != nullptr) *all = *known;
  std::int64_t id = 0;
  for (const EdgeLine& line : *all) id = std::max(id, line.id + 1);
  for (const EdgeLine& line : others) {
    all->push_back(line);
    all->back().id = id++;
  }
  return all;
}

Result<std::vector<EdgeLine>> candidatesOf(const Version& field, double noise, std::size_t& left_out,
                                           JobControl& job) {
  const auto map = findEdges(field, kEdgeScale, job);
  if (!map) return tl::unexpected(map.error());
  auto traces = traceEdges(field.grid(), *map, kEveryEdge, job);
  if (!traces) return tl::unexpected(traces.error());
  std::vector<Path> paths;
  for (EdgeTrace& trace : *traces) {
    if (trace.closed) trace.points.push_back(trace.points.front());
    paths.push_back(std::move(trace.points));
  }
  const KnownLines known(field.lines());
  paths = keptRuns(paths, [&](glm::dvec2 p) { return !known.isNear(p); });
  std::size_t all = 0;
  const auto cells = chosenCells(paths, all);
  left_out = all - cells.size();
  paths = continuedPaths(keptRuns(paths, [&](glm::dvec2 p) { return cells.contains(cellOf(p)); }));
  std::vector<EdgeStroke> strokes;
  strokes.reserve(paths.size());
  for (Path& path : paths)
    strokes.push_back({static_cast<std::int64_t>(strokes.size()), std::move(path), false});
  return locateEdgeLines(field.reader(), noise, strokes, {}, job);
}

}  // namespace

double WorthPlaces::rmseAfter(std::size_t count) const noexcept {
  double sum = left;
  for (std::size_t i = 0; i < std::min(count, places.size()); ++i) sum -= places[i].gain;
  return samples > 0.0 ? std::sqrt(std::max(sum, 0.0) / samples) : 0.0;
}

Result<WorthPlaces> findWorthPlaces(const Version& field, const WorthRequest& request, JobControl& job) try {
  if (!(std::isfinite(request.noise) && request.noise > 0.0))
    return inputError(fmt::format("a noise of {} cannot be used", request.noise), "noise",
                      "give more than 0");
  WorthPlaces result;
  const auto lines = candidatesOf(field, request.noise, result.left_out, job);
  if (!lines) return tl::unexpected(lines.error());

  std::vector<LineSpot> spots;
  std::vector<std::size_t> begins;  // of each line in spots, and the end
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::size_t>> cells;
  const Grid& grid = field.grid();
  for (const EdgeLine& line : *lines) {
    begins.push_back(spots.size());
    for (const EdgePoint& point : line.points) {
      const glm::dvec2 at = point.position;
      for (const double dy : {-kBeside, kBeside})
        for (const double dx : {-kBeside, kBeside}) {
          const glm::dvec2 near = at + glm::dvec2(dx, dy);
          if (near.x < 0.0 || near.y < 0.0 || near.x >= grid.width || near.y >= grid.height) continue;
          std::vector<std::size_t>& cell = cells[cellOf(near)];
          if (cell.empty() || cell.back() != spots.size()) cell.push_back(spots.size());
        }
      spots.push_back({at});
    }
  }
  begins.push_back(spots.size());
  // Lines near their borders and over gaps lead into further ones: those with the most of them are tried.
  while (cells.size() > WorthRequest::kMostPieces) {
    cells.erase(std::ranges::min_element(cells, {}, [](const auto& cell) { return cell.second.size(); }));
    ++result.left_out;
  }

  const Version lined = field.withLines(withOthers(field.lines(), *lines));
  job.begin("trying lines", cells.size());
  LeftSum left;
  for (const auto& [cell, near] : cells) {
    const SampleRect rect =
        clipped({cell.second * kCellSide, cell.first * kCellSide, kCellSide, kCellSide}, grid);
    const auto found = tryCell(field, lined, rect, near, spots, request, job);
    if (!found) return tl::unexpected(found.error());
    left.squares += found->squares;
    left.samples += found->samples;
    job.advance();
  }

  const std::int64_t samples = grid.samples() - summarize(field).no_data;
  result.samples = static_cast<double>(samples);
  const double flat = kFlatShare * request.noise;
  result.left = left.squares + flat * flat * static_cast<double>(samples - left.samples);
  for (std::size_t k = 0; k + 1 < begins.size(); ++k) {
    const std::span<const LineSpot> own(spots.data() + begins[k], begins[k + 1] - begins[k]);
    GainPath path;
    for (const LineSpot& spot : own) path.points.push_back(spot.at);
    path.gains = gainsOf(own);
    for (const WorthStretch& stretch : bestStretches(path, request.pace, kShortestStroke)) {
      if (stretch.gain < kLeastShare * result.left) continue;
      const auto at = [&](std::size_t i) { return path.points.begin() + static_cast<std::ptrdiff_t>(i); };
      result.places.push_back(
          {Path(at(stretch.first), at(stretch.last + 1)), stretch.length, stretch.gain, stretch.seconds});
    }
  }
  std::ranges::stable_sort(result.places, [](const WorthPlace& a, const WorthPlace& b) {
    return a.gain * b.seconds > b.gain * a.seconds;
  });
  if (result.places.size() > request.most) result.places.resize(request.most);
  return result;
} catch (const std::bad_alloc&) {
  return failure("memory for the places could not be allocated", "", "close other programs");
}

}  // namespace fettle::engine
