#include "engine/measure/region.h"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <string>

namespace fettle::engine {

namespace {

constexpr std::string_view kRegionWords[] = {"all", "marked", "unmarked"};

bool anyInTile(const Tile& tile, bool marked) noexcept {
  for (int r = 0; r < kTileSide; ++r)
    for (int c = 0; c < kTileSide; ++c)
      if (tile.marked(c, r) == marked &&
          !std::isnan(tile.samples[static_cast<std::size_t>(r * kTileSide + c)]))
        return true;
  return false;
}

}  // namespace

bool anyIn(const FieldReader& field, Region region) noexcept {
  if (region == Region::kAll) return !field.bounds().empty();
  const bool wanted = region == Region::kMarked;
  if (wanted && field.root().marked_children == 0) return false;
  for (std::int32_t tr = 0; tr < field.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < field.tileColumns(); ++tc) {
      const FieldReader::TileEntry entry = field.entry(tc, tr);
      if (entry.bounds.empty() || (wanted && !entry.marked)) continue;
      if (!entry.marked || anyInTile(*entry.tile, wanted)) return true;
    }
  return false;
}

tl::unexpected<Error> nothingIn(Region region, std::string_view where) {
  switch (region) {
    case Region::kMarked:
      return inputError("nothing is marked that has a height", std::string(where),
                        "mark samples, or take all of them");
    case Region::kUnmarked:
      return inputError("every sample with a height is marked", std::string(where),
                        "take marks away, or take all samples");
    default:
      return inputError("every sample is a hole", std::string(where), "give a scan that has heights");
  }
}

void readRegion(const FieldReader& field, Region region, const SampleRect& rect, float* out,
                std::ptrdiff_t stride) noexcept {
  constexpr int kMostSide = kTileSide + 1;
  assert(rect.columns <= kMostSide && rect.rows <= kMostSide);
  field.readHeights(rect.column, rect.row, rect.columns, rect.rows, out, stride);
  if (region == Region::kAll) return;
  std::uint8_t marks[kMostSide * kMostSide];
  field.readMarks(rect.column, rect.row, rect.columns, rect.rows, marks, kMostSide);
  const bool wanted = region == Region::kMarked;
  for (int r = 0; r < rect.rows; ++r)
    for (int c = 0; c < rect.columns; ++c)
      if ((marks[r * kMostSide + c] != 0) != wanted)
        out[r * stride + c] = std::numeric_limits<float>::quiet_NaN();
}

std::string_view wordOf(Region region) noexcept {
  return kRegionWords[static_cast<std::size_t>(region)];
}

std::optional<Region> regionNamed(std::string_view word) noexcept {
  for (std::size_t i = 0; i < std::size(kRegionWords); ++i)
    if (word == kRegionWords[i]) return static_cast<Region>(i);
  return std::nullopt;
}

}  // namespace fettle::engine
