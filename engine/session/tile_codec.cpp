#include "engine/session/tile_codec.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <new>

#include <zstd.h>

namespace fettle::engine {

static_assert(std::endian::native == std::endian::little, "marks are stored as in memory");

namespace {

constexpr int kLevel = 1;
constexpr std::size_t kWhole = TileCodec::kSampleBytes + TileCodec::kMarkBytes;
constexpr std::uint32_t kSign = 0x80000000U;

constexpr std::uint32_t ordered(std::uint32_t bits) noexcept {
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}
constexpr std::uint32_t unordered(std::uint32_t number) noexcept {
  return (number & kSign) != 0 ? number & ~kSign : ~number;
}
constexpr std::uint32_t folded(std::uint32_t difference) noexcept {
  return difference << 1 ^ ((difference & kSign) != 0 ? ~0U : 0U);
}
constexpr std::uint32_t unfolded(std::uint32_t word) noexcept {
  return word >> 1 ^ ((word & 1U) != 0 ? ~0U : 0U);
}

}  // namespace

struct TileCodec::Contexts {
  Contexts() : pack(ZSTD_createCCtx()), unpack(ZSTD_createDCtx()) {
    if (pack == nullptr || unpack == nullptr) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(pack, ZSTD_c_compressionLevel, kLevel);
  }
  ~Contexts() {
    ZSTD_freeCCtx(pack);
    ZSTD_freeDCtx(unpack);
  }
  Contexts& operator=(Contexts&&) = delete;

  ZSTD_CCtx* pack;
  ZSTD_DCtx* unpack;
  std::array<std::uint32_t, kTileSamples> words{};
  std::array<std::uint8_t, kWhole> planes{};
};

TileCodec::TileCodec() : contexts_(std::make_unique<Contexts>()) {}
TileCodec::~TileCodec() = default;
TileCodec::TileCodec(TileCodec&&) noexcept = default;

void TileCodec::encode(const Tile& tile, std::string& out) {
  Contexts& c = *contexts_;
  for (std::size_t i = 0; i < kTileSamples; ++i)
    c.words[i] = ordered(std::bit_cast<std::uint32_t>(tile.samples[i]));
  std::uint32_t below = 0;
  for (std::size_t r = 0; r < kTileSide; ++r) {
    std::uint32_t left = below;
    below = c.words[r * kTileSide];
    for (std::size_t i = r * kTileSide; i < (r + 1) * kTileSide; ++i) {
      const std::uint32_t number = c.words[i];
      c.words[i] = folded(number - left);
      left = number;
    }
  }
  for (std::size_t plane = 0; plane < 4; ++plane)
    for (std::size_t i = 0; i < kTileSamples; ++i)
      c.planes[plane * kTileSamples + i] = static_cast<std::uint8_t>(c.words[i] >> (24 - 8 * plane));

  bool marked = false;
  for (const std::uint64_t row : tile.marks) marked = marked || row != 0;
  if (marked) std::memcpy(c.planes.data() + kSampleBytes, tile.marks.data(), kMarkBytes);
  const std::size_t size = marked ? kWhole : kSampleBytes;

  out.resize(ZSTD_compressBound(kWhole) + 64);  // flushing between planes takes a few bytes each
  ZSTD_CCtx_reset(c.pack, ZSTD_reset_session_only);
  ZSTD_CCtx_setPledgedSrcSize(c.pack, size);
  ZSTD_outBuffer to{out.data(), out.size(), 0};
  for (std::size_t begin = 0; begin < size; begin += kTileSamples) {
    const std::size_t end = begin + kTileSamples < size ? begin + kTileSamples : size;
    ZSTD_inBuffer from{c.planes.data() + begin, end - begin, 0};
    const std::size_t left =
        ZSTD_compressStream2(c.pack, &to, &from, end == size ? ZSTD_e_end : ZSTD_e_flush);
    if (ZSTD_isError(left) != 0 || left != 0) throw std::bad_alloc();  // nothing else can fail
  }
  out.resize(to.pos);
}

bool TileCodec::decode(std::span<const char> stored, Tile& tile) {
  Contexts& c = *contexts_;
  const std::size_t size =
      ZSTD_decompressDCtx(c.unpack, c.planes.data(), c.planes.size(), stored.data(), stored.size());
  if (size != kSampleBytes && size != kWhole) return false;  // an error code is larger than either
  for (std::size_t i = 0; i < kTileSamples; ++i)
    c.words[i] = unfolded(static_cast<std::uint32_t>(c.planes[i]) << 24 |
                          static_cast<std::uint32_t>(c.planes[kTileSamples + i]) << 16 |
                          static_cast<std::uint32_t>(c.planes[2 * kTileSamples + i]) << 8 |
                          static_cast<std::uint32_t>(c.planes[3 * kTileSamples + i]));
  std::uint32_t below = 0;
  for (std::size_t r = 0; r < kTileSide; ++r) {
    std::uint32_t left = below;
    for (std::size_t i = r * kTileSide; i < (r + 1) * kTileSide; ++i) {
      left += c.words[i];
      tile.samples[i] = std::bit_cast<float>(unordered(left));
      if (i == r * kTileSide) below = left;
    }
  }
  if (size == kWhole)
    std::memcpy(tile.marks.data(), c.planes.data() + kSampleBytes, kMarkBytes);
  else
    tile.marks.fill(0);
  return true;
}

bool sameBits(const Tile& a, const Tile& b) noexcept {
  return std::memcmp(a.samples.data(), b.samples.data(), TileCodec::kSampleBytes) == 0 && a.marks == b.marks;
}

}  // namespace fettle::engine
