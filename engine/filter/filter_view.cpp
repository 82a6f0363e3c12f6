#include "engine/filter/filter_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <tbb/parallel_for.h>

#include "engine/base/stopwatch.h"
#include "engine/field/piece.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/noise_range.h"
#include "engine/filter/pass.h"
#include "engine/filter/region.h"

namespace fettle::engine {

namespace {

constexpr double kCoarse_s = 0.08;  // of filtering means
// Of a sample in a new tile, whose memory the system clears first.
constexpr double kNewSample_s = 5e-9;
constexpr double kFewestCells = 96.0 * 96.0, kMostCells = 1280.0 * 1280.0;
// Of the field in view, as its inverse: from then on all of it is approximated.
constexpr std::int64_t kMuch = 4;
constexpr std::int64_t kFewSamples = 1 << 21;  // whose noise is found at once
// Of work that is done once more with the whole field.
constexpr double kPieces_s = 1.0;
constexpr std::int32_t kFarthestReach = 512;  // [samples]
// An exact piece that is worth its time for being compared with.
constexpr double kPiece_s = 0.03;

SampleRect samplesIn(const TileRange& tiles, const Grid& grid) noexcept {
  const std::int32_t c = tiles.column * kTileSide, r = tiles.row * kTileSide;
  return {c, r, std::min(tiles.columns * kTileSide, grid.width - c),
          std::min(tiles.rows * kTileSide, grid.height - r)};
}

SampleRect grown(const SampleRect& rect, std::int32_t by, const Grid& grid) noexcept {
  const std::int32_t c0 = std::max(rect.column - by, 0), r0 = std::max(rect.row - by, 0);
  return {c0, r0, std::min(rect.column + rect.columns + by, grid.width) - c0,
          std::min(rect.row + rect.rows + by, grid.height) - r0};
}

double count(const SampleRect& rect) noexcept {
  return static_cast<double>(rect.columns) * rect.rows;
}

TileRange within(const TileRange& tiles, const TileRange& all) noexcept {
  const std::int32_t c0 = std::clamp(tiles.column, 0, all.columns), r0 = std::clamp(tiles.row, 0, all.rows);
  return {c0, r0, std::clamp(tiles.column + tiles.columns, c0, all.columns) - c0,
          std::clamp(tiles.row + tiles.rows, r0, all.rows) - r0};
}

// A square around the middle of the view.
Version middleOf(const Version& field, const FieldView& view, std::int32_t side) {
  const Grid& grid = field.grid();
  const std::int32_t wide = std::min(side, grid.width), tall = std::min(side, grid.height);
  return pieceOf(field, std::clamp(view.column - wide / 2, 0, grid.width - wide),
                 std::clamp(view.row - tall / 2, 0, grid.height - tall), wide, tall);
}

// Time of all passes, from a square that is large enough to be timed; nothing where the filter cannot be applied.
std::optional<double> secondsASample(const Version& input, const FieldView& view, const FilterSpec& spec,
                                     const JobControl& outer) {
  constexpr double kTimed_s = 0.004;
  constexpr std::int32_t kLargest = 512;
  FilterSpec once = spec;
  once.passes = 1;
  for (std::int32_t side = kTileSide;; side *= 2) {
    const Version piece = middleOf(input, view, side);
    JobControl job = JobControl::partOf(outer);
    const Stopwatch watch;
    if (!applyFilter(piece, piece, once, job)) return std::nullopt;
    const double seconds = watch.seconds();
    if (seconds >= kTimed_s || side >= kLargest)
      return spec.passes * seconds / static_cast<double>(piece.grid().samples());
  }
}

// Results in view are there before the end only as pieces with what the filter reaches around them: the last of several
// passes begins late, and some filters go over the whole field first.
bool comesInPieces(const FilterSpec& spec) noexcept {
  return spec.passes > 1 || !filterOf(spec.kind).sampled;
}

bool piecesAreExact(const FilterSpec& spec, const Version& input) noexcept {
  return !needsWholeField(filterOf(spec.kind)) && reachOf(spec, input) <= kFarthestReach;
}

// How far around a part of the field the approximation of the part depends on samples, as far as that is affordable.
std::int32_t marginOf(const FilterSpec& spec, const Version& input, const SampleRect& rect) noexcept {
  const Grid& grid = input.grid();
  const double reach = needsWholeField(filterOf(spec.kind))
                           ? 2.0 * spec.nesting_mm / std::min(grid.spacingXMm(), grid.spacingYMm())
                           : reachOf(spec, input);
  return static_cast<std::int32_t>(std::min(reach, 0.5 * std::max(rect.columns, rect.rows)));
}

// Of two approximations, on a lattice of places in view.
FilterView::Off between(const CoarseFilter& a, const CoarseFilter& b, const SampleRect& rect) {
  constexpr std::int32_t kPlaces = 64;
  double squares = 0.0, most = 0.0;
  int compared = 0;
  for (std::int32_t y = 0; y < kPlaces; ++y)
    for (std::int32_t x = 0; x < kPlaces; ++x) {
      const auto c = static_cast<std::int32_t>(rect.column + (x + 0.5) * rect.columns / kPlaces);
      const auto r = static_cast<std::int32_t>(rect.row + (y + 0.5) * rect.rows / kPlaces);
      const double off = static_cast<double>(a.heightAt(c, r)) - static_cast<double>(b.heightAt(c, r));
      if (!std::isfinite(off)) continue;
      squares += off * off;
      most = std::max(most, std::abs(off));
      ++compared;
    }
  return {compared > 0 ? std::sqrt(squares / compared) : 0.0, most, true};
}

}  // namespace

FilterView::FilterView(Version input, Version original, const FieldView& view)
    : input_(std::move(input)),
      original_(std::move(original)),
      all_(allTiles(input_.grid())),
      view_{within(view.tiles, all_), view.column, view.row},
      live_(input_, Growth::kAllowed),
      steps_(static_cast<std::size_t>(all_.tiles()), kInput) {}

void FilterView::look(const FieldView& view) {
  const std::scoped_lock lock(mutex_);
  const FieldView cut{within(view.tiles, all_), view.column, view.row};
  if (cut == view_) return;
  view_ = cut;
  // Relaxed: the order of a block more is no matter.
  wish_.fetch_add(1, std::memory_order_relaxed);
}

FieldView FilterView::viewNow() const {
  const std::scoped_lock lock(mutex_);
  return view_;
}

Result<FilterView::Done> FilterView::run(const FilterSpec& asked, JobControl& job) {
  approximateIfSlow(asked, job);
  // Of the whole scan: a part has a noise of its own, and of what filters left a range would do next to nothing.
  const auto spec = withMeasuredRange(asked, original_, job);
  if (!spec) return tl::unexpected(spec.error());
  passes_ = spec->passes;
  if (comesInPieces(*spec) && piecesAreExact(*spec, input_)) filterPieces(*spec, job);
  FilterTuning tuning;
  tuning.work = this;
  auto filtered = applyFilter(input_, original_, *spec, tuning, job);
  if (!filtered) return tl::unexpected(filtered.error());
  return Done{*spec, std::move(*filtered)};
}

// Errors are those of the whole filter, which will report them.
void FilterView::approximateIfSlow(const FilterSpec& asked, JobControl& job) {
  const FieldView view = viewNow();
  if (view.tiles.empty()) return;
  const Grid& grid = input_.grid();
  const bool range_is_missing = hasRange(asked.kind) && asked.range_sigma == 0.0;
  JobControl quiet = JobControl::partOf(job);
  const auto spec =
      withMeasuredRange(asked, range_is_missing ? middleOf(original_, view, 8 * kTileSide) : input_, quiet);
  if (!spec || !validate(*spec, grid)) return;
  const auto each = secondsASample(input_, view, *spec, job);
  if (!each) return;
  const SampleRect seen = samplesIn(view.tiles, grid);
  double samples = count(seen);
  if (comesInPieces(*spec) || needsWholeField(filterOf(spec->kind)))
    samples = piecesAreExact(*spec, input_) ? count(grown(seen, reachOf(*spec, input_), grid))
                                            : static_cast<double>(grid.samples());
  const bool slow = samples * *each + count(seen) * kNewSample_s > kSoon_s ||
                    (range_is_missing && grid.samples() > kFewSamples);
  if (!slow) return;
  {
    const std::scoped_lock lock(mutex_);
    coarse_spec_ = *spec;
    seconds_a_sample_ = *each;
    range_is_guessed_ = range_is_missing;
  }
  (void)coarsen(quiet);
}

// What is in view, and around it what its approximation depends on.
SampleRect FilterView::approximated(const FieldView& view) const {
  const Grid& grid = input_.grid();
  if (kMuch * view.tiles.tiles() > all_.tiles()) return {0, 0, grid.width, grid.height};
  const SampleRect seen = samplesIn(view.tiles, grid);
  return grown(seen, marginOf(*coarse_spec_, input_, seen), grid);
}

std::int32_t FilterView::stepFor(const FieldView& view) const {
  const double cells = std::clamp(kCoarse_s / seconds_a_sample_, kFewestCells, kMostCells);
  const double step = std::ceil(std::sqrt(count(approximated(view)) / cells));
  return static_cast<std::int32_t>(std::clamp(step, 1.0, kExact - 1.0));
}

bool FilterView::wantsCoarse() const {
  const std::scoped_lock lock(mutex_);
  if (!coarse_spec_ || view_.tiles.empty()) return false;
  const std::int32_t step = stepFor(view_);
  for (std::int32_t r = 0; r < view_.tiles.rows; ++r)
    for (std::int32_t c = 0; c < view_.tiles.columns; ++c)
      if (const TileStep has = stepOf(view_.tiles.column + c, view_.tiles.row + r);
          has != kExact && (has == kInput || has > 2 * step))
        return true;
  return false;
}

Status FilterView::coarsen(JobControl& job) {
  FieldView view;
  FilterSpec spec;
  SampleRect rect;
  std::int32_t step = 1;
  {
    const std::scoped_lock lock(mutex_);
    if (!coarse_spec_ || view_.tiles.empty()) return {};
    view = view_;
    spec = *coarse_spec_;
    rect = approximated(view);
    step = stepFor(view);
    // Another approximation has other errors.
    squares_ = most_ = 0.0;
    compared_ = 0;
  }
  const Grid& grid = input_.grid();
  const SampleRect seen = samplesIn(view.tiles, grid);
  const auto coarse = CoarseFilter::make(input_, original_, spec, rect, step, job);
  if (!coarse) return tl::unexpected(coarse.error());
  compareNearest(*coarse, spec, job);
  if (count(rect) == static_cast<double>(grid.samples())) {
    const std::scoped_lock lock(mutex_);
    means_ = coarse->cells();
    step_of_means_ = step;
  }
  Status put = putCoarse(*coarse, view.tiles, job);
  {
    const std::scoped_lock lock(mutex_);
    means_ = {};
  }
  if (!put) return put;
  if (!needsWholeField(filterOf(spec.kind))) return {};
  // No result is there before the last one: half as many samples along each side, or half the samples around it.
  const auto other = CoarseFilter::make(input_, original_, spec,
                                        step > 1 ? rect : grown(seen, marginOf(spec, input_, seen) / 2, grid),
                                        step > 1 ? 2 * step : 1, job);
  if (!other) return tl::unexpected(other.error());
  const Off off = between(*coarse, *other, seen);
  const std::scoped_lock lock(mutex_);
  estimate_ = off;
  return {};
}

// The nearest results, where they take a moment: how far it is off is known when it is seen.
void FilterView::compareNearest(const CoarseFilter& coarse, const FilterSpec& spec, JobControl& job) {
  constexpr std::int32_t kSide = 2;  // tiles
  const SampleRect piece{0, 0, (kSide + 2) * kTileSide, (kSide + 2) * kTileSide};
  if (!piecesAreExact(spec, input_) || reachOf(spec, input_) > kTileSide ||
      count(piece) * seconds_a_sample_ > kPiece_s)
    return;
  const auto nearest = nearestPiece(kSide);
  if (!nearest) return;
  std::vector<NewExact> tiles = filterPiece(spec, *nearest, job);
  double squares = 0.0, most = 0.0;
  std::int64_t compared = 0;
  for (const NewExact& each : tiles) {
    const TileRef near = coarse.tile(input_, original_, spec, each.column, each.row);
    if (!near) return;
    const TileReport off = compareTiles(*near, *each.tile, bestCpuLevel());
    squares += off.squares;
    most = std::max(most, off.max_change);
    compared += kTileSamples - static_cast<std::int64_t>(each.tile->nan_samples);
  }
  {
    const std::scoped_lock lock(mutex_);
    squares_ += squares;
    most_ = std::max(most_, most);
    compared_ += compared;
    if (range_is_guessed_) return;  // no results, but as far off
  }
  putExact(std::move(tiles));
}

Status FilterView::putCoarse(const CoarseFilter& coarse, const TileRange& tiles, JobControl& job) {
  FilterSpec spec;
  const auto step = static_cast<TileStep>(coarse.step());
  {
    const std::scoped_lock lock(mutex_);
    spec = *coarse_spec_;
  }
  std::atomic<bool> room{true};
  const auto put_row = [&](std::int32_t tr) {
    if (job.cancelled()) return;
    std::vector<std::pair<std::int32_t, TileRef>> row;
    for (std::int32_t tc = tiles.column; tc < tiles.column + tiles.columns; ++tc) {
      TileRef tile = coarse.tile(input_, original_, spec, tc, tr);
      // Relaxed: read after the join of the loop.
      if (!tile) return room.store(false, std::memory_order_relaxed);
      row.emplace_back(tc, std::move(tile));
    }
    const std::scoped_lock lock(mutex_);
    begun_ = true;
    for (auto& [tc, tile] : row)
      if (TileStep& has = stepOf(tc, tr); has == kInput || (has != kExact && has > step))
        if (live_.replaceTile(tc, tr, std::move(tile))) has = step;
  };
  tbb::parallel_for(tiles.row, tiles.row + tiles.rows, put_row);
  if (!room) return failure("memory for filtering could not be had", "filter");
  return job.cancelled() ? Status(cancelled()) : Status();
}

void FilterView::filterPieces(const FilterSpec& spec, JobControl& job) {
  const Stopwatch watch;
  const std::int32_t side = std::clamp(2 * reachOf(spec, input_) / kTileSide, 4, 16);
  while (!job.cancelled()) {
    const auto piece = nearestPiece(side);
    const bool most = 2 * viewNow().tiles.tiles() > all_.tiles();
    if (!piece || (most && watch.seconds() > kPieces_s)) return;
    std::vector<NewExact> tiles = filterPiece(spec, *piece, job);
    if (tiles.empty()) return;
    putExact(std::move(tiles));
  }
}

// The square of tiles in view without results that is nearest to the middle.
std::optional<TileRange> FilterView::nearestPiece(std::int32_t side) const {
  const std::scoped_lock lock(mutex_);
  const TileRange& seen = view_.tiles;
  std::optional<TileRange> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::int32_t r = seen.row; r < seen.row + seen.rows; r += side)
    for (std::int32_t c = seen.column; c < seen.column + seen.columns; c += side) {
      const TileRange piece{c, r, std::min(side, seen.column + seen.columns - c),
                            std::min(side, seen.row + seen.rows - r)};
      const double x = (c + 0.5 * piece.columns) * kTileSide - view_.column;
      const double y = (r + 0.5 * piece.rows) * kTileSide - view_.row;
      if (x * x + y * y >= least) continue;
      bool exact = true;
      for (std::int32_t tr = r; exact && tr < r + piece.rows; ++tr)
        for (std::int32_t tc = c; exact && tc < c + piece.columns; ++tc) exact = stepOf(tc, tr) == kExact;
      if (exact) continue;
      least = x * x + y * y;
      nearest = piece;
    }
  return nearest;
}

