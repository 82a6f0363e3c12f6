// GeoTIFF float32, uncompressed or compressed without loss (ExportOptions::tiff_compression).
//
// GDAL writes the header, libtiff stores the blocks, which BlockPacker compresses on all cores. Deflate by
// GDAL only, whose libtiff compresses with libdeflate: 1,074 million samples took 38.5 s at level 6, and take
// 9.9 s now, two cores; a plain copy of the file, flushed, 10.9 s. In memory, without the disk, it was 29 and
// 58 million samples per second at levels 6 and 1, and is 180. The cost is the size of the file: 1 % on a
// noisy part, 4 % once it was smoothed, 5 % on a clean one, 9 % on a simulated scan.

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>
#include <tiffio.h>

#include "engine/io/files/atomic_file.h"
#include "engine/io/files/gdal_calls.h"
#include "engine/io/files/gdal_session.h"
#include "engine/io/format.h"
#include "engine/io/tiff/block_packer.h"
#include "engine/io/tiff/tiff_header.h"

namespace fettle::engine {

namespace {

struct CloseTiff {
  void operator()(TIFF* file) const noexcept { TIFFClose(file); }
};

// Compresses the blocks of a file, on all cores, and writes them in their order, so that the bytes do not
// depend on the number of threads.
class BlockWriter {
 public:
  BlockWriter(const Version& field, TiffCompression compression, const std::string& path, JobControl& job)
      : reader_(field.reader()),
        path_(path),
        job_(job),
        height_(field.grid().height),
        compression_(compression),
        blocks_(field.grid(), compression) {}

  Status write(TIFF* file) {
    const std::size_t blocks =
        static_cast<std::size_t>(blocks_.across) * static_cast<std::size_t>(blocks_.down);
    // One being written, one being compressed by each core, one ready for each: each takes 1 MB.
    const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    const auto stream =
        compression_ == TiffCompression::kZstd ? BlockPacker::Stream::kZstd : BlockPacker::Stream::kDeflate;
    for (std::size_t i = std::min({blocks, 2 * threads + 1, kMostSlots}); i > 0; --i)
      slots_.push_back({{}, BlockPacker(stream), {}});
    job_.begin("writing", static_cast<std::uint64_t>(height_));
    std::size_t next = 0;
    Status status;
    // Blocks between the first filter and the last are consecutive: as many slots separate them.
    tbb::parallel_pipeline(
        slots_.size(),
        tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order,
                                            [&](tbb::flow_control& flow) -> std::size_t {
                                              if (next < blocks && !failed_ && !job_.cancelled())
                                                return next++;
                                              flow.stop();
                                              return 0;
                                            }) &
            tbb::make_filter<std::size_t, std::size_t>(tbb::filter_mode::parallel,
                                                       [&](std::size_t block) {
                                                         pack(block);
                                                         return block;
                                                       }) &
            tbb::make_filter<std::size_t, void>(tbb::filter_mode::serial_in_order, [&](std::size_t block) {
              if (failed_) return;
              status = put(file, block);
              failed_ = !status;
            }));
    if (!status) return status;
    if (job_.cancelled()) return cancelled();
    return {};
  }

 private:
  static constexpr std::size_t kMostSlots = 64;
  static constexpr tmsize_t kFlush = tmsize_t{16} << 20;
  struct Slot {
    std::vector<float> heights;
    BlockPacker packer;
    std::span<const std::uint8_t> bytes;  // as they go into the file, or the input of libtiff's compression
  };

  [[nodiscard]] std::int32_t top(std::size_t block) const {
    return static_cast<std::int32_t>(block / static_cast<std::size_t>(blocks_.across)) * blocks_.rows;
  }
  [[nodiscard]] std::int32_t rows(std::size_t block) const {
    return std::min(blocks_.rows, height_ - top(block));
  }
  [[nodiscard]] bool packs() const {
    return compression_ == TiffCompression::kDeflate || compression_ == TiffCompression::kZstd;
  }

  void pack(std::size_t block) {
    Slot& slot = slots_[block % slots_.size()];
    // Tiles are complete at the borders too, strips end with the field. Samples outside are written as holes.
    const std::int32_t columns = blocks_.columns;
    const std::int32_t now = blocks_.tiled ? blocks_.rows : rows(block);
    slot.heights.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(now));
    const auto left = static_cast<std::int32_t>(block % static_cast<std::size_t>(blocks_.across)) * columns;
    // Read in reverse order: the first row of the file is the highest one of the field.
    reader_.readHeights(left, height_ - top(block) - now, columns, now,
                        slot.heights.data() + static_cast<std::ptrdiff_t>(now - 1) * columns, -columns);
    slot.bytes = packs() ? slot.packer.pack(slot.heights, static_cast<std::size_t>(columns))
                         : std::span(reinterpret_cast<const std::uint8_t*>(slot.heights.data()),
                                     slot.heights.size() * sizeof(float));
  }

