#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "engine/base/error.h"
#include "engine/field/grid.h"

namespace fettle::engine {

/// Where the samples of an uncompressed TIFF of Fettle's lie: rows one after another, the highest row of the field first,
/// floats of this machine's byte order. Two processes may write different rows at once.
struct PlainLayout {
  std::int32_t width = 0, height = 0;
  std::uint64_t first_byte = 0;  ///< of the first sample
  std::uint64_t bytes = 0;       ///< of the whole file

  /// Of a row of the field, 0 the lowest.
  [[nodiscard]] std::uint64_t offsetOf(std::int32_t row) const noexcept {
    return first_byte + static_cast<std::uint64_t>(height - 1 - row) * rowBytes();
  }
  [[nodiscard]] std::uint64_t rowBytes() const noexcept {
    return static_cast<std::uint64_t>(width) * sizeof(float);
  }
};

/// The file that exporting a field of this grid without compression makes, bit by bit, but with samples of no value: they are
/// written later, by PlainRows. Its blocks on the disk are taken now where the file system can, so that a full disk is
/// known before anything is computed. A file of this path is replaced. Errors as exportField; nothing is left then.
[[nodiscard]] Result<PlainLayout> createPlainTiff(const Grid& grid, const std::string& path);

/// The layout of a file that createPlainTiff() made for a field of these sides. Errors: kInput, no such file
/// or another one; kFailed, the system does not open it (too many open files).
[[nodiscard]] Result<PlainLayout> layoutOfPlainTiff(const std::string& path, std::int32_t width,
                                                    std::int32_t height);

/// Writes rows of such a file. Threading: one thread at a time; other objects, in other processes on other machines too, may
/// write other rows meanwhile where the file system keeps bytes that do not overlap apart (keepsBytesApart).
class PlainRows {
 public:
  /// Errors: kInput, no such file, or it is not as long as the layout states; kFailed, the system does not open it.
  [[nodiscard]] static Result<PlainRows> open(const std::string& path, const PlainLayout& layout);
  PlainRows(PlainRows&& other) noexcept
      : path_(std::move(other.path_)),
        layout_(other.layout_),
        descriptor_(std::exchange(other.descriptor_, -1)) {}
  PlainRows& operator=(PlainRows&&) = delete;
  ~PlainRows();

  /// Rows row, row + 1 .. of the field, whole ones, row-major without gaps [height_unit]. Errors as writeError().
  [[nodiscard]] Status write(std::int32_t row, std::int32_t rows, const float* heights);
  /// The same samples back. Errors: kInput, the file ends before them; kFailed, the disk does not give them.
  [[nodiscard]] Status read(std::int32_t row, std::int32_t rows, float* heights) const;
  /// What was written is on the disk. Errors as writeError().
  [[nodiscard]] Status flush();

 private:
  PlainRows(std::string path, const PlainLayout& layout, int descriptor)
      : path_(std::move(path)), layout_(layout), descriptor_(descriptor) {}

  std::string path_;
  PlainLayout layout_;
  int descriptor_;
};

/// Whether processes on several machines may write bytes of one file that do not overlap: known of local file systems and of
/// those of clusters (Lustre, GPFS, BeeGFS, Ceph, OrangeFS). Not of NFS and SMB, whose clients write whole pages, nor of file systems
/// that this does not know.
[[nodiscard]] bool keepsBytesApart(const std::string& folder);

}  // namespace fettle::engine
