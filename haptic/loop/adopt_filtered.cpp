#include "haptic/loop/adopt_filtered.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "engine/field/piece.h"
#include "engine/filter/catalogue.h"

namespace fettle::haptic {

engine::Result<MergedResult> mergeResult(const engine::Version& now, const engine::Version& base,
                                         const engine::Version& result) {
  engine::LiveField merged(now, engine::Growth::kAllowed);
  const engine::FieldReader present = now.reader();
  MergedResult out;
  for (engine::TileChange& change : engine::changedTiles(base, result)) {
    if (&present.tile(change.tile_column, change.tile_row) != change.before.get())
      out.conflicts.push_back({change.tile_column, change.tile_row});
    else if (!merged.replaceTile(change.tile_column, change.tile_row, std::move(change.after)))
      return engine::failure("memory for the filtered tiles could not be allocated",
                             "adopting a filter's result", "close other programs or filter a smaller field");
  }
  out.version = merged.snapshot();
  return out;
}

std::vector<TileSpot> withHalo(const std::vector<TileSpot>& edited, std::int32_t reach_samples,
                               const engine::Grid& grid) {
  const std::int32_t columns = (grid.width + engine::kTileSide - 1) / engine::kTileSide;
  const std::int32_t rows = (grid.height + engine::kTileSide - 1) / engine::kTileSide;
  const std::int32_t reach = (reach_samples + engine::kTileSide - 1) / engine::kTileSide;
  std::vector<TileSpot> all;
  for (const TileSpot& spot : edited)
    for (std::int32_t r = std::max(spot.row - reach, 0); r <= std::min(spot.row + reach, rows - 1); ++r)
      for (std::int32_t c = std::max(spot.column - reach, 0); c <= std::min(spot.column + reach, columns - 1);
           ++c)
        all.push_back({c, r});
  const auto key = [](const TileSpot& t) { return std::tuple(t.row, t.column); };
  std::sort(all.begin(), all.end(), [&](const TileSpot& a, const TileSpot& b) { return key(a) < key(b); });
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

namespace {

using engine::kTileSide;

struct ByRow {
  bool operator()(const TileSpot& a, const TileSpot& b) const noexcept {
    return std::tie(a.row, a.column) < std::tie(b.row, b.column);
  }
};
using Spots = std::set<TileSpot, ByRow>;

tl::unexpected<engine::Error> noMemory() {
  return engine::failure("memory for the filtered tiles could not be allocated", "adopting a filter's result",
                         "close other programs or filter a smaller field");
}

const engine::Tile* tileOf(const engine::Version& version, const TileSpot& spot) noexcept {
  return &version.reader().tile(spot.column, spot.row);
}

bool putTile(engine::LiveField& into, const engine::Version& from, const TileSpot& spot) noexcept {
  return into.replaceTile(spot.column, spot.row, engine::TileRef::share(tileOf(from, spot)));
}

std::vector<TileSpot> changedSpots(const engine::Version& before, const engine::Version& after) {
  std::vector<TileSpot> spots;
  for (const engine::TileChange& change : engine::changedTiles(before, after))
    spots.push_back({change.tile_column, change.tile_row});
  return spots;
}

// State of the live field during the rounds.
class Adoption {
 public:
  Adoption(AdoptionPort& port, const engine::Version& base, const engine::Version& result,
           const engine::Version& original, const engine::FilterSpec& spec, engine::JobControl& job)
      : port_(port), original_(original), spec_(spec), job_(job), raw_(base), filtered_(result) {
    for (const TileSpot& spot : changedSpots(base, result)) due_.insert(spot);
  }

  engine::Result<AdoptionReport> run(int most_rounds) {
    for (;;) {
      if (job_.cancelled()) return engine::cancelled();
      if (engine::Status done = round(); !done) return tl::unexpected(done.error());
      if ((!first_ && unfiltered_.empty()) || report_.rounds >= most_rounds) break;
      port_.pause();
    }
    report_.rest.assign(unfiltered_.begin(), unfiltered_.end());
    if (first_) report_.rest.assign(due_.begin(), due_.end());
    return report_;
  }

 private:
  engine::Status round() {
    ++report_.rounds;
    engine::Result<engine::Version> now = port_.snapshot();
    if (!now) return tl::unexpected(now.error());
    if (engine::Status done = filterAgain(*now); !done) return done;
    engine::Result<engine::Version> offer = merged(*now);
    if (!offer) return tl::unexpected(offer.error());
    engine::Result<AdoptionPort::Answer> answer = port_.adopt(*offer);
    if (!answer) return tl::unexpected(answer.error());
    if (!answer->adopted) {
      ++report_.refusals;
      return {};
    }
    // Edited between snapshot and adoption: of these, what was not filtered before is not filtered now.
    Spots left;
    for (const TileSpot& spot : changedSpots(*offer, answer->version))
      if (first_ || unfiltered_.contains(spot)) left.insert(spot);
    unfiltered_ = std::move(left);
    felt_ = answer->version;
    first_ = false;
    due_.clear();
    return {};
  }

  // Collects the edits of tiles that are not filtered yet and filters them again, with all tiles they affect.
  engine::Status filterAgain(const engine::Version& now) {
    engine::LiveField raw(raw_, engine::Growth::kAllowed);
    std::vector<TileSpot> edited;
    const auto follow = [&](const TileSpot& spot) {
      if (tileOf(now, spot) == tileOf(raw_, spot)) return true;
      edited.push_back(spot);
      return putTile(raw, now, spot);
    };
    for (const TileSpot& spot :
         first_ ? changedSpots(raw_, now) : std::vector<TileSpot>(unfiltered_.begin(), unfiltered_.end()))
      if (!follow(spot)) return noMemory();
    raw_ = raw.snapshot();
    const std::vector<TileSpot> affected = withHalo(edited, engine::reachOf(spec_, raw_), now.grid());
    if (!affected.empty()) {
      engine::Result<engine::Version> again = filterTiles(raw_, original_, spec_, affected, job_);
      if (!again) return tl::unexpected(again.error());
      engine::LiveField filtered(filtered_, engine::Growth::kAllowed);
      for (const TileSpot& spot : affected)
        if (!putTile(filtered, *again, spot)) return noMemory();
      filtered_ = filtered.snapshot();
      report_.filtered_again += static_cast<std::int64_t>(affected.size());
      due_.insert(affected.begin(), affected.end());
    }
    due_.insert(unfiltered_.begin(), unfiltered_.end());
    return {};
  }

  engine::Result<engine::Version> merged(const engine::Version& now) {
    engine::LiveField out(now, engine::Growth::kAllowed);
    for (const TileSpot& spot : due_) {
      // A tile filtered in an earlier round and edited since keeps the edit.
      const bool mine = first_ || unfiltered_.contains(spot) || tileOf(now, spot) == tileOf(felt_, spot);
      if (mine && !putTile(out, filtered_, spot)) return noMemory();
    }
    return out.snapshot();
  }

  AdoptionPort& port_;
  const engine::Version original_;
  const engine::FilterSpec spec_;
  engine::JobControl& job_;
  engine::Version raw_;       // the filter's input, with the edits known so far
  engine::Version filtered_;  // the filter of raw_, in all tiles that are needed
  engine::Version felt_;      // the live field right after the last adoption
  Spots due_;                 // tiles whose live content should become filtered_'s
  Spots unfiltered_;          // tiles whose live content is raw, after the first adoption
  bool first_ = true;         // nothing adopted yet: all is raw
  AdoptionReport report_;
};

}  // namespace

engine::Result<engine::Version> filterTiles(const engine::Version& input, const engine::Version& original,
                                            const engine::FilterSpec& spec,
                                            const std::vector<TileSpot>& spots, engine::JobControl& job) {
  const std::int32_t reach = engine::reachOf(spec, input);
  const std::int32_t aligned = engine::pieceGridOf(spec, input.grid());
  const engine::Grid& grid = input.grid();
  engine::LiveField out(input, engine::Growth::kAllowed);
  std::vector<float> heights(engine::kTileSamples);
  if (reach >= std::max(grid.width, grid.height) && spots.size() > 1) {
    // Each tile would be the whole field's work.
    const engine::Result<engine::Filtered> whole = engine::applyFilter(input, original, spec, job);
    if (!whole) return tl::unexpected(whole.error());
    for (const TileSpot& spot : spots)
      if (!putTile(out, whole->field, spot)) return noMemory();
    return out.snapshot();
  }
  for (const TileSpot& spot : spots) {
    const std::int32_t tile_c = spot.column * kTileSide;
    const std::int32_t tile_r = spot.row * kTileSide;
    const std::int32_t tile_columns = std::min(kTileSide, grid.width - tile_c);
    const std::int32_t tile_rows = std::min(kTileSide, grid.height - tile_r);
    // Where a piece begins the filter's grid does, as in the whole field.
    const std::int32_t c0 = std::max(tile_c - reach, 0) / aligned * aligned;
    const std::int32_t r0 = std::max(tile_r - reach, 0) / aligned * aligned;
    const std::int32_t columns = std::min(tile_c + tile_columns + reach, grid.width) - c0;
    const std::int32_t rows = std::min(tile_r + tile_rows + reach, grid.height) - r0;
    const engine::Version part = engine::pieceOf(input, c0, r0, columns, rows);
    // The original is only read where max_change is measured against it.
    const engine::Version part_original =
        spec.max_change
            ? engine::pieceOf(
                  input.reader().sign() == original.reader().sign() ? original : original.inverted(), c0, r0,
                  columns, rows)
            : part;
    const engine::Result<engine::Filtered> done = engine::applyFilter(part, part_original, spec, job);
    if (!done) return tl::unexpected(done.error());
    done->field.reader().readHeights(tile_c - c0, tile_r - r0, tile_columns, tile_rows, heights.data(),
                                     kTileSide);
    if (!out.writeHeights(tile_c, tile_r, tile_columns, tile_rows, heights.data(), kTileSide))
      return noMemory();
  }
  return out.snapshot();
}

engine::Result<AdoptionReport> adoptFiltered(AdoptionPort& port, const engine::Version& base,
                                             const engine::Version& result, const engine::Version& original,
                                             const engine::FilterSpec& spec, int most_rounds,
                                             engine::JobControl& job) {
  return Adoption(port, base, result, original, spec, job).run(most_rounds);
}

}  // namespace fettle::haptic
