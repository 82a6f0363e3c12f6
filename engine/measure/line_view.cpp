#include "engine/measure/line_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <new>
#include <random>
#include <utility>
#include <vector>

#include "engine/field/means.h"
#include "engine/measure/levelled_lines.h"
#include "engine/measure/lowered.h"

namespace fettle::engine {

namespace {

constexpr std::int64_t kSampled = 1 << 22;  // samples that offsets come from
// Of the field in view, as its inverse, and of its samples: from then on the picture is of means.
constexpr std::int64_t kMuch = 4, kLarge = 1 << 23;
constexpr double kCells = 1 << 20;

// One place at random in each of stretches of this length.
std::vector<std::int32_t> placesIn(std::int32_t length, std::int32_t stretch) {
  std::vector<std::int32_t> places;
  std::mt19937 random(1);  // its numbers are the standard's: the same on every machine
  for (std::int32_t first = 0; first < length; first += stretch) {
    const auto wide = static_cast<std::uint32_t>(std::min(stretch, length - first));
    places.push_back(first + static_cast<std::int32_t>(random() % wide));
  }
  return places;
}

// Heights that differ by so much, over all lines. The mean square of a Legendre polynomial of degree k is 1 / (2 k + 1).
double rmsBetween(const LineOffsets& a, const LineOffsets& b) noexcept {
  const std::size_t terms = static_cast<std::size_t>(a.degree) + 1;
  double squares = 0.0;
  for (std::size_t i = 0; i < a.coefficients.size(); ++i) {
    const double d = a.coefficients[i] - b.coefficients[i];
    squares += d * d / static_cast<double>(2 * (i % terms) + 1);
  }
  return std::sqrt(squares / a.lines);
}

// What is taken from means: of the lines of a cell the mean of those whose samples count (meansOf).
Result<Version> levelledMeans(const Version& field, const LineOffsets& offsets, std::int32_t step,
                              JobControl& job) {
  const Grid& grid = field.grid();
  const Version means = meansOf(field, {0, 0, grid.width, grid.height}, step);
  if (job.cancelled()) return cancelled();
  const bool rows = offsets.axis == ScanAxis::kX;
  const std::size_t terms = static_cast<std::size_t>(offsets.degree) + 1;
  LineOffsets of_cells = offsets;
  of_cells.lines = rows ? means.grid().height : means.grid().width;
  of_cells.coefficients.assign(static_cast<std::size_t>(of_cells.lines) * terms, 0.0);
  const std::int32_t apart = rows ? rowsApartInMean(step) : 1;
  for (std::int32_t l = 0; l < of_cells.lines; ++l) {
    std::int32_t count = 0;
    double* sums = of_cells.coefficients.data() + static_cast<std::size_t>(l) * terms;
    for (std::int32_t k = l * step; k < std::min((l + 1) * step, offsets.lines); k += apart, ++count)
      for (std::size_t t = 0; t < terms; ++t)
        sums[t] += offsets.coefficients[static_cast<std::size_t>(k) * terms + t];
    for (std::size_t t = 0; t < terms; ++t) sums[t] /= count;
  }
  // The middle of a cell along the lines, in samples.
  const auto middle = [&](std::int32_t cell) {
    const std::int32_t end = std::min((cell + 1) * step, offsets.length);
    return 0.5 * (cell * step + end - 1);
  };
  return lowered(
      means, "levelling lines",
      [&](const SampleRect& rect, double* out) {
        for (std::int32_t r = 0; r < rect.rows; ++r)
          for (std::int32_t c = 0; c < rect.columns; ++c)
            out[r * kTileSide + c] = rows ? of_cells.takenAt(rect.row + r, middle(rect.column + c))
                                          : of_cells.takenAt(rect.column + c, middle(rect.row + r));
      },
      job);
}

}  // namespace

LineView::LineView(Version field, const LineOptions& options)
    : field_(std::move(field)), options_(options), live_(field_, Growth::kAllowed) {}

Status LineView::findOffsets(std::int32_t stretch, JobControl& job) {
  const Grid& grid = field_.grid();
  const std::vector<std::int32_t> places =
      placesIn(options_.axis == ScanAxis::kX ? grid.width : grid.height, stretch);
  std::vector<std::int32_t> every_other;
  for (std::size_t i = 0; i < places.size(); i += 2) every_other.push_back(places[i]);
  auto offsets = findLineOffsets(field_, options_, places, job);
  if (!offsets) return tl::unexpected(offsets.error());
  const auto other = findLineOffsets(field_, options_, every_other, job);
  if (!other) return tl::unexpected(other.error());
  const double share = static_cast<double>(places.size()) / offsets->length;
  off_ = {rmsBetween(*offsets, *other) * std::sqrt(1.0 - share), true};
  offsets_ = *std::move(offsets);
  return {};
}

// Those that are not levelled yet.
Status LineView::levelTiles(const TileRange& tiles, JobControl& job) {
  const TileRange all = allTiles(field_.grid());
  levelled_.resize(static_cast<std::size_t>(all.tiles()));
  for (std::int32_t r = tiles.row; r < tiles.row + tiles.rows; ++r) {
    std::uint8_t* const done =
        levelled_.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(all.columns);
    const std::int32_t end = tiles.column + tiles.columns;
    for (std::int32_t c = tiles.column; c < end; ++c) {
      if (done[c] != 0) continue;
      const std::int32_t first = c;
      while (c < end && done[c] == 0) ++c;
      if (auto levelled = levelLines(field_, *offsets_, {first, r, c - first, 1}, live_, job); !levelled)
        return levelled;
      std::fill(done + first, done + c, std::uint8_t{1});
    }
  }
  return {};
}

Status LineView::see(const FieldView& view, const ShowEarly& show, JobControl& outer) try {
  JobControl job = JobControl::partOf(outer);
  const Grid& grid = field_.grid();
  const auto stretch = static_cast<std::int32_t>((grid.samples() + kSampled - 1) / kSampled);
  if (view.tiles.empty() || stretch < 2) return {};
  if (!offsets_)
    if (auto found = findOffsets(stretch, job); !found) return found;
  if (kMuch * view.tiles.tiles() > allTiles(grid).tiles() && grid.samples() > kLarge) {
    if (!means_) {
      const auto step =
          static_cast<std::int32_t>(std::ceil(std::sqrt(static_cast<double>(grid.samples()) / kCells)));
      auto levelled = levelledMeans(field_, *offsets_, step, job);
      if (!levelled) return tl::unexpected(levelled.error());
      means_ = EarlyPicture{*std::move(levelled), step, 0.0, 0.0, off_};
    }
    show(*means_);
    return {};
  }
  if (auto levelled = levelTiles(view.tiles, job); !levelled) return levelled;
  show({live_.snapshot(), 1, 0.0, 0.0, off_});
  return {};
} catch (const std::bad_alloc&) {
  return failure("there is not enough memory for levelled lines", "level", "close other programs");
}

}  // namespace fettle::engine