// None: an error, which the whole filter will report.
std::vector<FilterView::NewExact> FilterView::filterPiece(const FilterSpec& spec, const TileRange& piece,
                                                          JobControl& job) const {
  std::vector<NewExact> tiles;
  const auto part = filterRange(input_, original_, input_, spec, piece, job);
  if (!part) return tiles;
  for (std::int32_t tr = piece.row; tr < piece.row + piece.rows; ++tr)
    for (std::int32_t tc = piece.column; tc < piece.column + piece.columns; ++tc)
      tiles.push_back({tc, tr, TileRef::share(&part->reader().tile(tc, tr))});
  return tiles;
}

Status FilterView::beginPass(const State& before) {
  before_ = before.field;
  last_pass_ = before.passes + 1 == passes_;
  return {};
}

double FilterView::rank(const TileRect& block) {
  constexpr double kUnseen = 1e18;
  const std::scoped_lock lock(mutex_);
  const TileRange& seen = view_.tiles;
  const bool in_view = block.column0 < seen.column + seen.columns && block.column1 > seen.column &&
                       block.row0 < seen.row + seen.rows && block.row1 > seen.row;
  const double x = 0.5 * (block.column0 + block.column1) * kTileSide - view_.column;
  const double y = 0.5 * (block.row0 + block.row1) * kTileSide - view_.row;
  return x * x + y * y + (in_view ? 0.0 : kUnseen);
}

