// Copying into tiles and summing them up with wide vectors gives the bits of one sample after the other.
#include "engine/field/tile_fill.h"
#include "tests/support/no_data.h"

#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

// Heights with all that a comparison may take the wrong way: both zeros, NaN of both signs, infinities, denormals.
float hardHeight(std::mt19937& random) {
  const float special[] = {0.0F, -0.0F, kNan, -kNan, kInf, -kInf, 1e-42F, -1e-42F};
  const auto draw = static_cast<std::uint32_t>(random());
  return draw % 4 == 0 ? special[draw / 4 % 8] : std::ldexp(static_cast<float>(draw % 2001) - 1000.0F, -5);
}

TEST(TileFill, CopiesAnyRectangleAsOneSampleAfterTheOther) {
  std::mt19937 random(3);
  constexpr std::int32_t kStride = 150;
  std::vector<float> from(static_cast<std::size_t>(kStride * kTileSide));
  for (float& z : from) z = hardHeight(random);
  for (int round = 0; round < 300; ++round) {
    const auto columns = static_cast<std::int32_t>(1 + random() % kTileSide);
    const auto rows = static_cast<std::int32_t>(1 + random() % kTileSide);
    const auto first = static_cast<std::int32_t>(random() % static_cast<unsigned>(kStride - columns + 1));
    const auto place =
        static_cast<std::int32_t>(random() % static_cast<unsigned>(kTileSide - columns + 1)) +
        static_cast<std::int32_t>(random() % static_cast<unsigned>(kTileSide - rows + 1)) * kTileSide;
    std::vector<float> to(kTileSamples, 7.0F);
    std::vector<float> plain = to;
    std::int32_t infinite = 0;
    for (std::int32_t r = 0; r < rows; ++r)
      for (std::int32_t c = 0; c < columns; ++c) {
        const float z = from[static_cast<std::size_t>(r * kStride + first + c)];
        infinite += std::isinf(z) ? 1 : 0;
        plain[static_cast<std::size_t>(place + r * kTileSide + c)] = std::isfinite(z) ? z : kNan;
      }
    ASSERT_EQ(copyHeights(from.data() + first, kStride, to.data() + place, columns, rows), infinite);
    for (std::size_t i = 0; i < to.size(); ++i)
      ASSERT_EQ(std::bit_cast<std::uint32_t>(to[i]), std::bit_cast<std::uint32_t>(plain[i]))
          << columns << " x " << rows << " at " << place << ", sample " << i;
  }
}

TEST(TileFill, SumsATileUpAsOneSampleAfterTheOther) {
  std::mt19937 random(4);
  auto tile = std::make_unique<Tile>();
  for (int round = 0; round < 100; ++round) {
    std::uint32_t nan = 0;
    std::uint32_t marked = 0;
    for (float& z : tile->samples) {
      z = hardHeight(random);
      if (std::isinf(z) || round % 10 == 9) z = kNan;  // none is ever stored; and whole tiles of holes
      nan += std::isnan(z) ? 1 : 0;
    }
    for (std::uint64_t& row : tile->marks) {
      row = round % 3 == 0 ? 0 : std::uint64_t{random()} << 32 | random();
      for (int c = 0; c < kTileSide; ++c) marked += (row >> c & 1U) != 0 ? 1 : 0;
    }
    summariseTile(*tile);
    EXPECT_EQ(tile->nan_samples, nan);
    EXPECT_EQ(tile->marked_samples, marked);
    HeightBounds all{kInf, -kInf};
    for (int b = 0; b < kFanOut; ++b) {
      HeightBounds block{kInf, -kInf};
      for (int i = 0; i < kBlockSide * kBlockSide; ++i) {
        const int row = b / 8 * kBlockSide + i / kBlockSide;
        const float z =
            tile->samples[static_cast<std::size_t>(row * kTileSide + b % 8 * kBlockSide + i % kBlockSide)];
        if (z < block.min) block.min = z;
        if (z > block.max) block.max = z;
      }
      const HeightBounds found{tile->block_min[static_cast<std::size_t>(b)],
                               tile->block_max[static_cast<std::size_t>(b)]};
      EXPECT_EQ(found, block) << "block " << b;
      if (block.min < all.min) all.min = block.min;
      if (block.max > all.max) all.max = block.max;
    }
    EXPECT_EQ(tile->bounds, all);
    // The same bits, zeros of either sign included, as an edit's bounds.
    const Tile summed = *tile;
    refreshBounds(*tile, 0, 0, kTileSide, kTileSide);
    for (std::size_t b = 0; b < kFanOut; ++b) {
      EXPECT_EQ(std::bit_cast<std::uint32_t>(summed.block_min[b]),
                std::bit_cast<std::uint32_t>(tile->block_min[b]));
      EXPECT_EQ(std::bit_cast<std::uint32_t>(summed.block_max[b]),
                std::bit_cast<std::uint32_t>(tile->block_max[b]));
    }
  }
}

}  // namespace
}  // namespace fettle::engine
