#include "bench/holed_field.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "bench/repeats.h"
#include "engine/field/builder.h"

namespace fettle::bench {

std::uint32_t randomBits(std::int32_t c, std::int32_t r) noexcept {
  std::uint32_t h = static_cast<std::uint32_t>(c) * 0x9E3779B1U ^ static_cast<std::uint32_t>(r) * 0x85EBCA77U;
  h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
  h = (h ^ (h >> 12)) * 0x297A2D39U;
  return h ^ (h >> 15);
}

namespace {

constexpr HoleKind kHoleKinds[] = {
    {"single", [](std::int32_t c, std::int32_t r, std::int32_t) { return randomBits(c, r) % 20 == 0; }},
    {"discs",
     [](std::int32_t c, std::int32_t r, std::int32_t) {
       constexpr std::int32_t kCell = 32;
       const auto radius = static_cast<std::int32_t>(2 + randomBits(c / kCell, r / kCell) % 5);
       const std::int32_t x = c % kCell - kCell / 2, y = r % kCell - kCell / 2;
       return x * x + y * y <= radius * radius;
     }},
    {"scratches",
     [](std::int32_t c, std::int32_t r, std::int32_t side) {
       // Slanted by one in eight, 256 apart, with ends.
       return (r + c / 8) % 256 < 3 && c > 4 && c < side - 5 && r > 4 && r < side - 5;
     }},
    {"one large",
     [](std::int32_t c, std::int32_t r, std::int32_t side) {
       const std::int64_t x = c - side / 2, y = r - side / 2;
       return x * x + y * y <= 19100;  // times pi: 60,000
     }},
};

}  // namespace

std::span<const HoleKind> holeKinds() noexcept {
  return kHoleKinds;
}

engine::Result<engine::Version> holedField(std::int32_t side, const HoleKind& kind) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = grid.spacing_y = kSpacingMm;
  auto builder = engine::FieldBuilder::create(grid, "the field");
  if (!builder) return tl::unexpected(builder.error());
  std::vector<float> row(static_cast<std::size_t>(side));
  for (std::int32_t r = 0; r < side; ++r) {
    const double along = std::cos(r * 0.013);
    for (std::int32_t c = 0; c < side; ++c)
      row[static_cast<std::size_t>(c)] = kind.isHole(c, r, side)
                                             ? std::numeric_limits<float>::quiet_NaN()
                                             : static_cast<float>(std::sin(c * 0.01) + along);
    builder->writeHeights(0, r, side, 1, row.data(), side);
  }
  return std::move(*builder).build();
}

}  // namespace fettle::bench
