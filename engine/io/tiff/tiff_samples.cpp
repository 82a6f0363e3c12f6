#include "engine/io/tiff/tiff_samples.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cstring>
#include <mutex>
#include <utility>

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "engine/field/tile.h"
#include "engine/io/files/gdal_calls.h"

namespace fettle::engine {

namespace {

// Amount that a core processes per step.
constexpr std::uint64_t kWindowBytes = std::uint64_t{8} << 20;
constexpr int kMostThreads = 16;
// Opening the file again costs more than reading such a field [samples].
constexpr std::int64_t kSmall = std::int64_t{1} << 18;
// Rows of a window that is not a block.
constexpr std::int32_t kRows = kTileSide;

Status unreadable(const GdalSession& session, const std::string& path) {
  return inputError("the samples cannot be read: " + session.reason("the file is damaged"), path,
                    "the file is cut short or damaged");
}

std::optional<std::uint64_t> numberOf(GDALRasterBandH band, const char* what, int column, int row) {
  const std::string name = fmt::format("{}_{}_{}", what, column, row);
  const char* text = gdal().GDALGetMetadataItem(band, name.c_str(), "TIFF");
  if (text == nullptr) return std::nullopt;
  std::uint64_t number = 0;
  const char* end = text + std::strlen(text);
  if (std::from_chars(text, end, number).ptr != end) return std::nullopt;
  return number;
}

}  // namespace

DatasetPtr openTiffForReading(const InputFile& file, bool threads) {
  const std::array<const char*, 2> drivers{"GTiff", nullptr};
  const std::array<const char*, 3> options{"GEOREF_SOURCES=INTERNAL,WORLDFILE",
                                           threads ? "NUM_THREADS=ALL_CPUS" : nullptr, nullptr};
  return DatasetPtr(gdal().GDALOpenEx(file.pathForGdal().c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY,
                                      drivers.data(), options.data(), nullptr));
}

// State of one reading thread.
struct TiffSamples::Worker {
  DatasetPtr own;  // null: the scan's
  GDALRasterBandH band = nullptr;
  GDALRasterBandH band_mask = nullptr;
  std::vector<char> numbers;
  std::vector<std::uint8_t> mask;
  BlockUnpacker unpacker;
};

TiffSamples::TiffSamples(const InputFile& file, const TiffScan& scan)
    : TiffSamples(file, scan, 0, gdal().GDALGetRasterYSize(scan.dataset.get())) {}

TiffSamples::TiffSamples(const InputFile& file, const TiffScan& scan, std::int32_t first_row,
                         std::int32_t end_row)
    : file_(file),
      scan_(scan),
      width_(gdal().GDALGetRasterXSize(scan.dataset.get())),
      height_(gdal().GDALGetRasterYSize(scan.dataset.get())),
      first_row_(first_row),
      end_row_(end_row),
      number_bytes_(static_cast<std::size_t>(gdal().GDALGetDataTypeSizeBytes(scan.type))) {
  gdal().GDALGetBlockSize(scan.band, &block_columns_, &block_rows_);
  across_ = (width_ + block_columns_ - 1) / block_columns_;
  down_ = (height_ + block_rows_ - 1) / block_rows_;
  const std::uint64_t block_bytes = static_cast<std::uint64_t>(block_columns_) *
                                    static_cast<std::uint64_t>(block_rows_) * number_bytes_ *
                                    scan.directory.samples_per_pixel;
  if (findPlainBlocks()) {
    strategy_ = ReadStrategy::kPlain;
  } else if (block_rows_ > 1 && block_bytes <= kWindowBytes) {
    // Of one row, a block may be part of a strip that GDAL decompresses row by row, each after the one
    // before.
    strategy_ = ReadStrategy::kBlocks;
    findPackedBlocks();
  }
}

std::uint64_t TiffSamples::extraBytes(const TiffDirectory& directory) noexcept {
  const auto threads =
      static_cast<std::uint64_t>(std::min(kMostThreads, tbb::this_task_arena::max_concurrency()));
  return std::min(directory.rawBytes(), threads * kWindowBytes);
}

// Finds the position of each block; false when GDAL does not report one, or one lies outside the file.
bool TiffSamples::findBlocks(bool plain) {
  const bool strips = block_columns_ == width_;
  offsets_.clear();
  sizes_.clear();
  for (int r = 0; r < down_; ++r)
    for (int c = 0; c < across_; ++c) {
      if ((r + 1) * block_rows_ <= first_row_ || r * block_rows_ >= end_row_) {
        offsets_.push_back(0);
        sizes_.push_back(0);
        continue;
      }
      const auto offset = numberOf(scan_.band, "BLOCK_OFFSET", c, r);
      const auto bytes = numberOf(scan_.band, "BLOCK_SIZE", c, r);
      const int rows = strips ? std::min(block_rows_, height_ - r * block_rows_) : block_rows_;
      const std::uint64_t raw =
          static_cast<std::uint64_t>(block_columns_) * static_cast<std::uint64_t>(rows) * number_bytes_;
      // A larger uncompressed one is a strip of which GDAL makes blocks of its own.
      const bool known = offset && bytes && *offset > 0 && *bytes > 0 && (!plain || *bytes == raw);
      if (!known || *offset > file_.size() || *bytes > file_.size() - *offset) {
        offsets_.clear();
        sizes_.clear();
        return false;
      }
      offsets_.push_back(*offset);
      sizes_.push_back(*bytes);
    }
  return true;
}

// Whether every block is stored in the file as in memory.
bool TiffSamples::findPlainBlocks() {
  const TiffDirectory& d = scan_.directory;
  return d.little_endian && d.compression == 1 && d.samples_per_pixel == 1 && d.bits == 8 * number_bytes_ &&
         scan_.mask == nullptr && findBlocks(true);
}

void TiffSamples::findPackedBlocks() {
  const TiffDirectory& d = scan_.directory;
  const bool deflate = d.compression == 8 || d.compression == 32946;
  const bool undone = d.predictor == 1 || d.predictor == 2 ||
                      (d.predictor == 3 && (scan_.type == GDT_Float32 || scan_.type == GDT_Float64));
  if (d.little_endian && deflate && undone && d.samples_per_pixel == 1 && d.bits == 8 * number_bytes_ &&
      scan_.mask == nullptr)
    (void)findBlocks(false);
}

std::size_t TiffSamples::blockOf(const TiffWindow& window) const noexcept {
  return static_cast<std::size_t>(window.row / block_rows_) * static_cast<std::size_t>(across_) +
         static_cast<std::size_t>(window.column / block_columns_);
}

std::vector<TiffWindow> TiffSamples::windows() const {
  const bool tiles = block_columns_ < width_;
  const bool blocks = strategy_ == ReadStrategy::kBlocks || (strategy_ == ReadStrategy::kPlain && tiles);
  const std::int32_t columns = blocks ? block_columns_ : width_;
  std::int32_t rows = blocks ? block_rows_ : kRows;
  while (strategy_ != ReadStrategy::kBlocks && rows > 1 &&
         static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows) * number_bytes_ >
             kWindowBytes)
    rows = (rows + 1) / 2;
  std::vector<TiffWindow> all;
  for (std::int32_t row = blocks ? first_row_ / block_rows_ * block_rows_ : first_row_; row < end_row_;) {
    // Parts of a block end with the block; uncompressed ones so that the field's tiles are complete.
    const std::int32_t limit = blocks ? (row / block_rows_ + 1) * block_rows_
                               : strategy_ == ReadStrategy::kPlain && scan_.top_down
                                   ? height_ - (height_ - row - 1) / rows * rows
                                   : height_;
    const std::int32_t end = std::min({row + rows, limit, blocks ? height_ : end_row_});
    for (std::int32_t column = 0; column < width_; column += columns)
      all.push_back({column, row, std::min(columns, width_ - column), end - row});
    row = end;
  }
  return all;
}

