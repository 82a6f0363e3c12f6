#include "engine/io/packed_rows.h"

#include <algorithm>
#include <cstring>

#include <zlib.h>

namespace fettle::engine {

namespace {

// Ends a stream however the scope is left.
struct Inflating {
  z_stream stream{};
  bool ready = inflateInit(&stream) == Z_OK;
  Inflating() = default;
  Inflating(const Inflating&) = delete;
  Inflating& operator=(const Inflating&) = delete;
  ~Inflating() {
    if (ready) inflateEnd(&stream);
  }
};

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

// The bytes of a row lie by their rank, the highest first, each as its difference to the one before.
void addUpFloats(char* row, std::size_t columns, std::size_t number_bytes, std::vector<char>& scratch) {
  addUp<std::uint8_t>(row, columns * number_bytes);
  scratch.assign(row, row + columns * number_bytes);
  for (std::size_t b = 0; b < number_bytes; ++b)
    for (std::size_t i = 0; i < columns; ++i)
      row[i * number_bytes + b] = scratch[(number_bytes - 1 - b) * columns + i];
}

}  // namespace

bool unpackFirstRows(const InputFile& file, const PackedBlock& block, std::size_t rows,
                     std::vector<char>& out) {
  const std::size_t row_bytes = block.columns * block.number_bytes;
  out.resize(rows * row_bytes);
  Inflating inflating;
  if (!inflating.ready) return false;
  z_stream& z = inflating.stream;
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  std::vector<char> packed(std::min<std::uint64_t>(block.bytes, std::uint64_t{32} << 10));
  for (std::uint64_t at = 0; z.avail_out > 0;) {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(packed.size(), block.bytes - at));
    if (wanted == 0) return false;
    const auto got = file.read(block.offset + at, packed.data(), wanted);
    if (!got || *got != wanted) return false;
    at += wanted;
    z.next_in = reinterpret_cast<Bytef*>(packed.data());
    z.avail_in = static_cast<uInt>(wanted);
    const int state = inflate(&z, Z_NO_FLUSH);
    if (state == Z_STREAM_END) break;
    if (state != Z_OK && state != Z_BUF_ERROR) return false;
  }
  if (z.avail_out > 0) return false;
  std::vector<char> scratch;
  for (std::size_t r = 0; r < rows; ++r) {
    char* row = out.data() + r * row_bytes;
    if (block.predictor == 3) {
      addUpFloats(row, block.columns, block.number_bytes, scratch);
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
