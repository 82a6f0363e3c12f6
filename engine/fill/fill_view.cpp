#include "engine/fill/fill_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/stopwatch.h"
#include "engine/field/means.h"
#include "engine/fill/coarse_hole.h"
#include "engine/fill/hole_filler.h"
#include "engine/fill/holes.h"

namespace fettle::engine {

namespace {

constexpr std::int32_t kMargin = 8;  // tiles around the view
// Between two pictures: samples that are filled within a tenth of a second.
constexpr std::int64_t kSamplesAtOnce = 50'000;
constexpr std::int64_t kMostOfHole = 10'000;  // samples: some hundredths of a second
constexpr double kTwice_s = 1.0;              // of work that is done once more with the whole field
constexpr double kLargest_s = 0.5;            // of large holes, one after the other
// Of the field in view, as its inverse, and of its samples: from then on the picture is of means.
constexpr std::int64_t kMuch = 4, kLarge = 1 << 23;
constexpr double kCells = 1 << 20;
constexpr std::int64_t kMostCellsOfHole = 20'000;
constexpr std::int64_t kCompared = 30'000;   // samples filled for measuring how far means are off
constexpr std::int32_t kComparedReach = 16;  // tiles around the middle where they are looked for first

TileRange grownBy(const TileRange& tiles, std::int32_t by, const TileRange& all) noexcept {
  const std::int32_t c0 = std::clamp(tiles.column - by, 0, all.columns),
                     r0 = std::clamp(tiles.row - by, 0, all.rows);
  return {c0, r0, std::clamp(tiles.column + tiles.columns + by, c0, all.columns) - c0,
          std::clamp(tiles.row + tiles.rows + by, r0, all.rows) - r0};
}

bool reaches(const SampleRect& box, const TileRange& tiles) noexcept {
  return box.column < (tiles.column + tiles.columns) * kTileSide &&
         box.column + box.columns > tiles.column * kTileSide &&
         box.row < (tiles.row + tiles.rows) * kTileSide && box.row + box.rows > tiles.row * kTileSide;
}

void sortByDistance(std::vector<const Hole*>& holes, const FieldView& view) {
  const auto distance = [&](const Hole* hole) {
    const double x = hole->box.column + 0.5 * hole->box.columns - view.column;
    const double y = hole->box.row + 0.5 * hole->box.rows - view.row;
    return x * x + y * y;
  };
  std::ranges::stable_sort(holes, {}, distance);
}

// As many of the first ones as have about so many samples.
std::span<const Hole* const> firstOf(std::span<const Hole* const> holes, std::int64_t most) noexcept {
  std::size_t end = 0;
  for (std::int64_t samples = 0; end < holes.size() && samples < most; ++end) samples += holes[end]->samples;
  return holes.first(end);
}

bool isSoonFilled(const Hole* hole) noexcept {
  return !hole->cut && hole->samples <= kMostOfHole;
}

// Of holes of means: what is too much for the field is too much for these.
FillOptions ofMeans(const FillOptions& options, const Grid& grid, std::int32_t step) noexcept {
  FillOptions coarse = options;
  const double sample = grid.spacingXMm() * grid.spacingYMm(), cell = sample * step * step;
  coarse.most_area_mm2 = std::min({options.most_area_mm2, sample * static_cast<double>(options.mostSamples()),
                                   cell * static_cast<double>(kMostCellsOfHole)});
  return coarse;
}

using Cells = std::vector<std::pair<std::int32_t, std::int32_t>>;  // row, column; sorted, each once

Cells cellsOf(const Holes& holes, std::span<const Hole* const> chosen, std::int32_t step) {
  Cells cells;
  for (const Hole* hole : chosen)
    for (const HoleRun& run : holes.runsOf(*hole))
      for (std::int32_t c = run.first / step; c <= run.last / step; ++c)
        cells.emplace_back(run.row / step, c);
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

class Difference {
 public:
  void add(double off) noexcept {
    if (!std::isfinite(off)) return;
    squares_ += off * off;
    ++compared_;
  }
  [[nodiscard]] std::optional<double> rms() const noexcept {
    if (compared_ == 0) return std::nullopt;
    return std::sqrt(squares_ / static_cast<double>(compared_));
  }

 private:
  double squares_ = 0.0;
  std::int64_t compared_ = 0;
};

// Of filled means off the means of what is filled, in the holes nearest to the middle.
Result<std::optional<double>> offHoles(const Version& field, const FillOptions& options,
                                       const FieldView& view, const Version& coarse, std::int32_t step,
                                       JobControl& job) {
  const TileRange all = allTiles(field.grid());
  for (std::int32_t reach = kComparedReach;; reach *= 4) {
    const TileRange part = grownBy({view.column / kTileSide, view.row / kTileSide, 1, 1},
                                   std::min(reach, std::max(all.columns, all.rows)), all);
    const auto holes = findHoles(field, part, job);
    if (!holes) return tl::unexpected(holes.error());
    Filled counts;
    std::vector<const Hole*> near = chooseHoles(*holes, options, field.grid(), counts).holes;
    std::erase_if(near, [](const Hole* hole) { return !isSoonFilled(hole); });
    if (near.empty()) {
      if (part == all) return std::nullopt;
      continue;
    }
    sortByDistance(near, view);
    const auto compared = firstOf(near, kCompared);
    HoleFiller filler(field, options);
    if (auto filled = filler.fill(*holes, compared, counts, job); !filled)
      return tl::unexpected(filled.error());
    SampleRect around;
    for (const Hole* hole : compared) around = around.joined(hole->box);
    // From cell to cell.
    const std::int32_t c0 = around.column / step * step, r0 = around.row / step * step;
    const std::int32_t c1 = (around.column + around.columns + step - 1) / step * step,
                       r1 = (around.row + around.rows + step - 1) / step * step;
    const SampleRect cells{c0, r0, std::min(c1, field.grid().width) - c0,
                           std::min(r1, field.grid().height) - r0};
    const Version exact = meansOf(filler.snapshot(), cells, step);
    Difference off;
    for (const auto& [row, column] : cellsOf(*holes, compared, step))
      off.add(static_cast<double>(coarse.reader().heightAt(column, row)) -
              static_cast<double>(exact.reader().heightAt(column - c0 / step, row - r0 / step)));
    if (const auto rms = off.rms(); rms || part == all) return rms;
  }
}

// Of filled means off those filled after four were made one, where these were filled.
Result<std::optional<double>> offCoarser(const Version& means, const Version& filled,
                                         const FillOptions& options, JobControl& job) {
  const SampleRect all{0, 0, means.grid().width, means.grid().height};
  const Version fours = meansOf(means, all, 2);
  auto other = fillHoles(fours, options, job);
  if (!other) return tl::unexpected(other.error());
  const Version of_filled = meansOf(filled, all, 2);
  Difference off;
  const FieldReader before = fours.reader(), a = of_filled.reader(), b = other->field.reader();
  for (std::int32_t r = 0; r < before.height(); ++r)
    for (std::int32_t c = 0; c < before.width(); ++c)
      if (std::isnan(before.heightAt(c, r)))
        off.add(static_cast<double>(a.heightAt(c, r)) - static_cast<double>(b.heightAt(c, r)));
  return off.rms();
}

}  // namespace

FillView::FillView(Version field, const FillOptions& options)
    : field_(std::move(field)), options_(options), filler_(field_, options_) {}

// Of a hole that is cut only a part is known, which lies in its rectangle.
const FillView::Approximated* FillView::approximatedAt(const HoleRun& first, bool cut) const noexcept {
  const auto is = [&](const Approximated& each) {
    if (!cut) return each.first == first;
    const SampleRect& box = each.box;
    return first.first >= box.column && first.first < box.column + box.columns && first.row >= box.row &&
           first.row < box.row + box.rows;
  };
  const auto at = std::ranges::find_if(approximated_, is);
  return at != approximated_.end() ? &*at : nullptr;
}

Status FillView::see(const FieldView& view, const ShowEarly& show, JobControl& outer) try {
  if (view.tiles.empty() || field_.reader().bounds().empty()) return {};
  JobControl job = JobControl::partOf(outer);
  const bool much = kMuch * view.tiles.tiles() > allTiles(field_.grid()).tiles();
  return much && field_.grid().samples() > kLarge ? seeMeans(view, show, job) : seeSamples(view, show, job);
} catch (const std::bad_alloc&) {
  return failure("there is not enough memory for the equations of a hole", "fill",
                 "fill smaller holes alone");
}

Status FillView::seeSamples(const FieldView& view, const ShowEarly& show, JobControl& job) {
  const Stopwatch watch;
  const TileRange all = allTiles(field_.grid());
  const auto holes = findHoles(field_, grownBy(view.tiles, kMargin, all), job);
  if (!holes) return tl::unexpected(holes.error());
  Filled counts;
  std::vector<const Hole*> seen = chooseHoles(*holes, options_, field_.grid(), counts).holes;
  std::erase_if(seen, [&](const Hole* hole) { return !reaches(hole->box, view.tiles); });
  sortByDistance(seen, view);
  // In samples.
  std::int64_t wanted = 0, exact = 0, coarse = 0;
  Approximated off;
  const auto add = [&](const Hole* hole, const Approximated& found) {
    coarse += hole->samples;
    off.squares += found.squares;
    off.compared += found.compared;
  };
  std::vector<const Hole*> soon, large;
  const Version known = filler_.snapshot();
  for (const Hole* hole : seen) {
    const HoleRun& first = holes->runsOf(*hole).front();
    const bool filled = !std::isnan(known.reader().heightAt(first.first, first.row));
    wanted += hole->samples;
    if (const Approximated* const found = filled ? approximatedAt(first, hole->cut) : nullptr)
      add(hole, *found);
    else if (filled)
      exact += hole->samples;
    else if (!hole->cut)
      (isSoonFilled(hole) ? soon : large).push_back(hole);
  }
  bool shown_now = false;
  const auto show_now = [&] {
    EarlyPicture picture{filler_.snapshot(), 1, 1.0, 0.0, std::nullopt};
    if (wanted > 0) {
      picture.exact = static_cast<double>(exact) / static_cast<double>(wanted);
      picture.untouched = static_cast<double>(wanted - exact - coarse) / static_cast<double>(wanted);
    }
    if (off.compared > 0) picture.off = {std::sqrt(off.squares / static_cast<double>(off.compared)), true};
    shown_ = shown_now = true;
    show(std::move(picture));
  };
  if (shown_ && exact + coarse > 0) show_now();
  const bool most = 2 * view.tiles.tiles() > all.tiles();
  const auto late = [&] { return most && watch.seconds() > kTwice_s; };
  for (const Hole* hole : large) {
    if (late() || watch.seconds() > kLargest_s) break;
    const auto found = coarseHole(field_, options_, *holes, *hole, job);
    if (!found) {
      if (found.error().kind == ErrorKind::kCancelled) return tl::unexpected(found.error());
      continue;  // no mean around it has a height
    }
    if (!filler_.put(holes->runsOf(*hole), found->heights))
      return failure("there is not enough memory for the filled field", "fill",
                     "keep the samples on a disk with --store FOLDER");
    approximated_.push_back({holes->runsOf(*hole).front(), hole->box, found->squares, found->compared});
    add(hole, approximated_.back());
  }
  if (coarse > 0 && !large.empty()) show_now();
  for (std::span<const Hole* const> rest = soon; !rest.empty() && !late();) {
    const auto next = firstOf(rest, kSamplesAtOnce);
    if (auto filled = filler_.fill(*holes, next, counts, job); !filled) return filled;
    rest = rest.subspan(next.size());
    for (const Hole* hole : next) exact += hole->samples;
    show_now();
  }
  // Nothing is to be filled there, or nothing before the whole.
  if (shown_ && !shown_now) show_now();
  return {};
}

Status FillView::seeMeans(const FieldView& view, const ShowEarly& show, JobControl& job) {
  if (!has_means_) {
    const Grid& grid = field_.grid();
    const auto step =
        static_cast<std::int32_t>(std::ceil(std::sqrt(static_cast<double>(grid.samples()) / kCells)));
    const Version means = meansOf(field_, {0, 0, grid.width, grid.height}, step);
    if (job.cancelled()) return cancelled();
    const FillOptions of_means = ofMeans(options_, grid, step);
    const auto filled = fillHoles(means, of_means, job);
    if (!filled) return tl::unexpected(filled.error());
    const auto measured = offHoles(field_, options_, view, filled->field, step, job);
    if (!measured) return tl::unexpected(measured.error());
    std::optional<EarlyPicture::Off> off;
    if (*measured) {
      off = {**measured, false};
    } else if (filled->filled_holes > 0) {
      const auto estimate = offCoarser(means, filled->field, of_means, job);
      if (!estimate) return tl::unexpected(estimate.error());
      off = {estimate->value_or(0.0), true};
    }
    if (off) means_ = EarlyPicture{filled->field, step, 0.0, 0.0, off};
    has_means_ = true;
  }
  // Without holes that are filled the field is as it was.
  if (!means_ && !shown_) return {};
  shown_ = true;
  show(means_ ? *means_ : EarlyPicture{filler_.snapshot(), 1, 0.0, 1.0, std::nullopt});
  return {};
}

}  // namespace fettle::engine