// Reads rows of whole blocks.
Status TiffSamples::readPlain(const TiffWindow& window, Worker& worker) const {
  const std::size_t row_bytes = static_cast<std::size_t>(block_columns_) * number_bytes_;
  worker.numbers.resize(row_bytes * static_cast<std::size_t>(window.rows));
  const auto offsetOf = [&](std::int32_t row) {
    return offsets_[blockOf({window.column, row, 0, 0})] +
           row_bytes * static_cast<std::size_t>(row % block_rows_);
  };
  const std::int32_t end = window.row + window.rows;
  for (std::int32_t row = window.row; row < end;) {
    // As many as are consecutive in the file.
    const std::uint64_t from = offsetOf(row);
    std::int32_t next = row + 1;
    while (next < end && offsetOf(next) == from + row_bytes * static_cast<std::size_t>(next - row)) ++next;
    const std::size_t bytes = row_bytes * static_cast<std::size_t>(next - row);
    const auto got = file_.read(
        from, worker.numbers.data() + row_bytes * static_cast<std::size_t>(row - window.row), bytes);
    if (!got) return tl::unexpected(got.error());
    if (*got != bytes)
      return inputError("the samples cannot be read: the file ends before they do", file_.path(),
                        "the file is cut short or damaged");
    row = next;
  }
  return {};
}

