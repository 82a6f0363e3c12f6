#include "engine/field/seen_field.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "engine/field/difference_inl.h"
#include "engine/field/live_field.h"
#include "engine/field/nominal_form.h"
#include "engine/field/sample_rect.h"
#include "engine/field/tile_fill.h"

namespace fettle::engine {

namespace {

// Rounded once, and no infinity: a difference of two finite heights may be beyond the range of float.
float roundedHeight(double height) noexcept {
  constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
  return static_cast<float>(std::clamp(height, -kMost, kMost));
}

// A sample as it is seen under a form of this height.
float seenAs(float sample, double form) noexcept {
  return std::isnan(sample) ? sample : roundedHeight(sample - form);
}

// Which tile of a field.
struct FormTile {
  std::int32_t column = 0, row = 0;
  const Tile* after = nullptr;  // in the version that the tile is taken from

  [[nodiscard]] SampleRect rect(const Grid& grid) const noexcept {
    const std::int32_t c = column * kTileSide, r = row * kTileSide;
    return {c, r, std::min(kTileSide, grid.width - c), std::min(kTileSide, grid.height - r)};
  }
};

std::vector<FormTile> everyTile(const Version& version) {
  const FieldReader reader = version.reader();
  std::vector<FormTile> tiles;
  tiles.reserve(static_cast<std::size_t>(reader.tileColumns()) * static_cast<std::size_t>(reader.tileRows()));
  for (std::int32_t r = 0; r < reader.tileRows(); ++r)
    for (std::int32_t c = 0; c < reader.tileColumns(); ++c) tiles.push_back({c, r, &reader.tile(c, r)});
  return tiles;
}

std::vector<FormTile> tilesNotShared(const Version& before, const Version& after) {
  std::vector<FormTile> tiles;
  detail::walkChanges(before.reader().root(), after.reader().root(), 0, 0,
                      [&](std::int32_t c, std::int32_t r, const Tile&, const Tile& tile) {
                        tiles.push_back({c, r, &tile});
                      });
  return tiles;
}

bool sameTile(const Tile& a, const Tile& b) noexcept {
  const auto bits = [](float sample) { return std::bit_cast<std::uint32_t>(sample); };
  return std::ranges::equal(a.samples, b.samples, {}, bits, bits) && a.marks == b.marks;
}

// The tile of samples `from` as it is seen.
void seenTile(const Tile& from, const double* form, const SampleRect& rect, Tile& out) noexcept {
  out.samples = from.samples;
  for (int r = 0; r < rect.rows; ++r)
    for (int k = r * kTileSide; k < r * kTileSide + rect.columns; ++k) {
      const auto i = static_cast<std::size_t>(k);
      out.samples[i] = seenAs(from.samples[i], form[k]);
    }
  out.marks = from.marks;
  summariseTile(out);
}

// The tile of samples after an edit of what is seen of them.
void restoredTile(const Tile& before, const Tile& seen, const double* form, const SampleRect& rect,
                  Tile& out) noexcept {
  out.samples = before.samples;
  for (int r = 0; r < rect.rows; ++r)
    for (int k = r * kTileSide; k < r * kTileSide + rect.columns; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const float was = seenAs(before.samples[i], form[k]), now = seen.samples[i];
      if (now == was || (std::isnan(now) && std::isnan(was))) continue;
      out.samples[i] = std::isnan(now) ? now : roundedHeight(now + form[k]);
    }
  out.marks = seen.marks;
  summariseTile(out);
}

tl::unexpected<Error> noMemoryForForm() {
  return failure("memory for the field without its form could not be allocated", "form",
                 "close other programs, or work with the form in place");
}

// Calls one(tile, its samples' form, index) for all tiles in parallel; false from one of them ends it.
Status forAll(const std::vector<FormTile>& tiles, const Version& version, const char* stage, JobControl& job,
              const auto& one) {
  job.begin(stage, tiles.size());
  std::atomic<bool> failed = false;  // relaxed: read again after the loop's join
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
    if (job.cancelled() || failed.load(std::memory_order_relaxed)) return;
    double form[kTileSamples];
    version.form()->readHeights(tiles[i].rect(version.grid()), form, kTileSide);
    if (!one(tiles[i], form, i)) failed.store(true, std::memory_order_relaxed);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  if (failed.load(std::memory_order_relaxed)) return noMemoryForForm();
  return {};
}

// `version` with tiles replaced where there is one, and with the lines and the sign of another.
Result<Version> withTiles(const Version& version, const std::vector<FormTile>& places,
                          std::vector<TileRef>& tiles, const Version& other) {
  const Version start = version.lines() == other.lines() ? version : version.withLines(other.lines());
  LiveField live(start, Growth::kAllowed);
  for (std::size_t i = 0; i < places.size(); ++i)
    if (tiles[i] && !live.replaceTile(places[i].column, places[i].row, std::move(tiles[i])))
      return noMemoryForForm();
  if (live.reader().sign() != other.reader().sign()) live.invert();
  return live.snapshot();
}

// `seen` with the tiles of `version` at some places as they are seen.
Result<Version> withSeen(const Version& seen, const Version& version, const std::vector<FormTile>& places,
                         JobControl& job) {
  TilePool& pool = version.memory()->bulk();
  if (!pool.reserve(places.size())) return noMemoryForForm();
  std::vector<TileRef> tiles(places.size());
  auto done = forAll(places, version, "removing the form", job,
                     [&](const FormTile& place, const double* form, std::size_t i) {
                       tiles[i] = TileRef::adopt(pool.acquire());
                       if (!tiles[i]) return false;
                       seenTile(*place.after, form, place.rect(version.grid()), *tiles[i]);
                       return true;
                     });
  if (!done) return tl::unexpected(done.error());
  return withTiles(seen, places, tiles, version);
}

// What is seen of a version, and knows it.
Version knowing(const Version& seen, const Version& version) {
  return seen.withSeenOf(std::make_shared<const SeenPair>(SeenPair{version, seen}));
}

// restored() of a field, from another state under the same pair whose samples are known: only the tiles in which the
// two differ are compared.
Result<Version> restoredFrom(const Version& field, const Version& known, const Version& known_restored,
                             JobControl& job) {
  const Version& base = *field.seenOf();
  const FieldReader before = base.reader(), before_seen = field.seenAs()->reader();
  const FieldReader at_known = known_restored.reader();
  const std::vector<FormTile> places = tilesNotShared(known, field);
  TilePool& pool = base.memory()->bulk();
  std::vector<TileRef> tiles(places.size());
  const auto one = [&](const FormTile& place, const double* form, std::size_t i) {
    const Tile& was = before.tile(place.column, place.row);
    const Tile& there = at_known.tile(place.column, place.row);
    TileRef now;
    if (place.after != &before_seen.tile(place.column, place.row)) {
      now = TileRef::adopt(pool.acquire());
      if (!now) return false;
      restoredTile(was, *place.after, form, place.rect(base.grid()), *now);
    }
    if (!now || sameTile(*now, was)) {
      if (&was != &there) tiles[i] = TileRef::share(&was);
    } else if (!sameTile(*now, there)) {
      tiles[i] = std::move(now);
    }
    return true;
  };
  if (auto done = forAll(places, base, "restoring the form", job, one); !done)
    return tl::unexpected(done.error());
  Grid grid = field.grid();
  grid.height_per_count = base.grid().height_per_count;
  return withTiles(grid == known_restored.grid() ? known_restored : known_restored.withGrid(std::move(grid)),
                   places, tiles, field);
}

}  // namespace

Result<SeenField> SeenField::of(const Version& version, JobControl& job) {
  if (version.form() == nullptr) return SeenField(version, version, version);
  // What is seen is no multiple of a count.
  Grid grid = version.grid();
  grid.height_per_count = 0.0;
  const auto seen =
      withSeen(version.withForm(nullptr).withGrid(std::move(grid)), version, everyTile(version), job);
  if (!seen) return tl::unexpected(seen.error());
  const Version known = knowing(*seen, version);
  return SeenField(version, known, known);
}

Result<SeenField> SeenField::at(const Version& version, JobControl& job) const {
  if (version.form() == nullptr || version.form() != restored_.form() ||
      version.memory() != restored_.memory())
    return of(version, job);
  const auto seen = withSeen(seen_.withSeenOf(nullptr), version, tilesNotShared(restored_, version), job);
  if (!seen) return tl::unexpected(seen.error());
  const Version known = knowing(*seen, version);
  return SeenField(version, known, known);
}

Result<SeenField> SeenField::edited(const Version& field, JobControl& job) const {
  if (restored_.form() == nullptr) return SeenField(field, field, field);
  assert(field.form() == nullptr && field.grid().width == restored_.grid().width &&
         field.grid().height == restored_.grid().height);
  const std::vector<FormTile> places = tilesNotShared(field_, field);
  const FieldReader before = restored_.reader();
  const FieldReader before_seen = seen_.reader();
  TilePool& pool = restored_.memory()->bulk();
  const bool one_memory = field.memory() == restored_.memory();
  std::vector<TileRef> restored(places.size()), seen(places.size());
  auto done = forAll(places, restored_, "restoring the form", job,
                     [&](const FormTile& place, const double* form, std::size_t i) {
                       const SampleRect rect = place.rect(restored_.grid());
                       const Tile& was = before.tile(place.column, place.row);
                       TileRef now = TileRef::adopt(pool.acquire());
                       TileRef shown = TileRef::adopt(pool.acquire());
                       if (!now || !shown) return false;
                       restoredTile(was, *place.after, form, rect, *now);
                       if (sameTile(*now, was)) return true;  // as is what is seen
                       seenTile(*now, form, rect, *shown);
                       if (sameTile(*shown, *place.after) && one_memory)
                         seen[i] = TileRef::share(place.after);
                       else if (!sameTile(*shown, before_seen.tile(place.column, place.row)))
                         seen[i] = std::move(shown);
                       restored[i] = std::move(now);
                       return true;
                     });
  if (!done) return tl::unexpected(done.error());
  auto stored = withTiles(restored_, places, restored, field);
  if (!stored) return tl::unexpected(stored.error());
  auto shown = withTiles(seen_.withSeenOf(nullptr), places, seen, field);
  if (!shown) return tl::unexpected(shown.error());
  return SeenField(*stored, knowing(*shown, *stored), field);
}

Result<Version> restored(const Version& field, JobControl& job) {
  if (field.seenOf() == nullptr) return field;
  return restoredFrom(field, *field.seenAs(), *field.seenOf(), job);
}

Result<Version> StoredStates::of(const Version& state, JobControl& job) {
  if (state.seenOf() == nullptr) {
    state_ = stored_ = {};
    return state;
  }
  const bool near = !state_.empty() && state_.seenOf() == state.seenOf();
  auto stored = near ? restoredFrom(state, state_, stored_, job) : restored(state, job);
  if (!stored) return stored;
  state_ = state;
  stored_ = *stored;
  return stored;
}

Result<Version> seenNear(const Version& version, const Version& near, JobControl& job) {
  const bool at = version.form() != nullptr && near.seenOf() != nullptr &&
                  near.seenOf()->form() == version.form() && near.seenOf()->memory() == version.memory();
  const auto seen = at ? SeenField(*near.seenOf(), *near.seenAs(), *near.seenAs()).at(version, job)
                       : SeenField::of(version, job);
  if (!seen) return tl::unexpected(seen.error());
  return seen->seen();
}

Version madeHeights(const Version& field) {
  if (field.seenOf() == nullptr) return field;
  Grid grid = field.grid();
  grid.height_per_count = field.seenOf()->grid().height_per_count;
  return field.withSeenOf(nullptr).withGrid(std::move(grid));
}

Result<Version> sharingEqualTiles(const Version& version, const Version& with) {
  std::vector<FormTile> places;
  std::vector<TileRef> tiles;
  detail::walkChanges(with.reader().root(), version.reader().root(), 0, 0,
                      [&](std::int32_t c, std::int32_t r, const Tile& other, const Tile& tile) {
                        if (!sameTile(other, tile)) return;
                        places.push_back({c, r, &tile});
                        tiles.push_back(TileRef::share(&other));
                      });
  return withTiles(version, places, tiles, version);
}

FieldForm formOfHeights(const Version& field) {
  const FieldForm& form = field.formOver();
  if (form == nullptr || field.reader().sign() > 0.0F) return form;
  return std::make_shared<const NominalForm>(form->inverted());
}

Result<Version> withoutLayer(const Version& field, JobControl& job) {
  auto samples = restored(field, job);
  if (!samples || samples->form() == nullptr) return samples;
  return samples->withForm(nullptr);
}

Result<Version> seenLike(const Version& field, const Version& other, JobControl& job) {
  auto samples = withoutLayer(field, job);
  const bool one_size =
      field.grid().width == other.grid().width && field.grid().height == other.grid().height;
  if (!samples || other.seenOf() == nullptr || !one_size) return samples;
  const auto seen = SeenField::of(samples->withForm(other.seenOf()->form()), job);
  if (!seen) return tl::unexpected(seen.error());
  return seen->seen();
}

}  // namespace fettle::engine
