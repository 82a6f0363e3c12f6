#include "engine/io/tiff/block_packer.h"

#include <array>
#include <bit>
#include <limits>

#include <isa-l/igzip_lib.h>
#include <zstd.h>

namespace fettle::engine {

namespace {

constexpr int kLevel = 2;
constexpr int kZstdLevel = 1;

// `scratch` and `out`: 4 bytes per column. Two passes without a branch, so that both use vector instructions.
void predictRow(const float* samples, std::size_t columns, std::uint8_t* scratch, std::uint8_t* out) {
  for (std::size_t plane = 0; plane < 4; ++plane) {
    const std::size_t shift = 24 - 8 * plane;
    std::uint8_t* to = scratch + plane * columns;
    for (std::size_t i = 0; i < columns; ++i)
      to[i] = static_cast<std::uint8_t>(std::bit_cast<std::uint32_t>(samples[i]) >> shift);
  }
  out[0] = scratch[0];
  for (std::size_t i = 1; i < 4 * columns; ++i)
    out[i] = static_cast<std::uint8_t>(scratch[i] - scratch[i - 1]);
}

}  // namespace

struct BlockPacker::State {
  struct FreeZstd {
    void operator()(ZSTD_CCtx* context) const noexcept { ZSTD_freeCCtx(context); }
  };

  Stream kind = Stream::kDeflate;
  std::size_t packed_bytes = 0;
  isal_zstream zlib{};
  std::array<std::uint8_t, ISAL_DEF_LVL2_DEFAULT> level{};
  std::unique_ptr<ZSTD_CCtx, FreeZstd> zstd;
};

BlockPacker::BlockPacker(Stream stream) : state_(std::make_unique<State>()) {
  state_->kind = stream;
}
BlockPacker::~BlockPacker() = default;
BlockPacker::BlockPacker(BlockPacker&&) noexcept = default;
BlockPacker& BlockPacker::operator=(BlockPacker&&) noexcept = default;

std::span<const std::uint8_t> BlockPacker::pack(std::span<const float> samples, std::size_t columns) {
  const std::size_t bytes = samples.size_bytes();
  if (columns == 0 || bytes > std::numeric_limits<std::uint32_t>::max() / 2) return {};
  row_.resize(4 * columns);
  differences_.resize(bytes);
  for (std::size_t at = 0; at < samples.size(); at += columns)
    predictRow(samples.data() + at, columns, row_.data(), differences_.data() + 4 * at);
  const bool done = state_->kind == Stream::kDeflate ? deflate() : zstandard();
  if (!done) return {};
  return {packed_.data(), state_->packed_bytes};
}

bool BlockPacker::deflate() {
  // Incompressible data is stored, with a few bytes for every 64 KB.
  packed_.resize(differences_.size() + differences_.size() / 8 + 4096);
  isal_zstream& z = state_->zlib;
  isal_deflate_init(&z);
  z.level = kLevel;
  z.level_buf = state_->level.data();
  z.level_buf_size = static_cast<std::uint32_t>(state_->level.size());
  z.gzip_flag = IGZIP_ZLIB;
  z.end_of_stream = 1;
  z.flush = NO_FLUSH;
  z.next_in = differences_.data();
  z.avail_in = static_cast<std::uint32_t>(differences_.size());
  z.next_out = packed_.data();
  z.avail_out = static_cast<std::uint32_t>(packed_.size());
  if (isal_deflate(&z) != COMP_OK || z.internal_state.state != ZSTATE_END) return false;
  state_->packed_bytes = z.total_out;
  return true;
}

bool BlockPacker::zstandard() {
  if (!state_->zstd) state_->zstd.reset(ZSTD_createCCtx());
  if (!state_->zstd) return false;
  packed_.resize(ZSTD_compressBound(differences_.size()));
  const std::size_t bytes = ZSTD_compressCCtx(state_->zstd.get(), packed_.data(), packed_.size(),
                                              differences_.data(), differences_.size(), kZstdLevel);
  if (ZSTD_isError(bytes) != 0) return false;
  state_->packed_bytes = bytes;
  return true;
}

}  // namespace fettle::engine
