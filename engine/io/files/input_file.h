#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "engine/base/error.h"

namespace fettle::engine {

/// A regular file open for reading. Read by pread, not mapped: a file that another program truncates during
/// reading gives an Error instead of ending the process.
/// Threading: read() may be called from several threads at once.
class InputFile {
 public:
  /// Errors (kInput): missing, not readable, a folder or device, empty.
  [[nodiscard]] static Result<InputFile> open(const std::string& path);

  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&&) = delete;
  ~InputFile();

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }  ///< bytes, > 0
  /// With the dot, lower case; empty if there is none.
  [[nodiscard]] std::string extension() const;
  /// The same file under a name that GDAL never interprets as a virtual file system.
  [[nodiscard]] std::string pathForGdal() const;

  /// Reads `bytes` bytes from `offset` on, fewer only at the end of the file.
  [[nodiscard]] Result<std::size_t> read(std::uint64_t offset, char* out, std::size_t bytes) const;

 private:
  InputFile(std::string path, std::uint64_t size, int descriptor);

  std::string path_;
  std::uint64_t size_ = 0;
  int descriptor_ = -1;
};

/// Lower case extension of a path, with the dot.
[[nodiscard]] std::string extensionOf(const std::string& path);

}  // namespace fettle::engine
