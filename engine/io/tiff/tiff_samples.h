#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/base/job.h"
#include "engine/io/tiff/block_unpacker.h"
#include "engine/io/tiff/tiff_scan.h"

namespace fettle::engine {

/// A rectangle of a TIFF's first band, rows counted from the top of the file.
struct TiffWindow {
  std::int32_t column = 0, row = 0, columns = 0, rows = 0;
};

/// The samples of such a rectangle, valid during the call that gets them.
struct TiffPiece {
  TiffWindow window;
  const void* numbers = nullptr;       ///< of the band's type, row-major
  std::int32_t stride = 0;             ///< numbers from one row to the next
  const std::uint8_t* mask = nullptr;  ///< window.columns per row, 0: hole; null: the file has no mask
};

/// Reads the samples of a band, each block of the file decompressed once, on all cores.
///
/// Blocks in the number format of this machine are read without GDAL, directly from the file: GDAL copies
/// them through its cache, which costs more than everything else. Blocks compressed as Fettle does, and most
/// other Deflate, are read without it too (block_unpacker.h). Other compressed blocks are decompressed by
/// GDAL, each core with a handle of its own, because one handle that decompresses on many threads still
/// copies on one. Blocks that must be read in order, or are very large, are read by rows through one handle.
class TiffSamples {
 public:
  /// How blocks are read; depends on the file.
  enum class ReadStrategy : std::uint8_t {
    kPlain,   ///< without GDAL
    kBlocks,  ///< decompressed, whole blocks in any order
    kRows,    ///< by GDAL, strips of rows in order
  };
  /// Called by several threads at once, each with another window.
  using Take = std::function<void(const TiffPiece&)>;

  /// `file` and `scan` outlive this.
  TiffSamples(const InputFile& file, const TiffScan& scan);
  /// Of rows [first, end) of the file alone, counted from its top: readAll() then gives these and others of their blocks.
  TiffSamples(const InputFile& file, const TiffScan& scan, std::int32_t first_row, std::int32_t end_row);

  /// Passes every sample of the band to `take`. Errors (kInput): the samples cannot be read; kCancelled.
  /// Counts windows in `job`. Memory: at most 8 MB per core for 16 cores, and GDAL's 64 MB.
  [[nodiscard]] Status readAll(JobControl& job, const Take& take);
  /// Passes every `step`-th row to `take`, from the first on, in pieces of one row. Otherwise as readAll.
  [[nodiscard]] Status readEvery(std::int32_t step, JobControl& job, const Take& take);
  /// How many samples readEvery decompresses; of uncompressed ones it reads those of its rows.
  [[nodiscard]] std::int64_t costOfEvery(std::int32_t step) const noexcept;

  [[nodiscard]] std::int32_t blockRows() const noexcept { return block_rows_; }
  /// Estimate of the memory that reading takes in addition to the field [bytes], from the header.
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
  std::int32_t first_row_ = 0, end_row_ = 0;
  std::int32_t across_ = 0, down_ = 0;  // blocks
  std::size_t number_bytes_ = 0;
  ReadStrategy strategy_ = ReadStrategy::kRows;
  // Of each block, row-major: of uncompressed ones, and of those decompressed without GDAL; else empty. 0 of those outside
  // the rows.
  std::vector<std::uint64_t> offsets_, sizes_;
};

/// The drivers and options for opening TIFFs. `threads`: GDAL decompresses on threads of its own.
[[nodiscard]] DatasetPtr openTiffForReading(const InputFile& file, bool threads);

}  // namespace fettle::engine
