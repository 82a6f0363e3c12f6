#include "render/residency/paging.h"

#include <bit>

#include "engine/field/tile.h"

namespace fettle::render {
namespace {

constexpr std::uint32_t kSide = engine::kTileSide;

std::uint32_t wholeTiles(std::uint32_t samples) {
  return (samples + kSide - 1) / kSide * kSide;
}

// Page side along one direction: all samples when they fit, otherwise a power of two.
std::uint32_t pageSide(std::uint32_t samples, std::uint32_t max_side) {
  std::uint32_t side = std::bit_floor(max_side);
  while (side > kSide) {
    const std::uint32_t pages = (samples + side - 1) / side;
    if (pages * side - samples <= samples / 8) break;
    side /= 2;
  }
  return side;
}

}  // namespace

Paging choosePaging(std::int32_t width, std::int32_t height, std::uint32_t max_side) {
  const auto w = static_cast<std::uint32_t>(width), h = static_cast<std::uint32_t>(height);
  max_side = max_side / kSide * kSide;
  Paging p;
  if (wholeTiles(w) <= max_side && wholeTiles(h) <= max_side) {
    p.columns = wholeTiles(w);
    p.rows = wholeTiles(h);
    return p;
  }
  p.columns = pageSide(w, max_side);
  p.rows = pageSide(h, max_side);
  // The short side of a long strip is one page, which may be larger than the strip by less than twice a tile.
  if (h <= p.rows) p.rows = std::bit_ceil(wholeTiles(h));
  if (w <= p.columns) p.columns = std::bit_ceil(wholeTiles(w));
  p.across = (w + p.columns - 1) / p.columns;
  p.up = (h + p.rows - 1) / p.rows;
  p.log2_columns = std::countr_zero(p.columns);
  p.log2_rows = std::countr_zero(p.rows);
  return p;
}

}  // namespace fettle::render
