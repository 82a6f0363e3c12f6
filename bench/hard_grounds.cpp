#include "bench/hard_grounds.h"

#include <vector>

#include "engine/field/builder.h"

namespace fettle::bench {

namespace {

constexpr HardGround kGrounds[] = {
    {"needles",
     [](std::int32_t c, std::int32_t r) noexcept { return c % 7 == 3 && r % 5 == 2 ? 1e6F : 0.0F; }},
    {"twisted cells",
     [](std::int32_t c, std::int32_t r) noexcept { return (c + r) % 2 == 0 ? -0.25F : 0.25F; }},
    {"walls", [](std::int32_t c, std::int32_t) noexcept { return c / 8 % 2 == 0 ? 0.0F : 10.0F; }},
    {"pits",
     [](std::int32_t c, std::int32_t r) noexcept {
       return (c % 4 == 0 ? -50.0F : 0.0F) + (r % 3 == 0 ? -0.05F : 0.0F);
     }},
};

}  // namespace

std::span<const HardGround> hardGrounds() noexcept {
  return kGrounds;
}

engine::Version makeGround(const HardGround& ground, std::int32_t side, double spacing_mm) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = grid.spacing_y = spacing_mm;
  std::vector<float> z;
  z.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (std::int32_t r = 0; r < side; ++r)
    for (std::int32_t c = 0; c < side; ++c) z.push_back(ground.height(c, r));
  return engine::makeField(grid, z);
}

}  // namespace fettle::bench