  Status put(TIFF* file, std::size_t block) {
    const std::span<const std::uint8_t> from = slots_[block % slots_.size()].bytes;
    if (from.empty()) return failure("a block could not be packed", path_);
    const GdalSession messages;  // collects the messages of libtiff too
    const auto size = static_cast<tmsize_t>(from.size());
    auto* bytes = const_cast<std::uint8_t*>(from.data());
    const auto number = static_cast<std::uint32_t>(block);
    // LZW is libtiff's own, block after block: slower than the others on several cores.
    const tmsize_t wrote = compression_ == TiffCompression::kLzw
                               ? TIFFWriteEncodedStrip(file, number, bytes, size)
                           : blocks_.tiled ? TIFFWriteRawTile(file, number, bytes, size)
                                           : TIFFWriteRawStrip(file, number, bytes, size);
    if (wrote != size) return cannotWriteTiff(messages, path_);
    // Starts writing to the disk now, not only at the final flush. A hint: its failure has no effect.
    unflushed_ += wrote;
    if (unflushed_ >= kFlush) {
      (void)sync_file_range(TIFFFileno(file), 0, 0, SYNC_FILE_RANGE_WRITE);
      unflushed_ = 0;
    }
    if ((block + 1) % static_cast<std::size_t>(blocks_.across) == 0)
      job_.advance(static_cast<std::uint64_t>(rows(block)));
    return {};
  }

  const FieldReader reader_;
  const std::string& path_;
  JobControl& job_;
  const std::int32_t height_;
  const TiffCompression compression_;
  const TiffBlocks blocks_;
  std::vector<Slot> slots_;
  tmsize_t unflushed_ = 0;
  std::atomic<bool> failed_{false};
};

Status writePlain(const Version& field, TiffCompression compression, const std::string& temporary,
                  const std::string& path, JobControl& job) {
  if (Status status = writeTiffHeader(field.grid(), compression, temporary, path); !status) return status;
  const GdalSession session;
  const std::unique_ptr<TIFF, CloseTiff> file(TIFFOpen(temporary.c_str(), "r+"));
  if (!file) return cannotWriteTiff(session, path);
  if (Status status = BlockWriter(field, compression, path, job).write(file.get()); !status) return status;
  if (TIFFFlush(file.get()) != 1 || session.failed())
    return cannotWriteTiff(session, path);  // the positions of the blocks
  return {};
}

// The same samples in the order that suits a network, with overviews. Means: what lies between two samples of
// an overview contributes to it.
Status writeCloudOptimised(const std::string& from, const std::string& to, TiffCompression compression,
                           const GdalSession& session, const std::string& path, JobControl& job) {
  const std::array<const char*, 2> drivers{"GTiff", nullptr};
  const DatasetPtr source(
      gdal().GDALOpenEx(from.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers.data(), nullptr, nullptr));
  if (!source) return cannotWriteTiff(session, path);
  std::unique_ptr<char*, FreeCslList> creation;
  for (const auto& [key, value] :
       {std::pair{"COMPRESS", tiffCodingOf(compression).gdal},
        {"PREDICTOR", tiffCodingOf(compression).predictor != nullptr ? "FLOATING_POINT" : "NO"},
        {"BLOCKSIZE", "256"},
        {"OVERVIEWS", "IGNORE_EXISTING"},
        {"OVERVIEW_RESAMPLING", "AVERAGE"},
        {"BIGTIFF", "IF_SAFER"},
        {"NUM_THREADS", "ALL_CPUS"}})
    creation.reset(gdal().CSLSetNameValue(creation.release(), key, value));
  if (compression == TiffCompression::kDeflate)
    creation.reset(gdal().CSLSetNameValue(creation.release(), "LEVEL", "6"));
  job.begin("overviews", 100);
  struct ProgressTarget {
    JobControl& job;
    std::uint64_t percent = 0;
  } target{job};
  const auto progress = [](double done, const char*, void* self) {
    auto& at = *static_cast<ProgressTarget*>(self);
    const auto percent = static_cast<std::uint64_t>(done * 100.0);
    if (percent > at.percent) at.job.advance(percent - std::exchange(at.percent, percent));
    return at.job.cancelled() ? 0 : 1;
  };
  const DatasetPtr copy(gdal().GDALCreateCopy(gdal().GDALGetDriverByName("COG"), to.c_str(), source.get(),
                                              FALSE, creation.get(), progress, &target));
  if (job.cancelled()) return cancelled();
  if (!copy || session.failed()) return cannotWriteTiff(session, path);
  return {};
}

}  // namespace

// GeoTIFF, float32, compressed without loss if requested, geo-reference, CRS, units, holes = NaN, declared.
Result<Exported> writeTiff(const Version& field, const std::string& path, const ExportOptions& options,
                           JobControl& job) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  if (options.cloud_optimised) {
    // First a standard file next to the final one, never committed: removed at the end of this scope.
    Result<AtomicFile> plain = AtomicFile::create(path);
    if (!plain) return tl::unexpected(plain.error());
    const TiffCompression compression = options.tiff_compression.value_or(TiffCompression::kDeflate);
    if (Status status = writePlain(field, TiffCompression::kDeflate, plain->temporaryPath(), path, job);
        !status)
      return tl::unexpected(plain->explained(status.error()));
    const GdalSession session;
    if (Status status = writeCloudOptimised(plain->temporaryPath(), file->temporaryPath(), compression,
                                            session, path, job);
        !status)
      return tl::unexpected(file->explained(status.error()));
  } else if (Status status = writePlain(field, options.tiff_compression.value_or(TiffCompression::kNone),
                                        file->temporaryPath(), path, job);
             !status) {
    return tl::unexpected(file->explained(status.error()));
  }
  if (Status status = file->commit(); !status) return tl::unexpected(status.error());
  return Exported{"GTiff", {}};
}

}  // namespace fettle::engine
