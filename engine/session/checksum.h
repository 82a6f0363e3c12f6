#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/error.h"

namespace fettle::engine {

/// Checksum of one row of a session: XXH64 (Y. Collet, seed 0) over its columns in their order, an integer as
/// 8 bytes little-endian, a real as the 8 bytes of its binary64, a text or blob as its length (8 bytes) and
/// its bytes, a NULL as the length 2^64 - 1. Detects damage on the disk, not forgery.
class RowChecksum {
 public:
  RowChecksum& integer(std::int64_t value);
  RowChecksum& real(double value);
  RowChecksum& text(std::string_view value);
  RowChecksum& null();
  [[nodiscard]] std::int64_t value() const noexcept;

 private:
  std::string bytes_;
};

/// Size and XXH64 (seed 0) of a file's bytes, as printed by `xxh64sum`.
struct FileChecksum {
  std::uint64_t bytes = 0;
  std::uint64_t xxh64 = 0;
  friend bool operator==(const FileChecksum&, const FileChecksum&) = default;
};
/// Errors (kInput): the file cannot be read.
[[nodiscard]] Result<FileChecksum> fileChecksum(const std::string& path);

/// Detects, without reading it, whether the file at a path is still the same: another file put in its place
/// has another inode, one that was written to another size or time. Wrong only where these were preserved
/// deliberately.
struct FileStamp {
  std::uint64_t device = 0, inode = 0, bytes = 0;
  std::int64_t written_ns = 0;  ///< last modification, since 1970
  friend bool operator==(const FileStamp&, const FileStamp&) = default;
};
/// Stamp of the file at a path, links followed; empty where there is none.
[[nodiscard]] std::optional<FileStamp> fileStamp(const std::string& path);

}  // namespace fettle::engine
