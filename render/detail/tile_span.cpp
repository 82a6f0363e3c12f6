#include "render/detail/tile_span.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace fettle::render {

TileSpan changedHeights(const engine::Tile& a, const engine::Tile& b) noexcept {
  constexpr std::size_t kSide = engine::kTileSide;
  constexpr int kBytes = sizeof(float);
  TileSpan span;
  for (std::size_t r = 0; r < kSide; ++r) {
    const auto x = std::as_bytes(std::span(a.samples).subspan(r * kSide, kSide));
    const auto y = std::as_bytes(std::span(b.samples).subspan(r * kSide, kSide));
    if (std::memcmp(x.data(), y.data(), x.size()) == 0) continue;  // most rows, and faster than a search
    const auto first = std::mismatch(x.begin(), x.end(), y.begin()).first - x.begin();
    const auto past = std::mismatch(x.rbegin(), x.rend(), y.rbegin()).first.base() - x.begin();
    const int row = static_cast<int>(r);
    span.join({static_cast<int>(first) / kBytes, row, static_cast<int>(past - 1) / kBytes, row});
  }
  return span;
}

TileSpan changedMarks(const engine::Tile& a, const engine::Tile& b) noexcept {
  TileSpan span;
  for (int r = 0; r < engine::kTileSide; ++r) {
    const std::uint64_t d = a.marks[static_cast<std::size_t>(r)] ^ b.marks[static_cast<std::size_t>(r)];
    if (d != 0) span.join({std::countr_zero(d), r, engine::kTileSide - 1 - std::countl_zero(d), r});
  }
  return span;
}

}  // namespace fettle::render
