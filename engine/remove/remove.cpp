#include "engine/remove/remove.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>

#include "engine/field/live_field.h"

namespace fettle::engine {

namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();
constexpr std::uint64_t kAllColumns = ~std::uint64_t{0};

// Samples of a tile, by rows.
struct ChosenSamples {
  std::uint64_t rows[kTileSide] = {};
  std::int64_t count = 0, spared = 0;
};

// The options for the samples of tiles, which are stored without the field's sign.
class RemoveChoice {
 public:
  explicit RemoveChoice(const RemoveOptions& options)
      : low_(options.low),
        high_(options.high),
        between_(options.heights == RemoveOptions::Heights::kBetween),
        region_(options.region) {}

  // Whether none of a tile's samples has such a height.
  [[nodiscard]] bool none(const HeightBounds& of) const {
    if (of.empty()) return true;
    return between_ ? of.max < low_ || of.min > high_ : of.min >= low_ && of.max <= high_;
  }

  [[nodiscard]] ChosenSamples of(const Tile& tile) const {
    ChosenSamples chosen;
    for (int r = 0; r < kTileSide; ++r) {
      std::uint64_t bits = 0;
      for (int c = 0; c < kTileSide; ++c)
        bits |= std::uint64_t{isChosen(tile.samples[static_cast<std::size_t>(r * kTileSide + c)])} << c;
      const std::uint64_t marks = tile.marks[static_cast<std::size_t>(r)];
      const std::uint64_t in = region_ == Region::kAll      ? kAllColumns
                               : region_ == Region::kMarked ? marks
                                                            : ~marks;
      chosen.rows[r] = bits & in;
      chosen.count += std::popcount(bits & in);
      if (region_ == Region::kUnmarked) chosen.spared += std::popcount(bits & marks);
    }
    return chosen;
  }

  [[nodiscard]] Region region() const noexcept { return region_; }

 private:
  // A hole is neither.
  [[nodiscard]] bool isChosen(float z) const {
    return between_ ? z >= low_ && z <= high_ : z < low_ || z > high_;
  }

  double low_, high_;
  bool between_;
  Region region_;
};

// Calls visit(tc, tr, tile, chosen) for the tiles in which samples are chosen, and counts all.
template <typename Visit>
Result<RemoveCounts> eachChosen(const Version& field, const RemoveOptions& options, const char* stage,
                                JobControl& job, const Visit& visit) {
  if (auto valid = validate(options); !valid) return tl::unexpected(valid.error());
  const FieldReader reader = field.reader();
  const RemoveChoice choice(reader.sign() > 0.0F ? options : upsideDown(options));
  RemoveCounts counts;
  job.begin(stage, static_cast<std::uint64_t>(reader.tileRows()));
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr) {
    if (job.cancelled()) return cancelled();
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc) {
      const FieldReader::TileEntry entry = reader.entry(tc, tr);
      counts.heights += entry.holed ? kTileSamples - static_cast<std::int64_t>(entry.tile->nan_samples)
                                    : std::int64_t{std::min(kTileSide, reader.width() - tc * kTileSide)} *
                                          std::min(kTileSide, reader.height() - tr * kTileSide);
      if (choice.none(entry.bounds) || (choice.region() == Region::kMarked && !entry.marked)) continue;
      const ChosenSamples chosen = choice.of(*entry.tile);
      counts.removed += chosen.count;
      counts.spared += chosen.spared;
      if (chosen.count > 0)
        if (auto visited = visit(tc, tr, *entry.tile, chosen); !visited)
          return tl::unexpected(visited.error());
    }
    job.advance();
  }
  return counts;
}

}  // namespace

Status validate(const RemoveOptions& options) {
  if (std::isnan(options.low) || std::isnan(options.high))
    return inputError("a limit of height is no number", "remove", "give a height, or none");
  if (options.low > options.high)
    return inputError("the lower limit of height is above the upper one", "remove", "swap them");
  return {};
}

Result<RemoveCounts> countRemoved(const Version& field, const RemoveOptions& options, JobControl& job) {
  return eachChosen(field, options, "counting samples", job,
                    [](std::int32_t, std::int32_t, const Tile&, const ChosenSamples&) { return Status(); });
}

Result<Removed> removeSamples(const Version& field, const RemoveOptions& options, JobControl& job) {
  LiveField live(field, Growth::kAllowed);
  const auto remove = [&](std::int32_t tc, std::int32_t tr, const Tile& tile,
                          const ChosenSamples& chosen) -> Status {
    const auto no_memory = [] {
      return failure("there is not enough memory for the field", "remove",
                     "keep the samples on a disk with --store FOLDER");
    };
    TileRef fresh = live.newTile();
    if (!fresh) return no_memory();
    *fresh = tile;
    for (int r = 0; r < kTileSide; ++r) {
      if (chosen.rows[r] == 0) continue;
      for (int c = 0; c < kTileSide; ++c)
        if ((chosen.rows[r] >> c & 1U) != 0)
          fresh->samples[static_cast<std::size_t>(r * kTileSide + c)] = kHole;
      fresh->marks[static_cast<std::size_t>(r)] &= ~chosen.rows[r];
    }
    fresh->nan_samples += static_cast<std::uint32_t>(chosen.count);
    refreshBounds(*fresh, 0, 0, kTileSide, kTileSide);
    refreshMarks(*fresh);
    if (!live.replaceTile(tc, tr, std::move(fresh))) return no_memory();
    return {};
  };
  auto counts = eachChosen(field, options, "removing samples", job, remove);
  if (!counts) return tl::unexpected(counts.error());
  if (counts->removed > 0 && counts->removed == counts->heights)
    return inputError("every sample would be removed", "remove",
                      "are the limits in the unit of the scan? fettle info shows its heights");
  return Removed{live.snapshot(), *counts};
}

}  // namespace fettle::engine
