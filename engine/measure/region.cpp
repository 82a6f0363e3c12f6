#include "engine/measure/region.h"

#include <cassert>
#include <limits>

namespace fettle::engine {

namespace {

constexpr std::string_view kRegionWords[] = {"all", "marked", "unmarked"};

}  // namespace

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
