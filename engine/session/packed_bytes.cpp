#include "engine/session/packed_bytes.h"

#include <new>

#include <zstd.h>

namespace fettle::engine {

std::string packBytes(std::string_view bytes) {
  std::string packed;
  if (bytes.empty()) return packed;
  packed.resize(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3);
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the buffer is large enough: nothing else can fail
  packed.resize(size);
  return packed;
}

bool unpackBytes(std::string_view packed, std::string& bytes) {
  bytes.clear();
  if (packed.empty()) return true;
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN || size > (1ULL << 30)) return false;
  bytes.resize(static_cast<std::size_t>(size));
  return ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size()) == size;
}

}  // namespace fettle::engine
