#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/job.h"
#include "engine/io/tiff/block_unpacker.h"
#include "engine/io/tiff/tiff_scan.h"

namespace fettle::engine {

/// A rectangle of a TIFF's first band, rows counted from the top of the file.
struct TiffWindow {
  std::int32_t column = 0, row = 0, columns = 0, rows = 0;
};

/// The samples of such a rectangle, there as long as the call they are given to.
struct TiffPiece {
  TiffWindow window;
  const void* numbers = nullptr;       ///< of the band's type, row-major
  std::int32_t stride = 0;             ///< numbers from one row to the next
  const std::uint8_t* mask = nullptr;  ///< window.columns a row, 0: hole; null: the file has no mask
};

/// Brings the samples of a band in, each block of the file unpacked once, on all cores.
///
/// Blocks that hold the numbers as this machine does are read past GDAL, straight from the file into place:
/// GDAL hands them through its cache, which costs more than all the rest. Blocks packed as Fettle packs them,
/// and most other Deflate, go past it too (block_unpacker.h). Other packed blocks are unpacked by GDAL, each
/// core with a handle of its own, because one handle that unpacks on many threads still copies on one.
/// Blocks that must be read in order, or are very large, go through one handle by rows.
class TiffSamples {
 public:
  /// How blocks come in; chosen by the file.
  enum class Way : std::uint8_t {
    kPlain,   ///< past GDAL
    kBlocks,  ///< unpacked, whole blocks in any order
    kRows,    ///< by GDAL, strips of rows in order
  };
  /// Called by several threads at once, each with another window.
  using Take = std::function<void(const TiffPiece&)>;

  /// `file` and `scan` outlive this.
  TiffSamples(const InputFile& file, const TiffScan& scan);

  /// Hands every sample of the band over. Errors (kInput): the samples cannot be read; kCancelled. Counts
  /// windows in `job`. Memory: at most 8 MB a core for 16 cores, and GDAL's 64 MB.
  [[nodiscard]] Status readAll(JobControl& job, const Take& take);
  /// Hands every `step`-th row over, from the first on, in pieces of one row. Else as readAll.
  [[nodiscard]] Status readEvery(std::int32_t step, JobControl& job, const Take& take);
  /// How many samples readEvery unpacks; of plain ones it reads those of its rows.
  [[nodiscard]] std::int64_t costOfEvery(std::int32_t step) const noexcept;

  [[nodiscard]] Way way() const noexcept { return way_; }
  [[nodiscard]] std::int32_t blockRows() const noexcept { return block_rows_; }
  /// About the memory that reading takes beside the field [bytes], as far as the header tells.
  [[nodiscard]] static std::uint64_t extraBytes(const TiffDirectory& directory) noexcept;

 private:
  struct Worker;
  using Read = std::function<Status(const TiffWindow&, Worker&)>;
  [[nodiscard]] bool findPlainBlocks();
  void findPackedBlocks();
  [[nodiscard]] bool findBlocks(bool plain);
  [[nodiscard]] std::size_t blockOf(const TiffWindow& window) const noexcept;
  [[nodiscard]] Status run(const std::vector<TiffWindow>& windows, JobControl& job, const Read& read);
  [[nodiscard]] Status readPlain(const TiffWindow& window, Worker& worker) const;
  [[nodiscard]] Status readBlock(const TiffWindow& window, Worker& worker) const;
  [[nodiscard]] Status unpackRows(const TiffWindow& window, std::int32_t rows, Worker& worker) const;
  [[nodiscard]] Status readRows(const TiffWindow& window, Worker& worker) const;
  [[nodiscard]] std::vector<TiffWindow> windows() const;

  const InputFile& file_;
  const TiffScan& scan_;
  std::int32_t width_ = 0, height_ = 0;
  int block_columns_ = 0, block_rows_ = 0;
  std::int32_t across_ = 0, down_ = 0;  // blocks
  std::size_t number_bytes_ = 0;
  Way way_ = Way::kRows;
  // Of each block, row-major: of plain ones, and of those that are unpacked past GDAL; else none.
  std::vector<std::uint64_t> offsets_, sizes_;
};

/// The drivers and options that TIFFs are opened with. `threads`: GDAL unpacks on threads of its own.
[[nodiscard]] DatasetPtr openTiffForReading(const InputFile& file, bool threads);

}  // namespace fettle::engine
