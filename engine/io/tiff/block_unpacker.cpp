#include "engine/io/tiff/block_unpacker.h"

#include <algorithm>
#include <cstring>

#include <isa-l/igzip_lib.h>

namespace fettle::engine {

namespace {

// Read first, for the case that few rows are requested; then per step.
constexpr std::uint64_t kFirst = std::uint64_t{32} << 10;
constexpr std::uint64_t kNext = std::uint64_t{256} << 10;

template <class T>
void addUp(char* row, std::size_t columns) {
  T sum = 0;
  for (std::size_t i = 0; i < columns; ++i) {
    T number;
    std::memcpy(&number, row + i * sizeof(T), sizeof(T));
    sum = static_cast<T>(sum + number);
    std::memcpy(row + i * sizeof(T), &sum, sizeof(T));
  }
}

// The bytes of a row are stored by their significance, the highest first, each as its difference to the one
// before. `scratch`: as many bytes.
template <std::size_t kBytes>
void addUpFloats(char* row, std::size_t columns, char* scratch) {
  std::uint8_t sum = 0;
  for (std::size_t i = 0; i < columns * kBytes; ++i) {
    sum = static_cast<std::uint8_t>(sum + static_cast<std::uint8_t>(row[i]));
    scratch[i] = static_cast<char>(sum);
  }
  for (std::size_t i = 0; i < columns; ++i)
    for (std::size_t b = 0; b < kBytes; ++b) row[i * kBytes + b] = scratch[(kBytes - 1 - b) * columns + i];
}

}  // namespace

struct BlockUnpacker::Stream {
  inflate_state zlib{};
};

BlockUnpacker::BlockUnpacker() : stream_(std::make_unique<Stream>()) {}
BlockUnpacker::~BlockUnpacker() = default;
BlockUnpacker::BlockUnpacker(BlockUnpacker&&) noexcept = default;
BlockUnpacker& BlockUnpacker::operator=(BlockUnpacker&&) noexcept = default;

bool BlockUnpacker::unpack(const InputFile& file, const PackedBlock& block, std::size_t rows,
                           std::vector<char>& out) {
  const std::size_t row_bytes = block.columns * block.number_bytes;
  const std::size_t bytes = rows * row_bytes;
  if (out.size() <= bytes) out.resize(bytes + 1);
  inflate_state& z = stream_->zlib;
  isal_inflate_init(&z);
  z.crc_flag = ISAL_ZLIB;
  z.next_out = reinterpret_cast<std::uint8_t*>(out.data());
  // One more, so that a block that ends correctly reaches its checksum.
  z.avail_out = static_cast<std::uint32_t>(bytes + 1);
  for (std::uint64_t at = 0; z.avail_out > 0 && z.block_state != ISAL_BLOCK_FINISH;) {
    const auto wanted = static_cast<std::size_t>(std::min(at == 0 ? kFirst : kNext, block.bytes - at));
    if (wanted == 0) break;
    if (packed_.size() < wanted) packed_.resize(wanted);
    const auto got = file.read(block.offset + at, packed_.data(), wanted);
    if (!got || *got != wanted) return false;
    at += wanted;
    z.next_in = reinterpret_cast<std::uint8_t*>(packed_.data());
    z.avail_in = static_cast<std::uint32_t>(wanted);
    const int state = isal_inflate(&z);
    if (state != ISAL_DECOMP_OK && state != ISAL_END_INPUT && state != ISAL_OUT_OVERFLOW) return false;
  }
  if (z.total_out < bytes) return false;
  row_.resize(row_bytes);
  for (std::size_t r = 0; r < rows; ++r) {
    char* row = out.data() + r * row_bytes;
    if (block.predictor == 3) {
      if (block.number_bytes == 4) addUpFloats<4>(row, block.columns, row_.data());
      if (block.number_bytes == 8) addUpFloats<8>(row, block.columns, row_.data());
    } else if (block.predictor == 2) {
      if (block.number_bytes == 1) addUp<std::uint8_t>(row, block.columns);
      if (block.number_bytes == 2) addUp<std::uint16_t>(row, block.columns);
      if (block.number_bytes == 4) addUp<std::uint32_t>(row, block.columns);
      if (block.number_bytes == 8) addUp<std::uint64_t>(row, block.columns);
    }
  }
  return true;
}

}  // namespace fettle::engine