// The first rows of the window's block.
Status TiffSamples::unpackRows(const TiffWindow& window, std::int32_t rows, Worker& worker) const {
  const std::size_t b = blockOf(window);
  const PackedBlock block{offsets_[b], sizes_[b], static_cast<std::size_t>(block_columns_), number_bytes_,
                          scan_.directory.predictor};
  if (worker.unpacker.unpack(file_, block, static_cast<std::size_t>(rows), worker.numbers)) return {};
  return inputError("the samples cannot be unpacked", file_.path(), "the file is cut short or damaged");
}

Status TiffSamples::readBlock(const TiffWindow& window, Worker& worker) const {
  if (!offsets_.empty()) return unpackRows(window, window.rows, worker);
  GdalSession session;
  worker.numbers.resize(static_cast<std::size_t>(block_columns_) * static_cast<std::size_t>(block_rows_) *
                        number_bytes_);
  CPLErr error = gdal().GDALReadBlock(worker.band, window.column / block_columns_, window.row / block_rows_,
                                      worker.numbers.data());
  if (error == CE_None && worker.band_mask != nullptr) {
    worker.mask.resize(static_cast<std::size_t>(window.columns) * static_cast<std::size_t>(window.rows));
    error = gdal().GDALRasterIO(worker.band_mask, GF_Read, window.column, window.row, window.columns,
                                window.rows, worker.mask.data(), window.columns, window.rows, GDT_Byte, 0, 0);
  }
  if (error != CE_None || session.failed()) return unreadable(session, file_.path());
  return {};
}

Status TiffSamples::readRows(const TiffWindow& window, Worker& worker) const {
  GdalSession session;
  const std::size_t samples =
      static_cast<std::size_t>(window.columns) * static_cast<std::size_t>(window.rows);
  worker.numbers.resize(samples * number_bytes_);
  CPLErr error =
      gdal().GDALRasterIO(worker.band, GF_Read, window.column, window.row, window.columns, window.rows,
                          worker.numbers.data(), window.columns, window.rows, scan_.type, 0, 0);
  if (error == CE_None && worker.band_mask != nullptr) {
    worker.mask.resize(samples);
    error = gdal().GDALRasterIO(worker.band_mask, GF_Read, window.column, window.row, window.columns,
                                window.rows, worker.mask.data(), window.columns, window.rows, GDT_Byte, 0, 0);
  }
  if (error != CE_None || session.failed()) return unreadable(session, file_.path());
  return {};
}

// Reads windows on all cores where the strategy allows it; the first failure ends all.
Status TiffSamples::run(const std::vector<TiffWindow>& windows, JobControl& job, const Read& read) {
  job.begin("reading", windows.size());
  std::atomic<bool> stop{false};
  std::mutex first;
  Status status;
  const auto fail = [&](Status why) {
    const std::scoped_lock lock(first);
    if (status) status = std::move(why);
    stop.store(true, std::memory_order_relaxed);
  };
  const auto one = [&](const TiffWindow& window, Worker& worker) {
    if (stop.load(std::memory_order_relaxed)) return;
    Status done = job.cancelled() ? cancelled() : read(window, worker);
    if (!done) fail(std::move(done));
    job.advance();
  };
  if (strategy_ == ReadStrategy::kRows || std::int64_t{width_} * height_ <= kSmall) {
    Worker worker;
    worker.band = scan_.band;
    worker.band_mask = scan_.mask;
    for (const TiffWindow& window : windows) one(window, worker);
    return status;
  }
  tbb::enumerable_thread_specific<Worker> workers;
  tbb::task_arena arena(std::min(kMostThreads, tbb::this_task_arena::max_concurrency()));
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, windows.size(), [&](std::size_t i) {
      Worker& worker = workers.local();
      if (strategy_ == ReadStrategy::kBlocks && offsets_.empty() && worker.band == nullptr) {
        const GdalSession session;
        worker.own = openTiffForReading(file_, false);
        if (!worker.own) {
          fail(unreadable(session, file_.path()));
          return;
        }
        worker.band = gdal().GDALGetRasterBand(worker.own.get(), 1);
        if (scan_.mask != nullptr) worker.band_mask = gdal().GDALGetMaskBand(worker.band);
      }
      one(windows[i], worker);
    });
  });
  return status;
}

