#include "engine/session/tile_codec.h"

#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

std::unique_ptr<Tile> blankTile() {
  return std::make_unique<Tile>(Tile{});
}

void expectRoundTrip(const Tile& tile) {
  TileCodec codec;
  std::string stored;
  codec.encode(tile, stored);
  const auto back = blankTile();
  back->marks.fill(~std::uint64_t{0});  // what was there before must not show through
  ASSERT_TRUE(codec.decode(stored, *back));
  EXPECT_TRUE(sameBits(tile, *back));
}

TEST(TileCodec, EveryBitPatternComesBack) {
  // A pattern from each of 2^20 neighbourhoods of the 2^32, in steps that are no multiple of anything, so
  // that NaNs with payloads, infinities, denormals and both zeros stand next to one another.
  const auto tile = blankTile();
  std::uint32_t bits = 0;
  for (int k = 0; k < 256; ++k) {
    for (float& z : tile->samples) {
      z = std::bit_cast<float>(bits);
      bits += 4099 * (k % 7 + 1);
    }
    expectRoundTrip(*tile);
  }
}

TEST(TileCodec, SpecialPatternsComeBack) {
  const auto tile = blankTile();
  const std::uint32_t special[] = {0x00000000, 0x80000000, 0x7fc00000, 0xffc00001, 0x7f800001, 0x7fffffff,
                                   0xffffffff, 0x7f7fffff, 0xff7fffff, 0x00000001, 0x807fffff, 0x7f800000};
  for (std::size_t i = 0; i < tile->samples.size(); ++i)
    tile->samples[i] = std::bit_cast<float>(special[(i * 7 + i / 64) % std::size(special)]);
  expectRoundTrip(*tile);
  for (std::size_t r = 0; r < tile->marks.size(); ++r) tile->marks[r] = 0x9e3779b97f4a7c15ULL * (r + 1);
  expectRoundTrip(*tile);
  tile->marks.fill(0);
  tile->marks[63] = std::uint64_t{1} << 63;
  expectRoundTrip(*tile);
}

TEST(TileCodec, ASmoothSurfaceTakesAThirdAndAFlatOneNothing) {
  const auto tile = blankTile();
  TileCodec codec;
  std::string stored;
  for (std::size_t i = 0; i < tile->samples.size(); ++i)
    tile->samples[i] =
        std::sin(0.02F * static_cast<float>(i % 64)) + 0.01F * static_cast<float>(i / 64) + 2.0F;
  codec.encode(*tile, stored);
  EXPECT_LT(stored.size(), TileCodec::kSampleBytes / 2);
  tile->samples.fill(1234.5F);
  codec.encode(*tile, stored);
  EXPECT_LT(stored.size(), 100U);
}

TEST(TileCodec, WhatIsNoTileIsRefused) {
  const auto tile = blankTile();
  std::mt19937 random(1);
  for (float& z : tile->samples) z = static_cast<float>(random());
  tile->marks[5] = 77;
  TileCodec codec;
  std::string stored;
  codec.encode(*tile, stored);
  const auto back = blankTile();
  EXPECT_FALSE(codec.decode({}, *back));
  for (std::size_t size = 0; size < stored.size(); size += 101)
    EXPECT_FALSE(codec.decode(std::span(stored.data(), size), *back)) << size;
  EXPECT_FALSE(codec.decode(stored + "x", *back));
  // Any bytes at all: refused or decoded, never read or written past an end (for the sanitizers to see).
  for (int k = 0; k < 2000; ++k) {
    std::string bad = stored;
    bad[random() % bad.size()] ^= static_cast<char>(1U << (random() % 8));
    (void)codec.decode(bad, *back);
  }
}

}  // namespace
}  // namespace fettle::engine