void FilterView::done(const TileRect& block, std::vector<NewTile>& made, std::size_t first) {
  if (!last_pass_) return;
  std::vector<NewExact> tiles;
  const FieldReader reader = before_.reader();
  const std::int32_t columns = block.column1 - block.column0;
  for (std::int32_t tr = block.row0; tr < block.row1; ++tr)
    for (std::int32_t tc = block.column0; tc < block.column1; ++tc)
      tiles.push_back({tc, tr, TileRef::share(&reader.tile(tc, tr))});
  for (std::size_t i = first; i < made.size(); ++i)
    tiles[static_cast<std::size_t>((made[i].row - block.row0) * columns + made[i].column - block.column0)]
        .tile = made[i].tile;
  putExact(std::move(tiles));
}

void FilterView::putExact(std::vector<NewExact> tiles) {
  // What they replace, where that was approximated; compared while nobody waits.
  std::vector<TileRef> approximated(tiles.size());
  {
    const std::scoped_lock lock(mutex_);
    for (std::size_t i = 0; i < tiles.size(); ++i)
      if (const TileStep has = stepOf(tiles[i].column, tiles[i].row); has != kInput && has != kExact)
        approximated[i] = TileRef::share(&live_.reader().tile(tiles[i].column, tiles[i].row));
  }
  double squares = 0.0, most = 0.0;
  std::int64_t compared = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (!approximated[i]) continue;
    const TileReport off = compareTiles(*approximated[i], *tiles[i].tile, bestCpuLevel());
    squares += off.squares;
    most = std::max(most, off.max_change);
    compared += kTileSamples - static_cast<std::int64_t>(tiles[i].tile->nan_samples);
  }
  const std::scoped_lock lock(mutex_);
  begun_ = true;
  squares_ += squares;
  most_ = std::max(most_, most);
  compared_ += compared;
  for (NewExact& each : tiles) {
    // Without memory the whole filter fails as well.
    if (&live_.reader().tile(each.column, each.row) == each.tile.get() ||
        live_.replaceTile(each.column, each.row, std::move(each.tile)))
      stepOf(each.column, each.row) = kExact;
  }
}

FilterView::Picture FilterView::picture() const {
  const std::scoped_lock lock(mutex_);
  Picture picture;
  if (compared_ > 0)
    picture.off = Off{std::sqrt(squares_ / static_cast<double>(compared_)), most_, false};
  else
    picture.off = estimate_;
  if (!means_.empty()) {
    picture.field = means_;
    picture.step = step_of_means_;
    return picture;
  }
  if (!begun_) return picture;
  picture.field = live_.snapshot();
  const TileRange& seen = view_.tiles.empty() ? all_ : view_.tiles;
  std::int64_t exact = 0, untouched = 0;
  for (std::int32_t r = 0; r < seen.rows; ++r)
    for (std::int32_t c = 0; c < seen.columns; ++c) {
      const TileStep has = stepOf(seen.column + c, seen.row + r);
      if (has == kExact)
        ++exact;
      else if (has == kInput)
        ++untouched;
      else
        picture.step = std::max<std::int32_t>(picture.step, has);
    }
  picture.exact = static_cast<double>(exact) / static_cast<double>(seen.tiles());
  picture.untouched = static_cast<double>(untouched) / static_cast<double>(seen.tiles());
  return picture;
}

}  // namespace fettle::engine