Status TiffSamples::readAll(JobControl& job, const Take& take) {
  return run(windows(), job, [&](const TiffWindow& window, Worker& worker) -> Status {
    Status read = strategy_ == ReadStrategy::kPlain    ? readPlain(window, worker)
                  : strategy_ == ReadStrategy::kBlocks ? readBlock(window, worker)
                                                       : readRows(window, worker);
    if (!read) return read;
    take({window, worker.numbers.data(), strategy_ == ReadStrategy::kRows ? window.columns : block_columns_,
          worker.band_mask != nullptr ? worker.mask.data() : nullptr});
    return {};
  });
}

std::int64_t TiffSamples::costOfEvery(std::int32_t step) const noexcept {
  if (strategy_ == ReadStrategy::kPlain || scan_.directory.compression == 1)
    return std::int64_t{width_} * ((height_ - 1) / step + 1);
  if (strategy_ == ReadStrategy::kRows) return std::int64_t{width_} * height_;
  std::int64_t rows = 0;
  for (std::int32_t b = 0; b < down_; ++b) {
    const std::int32_t end = std::min(height_, (b + 1) * block_rows_);
    const std::int32_t last = (end - 1) / step * step;
    if (last >= b * block_rows_) rows += offsets_.empty() ? block_rows_ : last - b * block_rows_ + 1;
  }
  return rows * width_;
}

Status TiffSamples::readEvery(std::int32_t step, JobControl& job, const Take& take) {
  std::vector<TiffWindow> all;
  if (strategy_ != ReadStrategy::kBlocks) {
    const std::int32_t columns = strategy_ == ReadStrategy::kPlain ? block_columns_ : width_;
    for (std::int32_t row = 0; row < height_; row += step)
      for (std::int32_t column = 0; column < width_; column += columns)
        all.push_back({column, row, std::min(columns, width_ - column), 1});
    return run(all, job, [&](const TiffWindow& window, Worker& worker) -> Status {
      if (Status read =
              strategy_ == ReadStrategy::kPlain ? readPlain(window, worker) : readRows(window, worker);
          !read)
        return read;
      take({window, worker.numbers.data(), 0, worker.band_mask != nullptr ? worker.mask.data() : nullptr});
      return {};
    });
  }
  for (const TiffWindow& window : windows()) {
    const std::int32_t first = (window.row + step - 1) / step * step;
    if (first < window.row + window.rows) all.push_back(window);
  }
  return run(all, job, [&](const TiffWindow& window, Worker& worker) -> Status {
    const std::int32_t first = (window.row + step - 1) / step * step;
    const std::int32_t last = (window.row + window.rows - 1) / step * step;
    if (offsets_.empty()) {
      if (Status read = readBlock(window, worker); !read) return read;
    } else if (Status read = unpackRows(window, last - window.row + 1, worker); !read) {
      return read;
    }
    for (std::int32_t row = first; row <= last; row += step) {
      const std::size_t at = static_cast<std::size_t>(row - window.row);
      take({{window.column, row, window.columns, 1},
            worker.numbers.data() + at * static_cast<std::size_t>(block_columns_) * number_bytes_,
            0,
            worker.band_mask != nullptr ? worker.mask.data() + at * static_cast<std::size_t>(window.columns)
                                        : nullptr});
    }
    return {};
  });
}

}  // namespace fettle::engine
