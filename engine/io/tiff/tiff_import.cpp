// TIFF and GeoTIFF: every real sample type, strips and tiles, all compressions of the GDAL package.

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "engine/io/field_limits.h"
#include "engine/io/format.h"
#include "engine/io/tiff/tiff_samples.h"
#include "engine/io/tiff/tiff_scan.h"

namespace fettle::engine {

namespace {

// Writes a piece as heights to its position, tile by tile, so that each is completed while it is in the
// cache.
template <class T>
void placeTiles(const TiffScan& scan, const TiffPiece& piece, FieldBuilder& builder, HeightTally& tally) {
  const std::int32_t height = builder.grid().height;
  const TiffWindow& w = piece.window;
  const std::int32_t low = scan.top_down ? height - w.row - w.rows : w.row;
  const std::int32_t right = w.column + w.columns;
  for (std::int32_t bottom = low; bottom < low + w.rows;) {
    const std::int32_t top = std::min(low + w.rows, (bottom | (kTileSide - 1)) + 1);
    for (std::int32_t left = w.column; left < right;) {
      const std::int32_t end = std::min(right, (left | (kTileSide - 1)) + 1);
      Tile& tile = builder.tile(left / kTileSide, bottom / kTileSide);
      for (std::int32_t row = bottom; row < top; ++row) {
        const std::int32_t r = scan.top_down ? height - 1 - row - w.row : row - w.row;
        scan.rule.convert(
            static_cast<const T*>(piece.numbers) + std::ptrdiff_t{r} * piece.stride + (left - w.column),
            tile.samples.data() + (row % kTileSide) * kTileSide + left % kTileSide,
            static_cast<std::size_t>(end - left), tally);
      }
      builder.wrote(left / kTileSide, bottom / kTileSide, (end - left) * (top - bottom));
      left = end;
    }
    bottom = top;
  }
}

// The same where the file has a mask or columns from right to left. `row` holds a row of the piece.
template <class T>
void placeRows(const TiffScan& scan, const TiffPiece& piece, FieldBuilder& builder, std::vector<float>& row,
               HeightTally& tally) {
  const Grid& grid = builder.grid();
  const TiffWindow& w = piece.window;
  const std::int32_t first = scan.right_to_left ? grid.width - w.column - w.columns : w.column;
  row.resize(static_cast<std::size_t>(w.columns));
  for (std::int32_t r = 0; r < w.rows; ++r) {
    const T* numbers = static_cast<const T*>(piece.numbers) + std::ptrdiff_t{r} * piece.stride;
    const std::int32_t to = scan.top_down ? grid.height - 1 - (w.row + r) : w.row + r;
    scan.rule.convert(numbers, row.data(), row.size(), tally);
    for (std::size_t k = 0; piece.mask != nullptr && k < row.size(); ++k)
      if (piece.mask[static_cast<std::size_t>(r) * row.size() + k] == 0)
        row[k] = std::numeric_limits<float>::quiet_NaN();
    if (scan.right_to_left) std::reverse(row.begin(), row.end());
    builder.writeHeights(first, to, w.columns, 1, row.data(), w.columns);
  }
}

template <class T>
Status readSamples(const TiffScan& scan, TiffSamples& samples, FieldBuilder& builder, HeightTally& total,
                   JobControl& job) {
  struct Worker {
    std::vector<float> row;
    HeightTally tally;
  };
  tbb::enumerable_thread_specific<Worker> workers;
  Status status = samples.readAll(job, [&](const TiffPiece& piece) {
    Worker& worker = workers.local();
    if (piece.mask == nullptr && !scan.right_to_left)
      placeTiles<T>(scan, piece, builder, worker.tally);
    else
      placeRows<T>(scan, piece, builder, worker.row, worker.tally);
  });
  for (const Worker& worker : workers) total.merge(worker.tally);
  return status;
}

// The rows of a piece that are among `rows` of the field, to their place in a field of these.
template <class T>
void placeSpan(const TiffScan& scan, const TiffPiece& piece, RowSpan rows, FieldBuilder& builder,
               std::vector<float>& row, HeightTally& tally) {
  const TiffWindow& w = piece.window;
  const std::int32_t first = scan.right_to_left ? scan.grid.width - w.column - w.columns : w.column;
  row.resize(static_cast<std::size_t>(w.columns));
  for (std::int32_t r = 0; r < w.rows; ++r) {
    const std::int32_t to = scan.top_down ? scan.grid.height - 1 - (w.row + r) : w.row + r;
    if (to < rows.first || to >= rows.end()) continue;
    const T* numbers = static_cast<const T*>(piece.numbers) + std::ptrdiff_t{r} * piece.stride;
    scan.rule.convert(numbers, row.data(), row.size(), tally);
    for (std::size_t k = 0; piece.mask != nullptr && k < row.size(); ++k)
      if (piece.mask[static_cast<std::size_t>(r) * row.size() + k] == 0)
        row[k] = std::numeric_limits<float>::quiet_NaN();
    if (scan.right_to_left) std::reverse(row.begin(), row.end());
    builder.writeHeights(first, to - rows.first, w.columns, 1, row.data(), w.columns);
  }
}

Result<Grid> gridOfTiff(const InputFile& file, const ImportOptions& options) {
  GdalSession session;
  Result<TiffScan> scan = openTiffScan(file, options, session, TiffExtent::kPart);
  if (!scan) return tl::unexpected(scan.error());
  return std::move(scan->grid);
}

Result<Imported> readTiffRows(const InputFile& file, const ImportOptions& options, RowSpan rows,
                              JobControl& job) {
  GdalSession session;
  const Result<TiffScan> scan = openTiffScan(file, options, session, TiffExtent::kPart);
  if (!scan) return tl::unexpected(scan.error());
  const std::int32_t top = scan->top_down ? scan->grid.height - rows.end() : rows.first;
  TiffSamples samples(file, *scan, top, top + rows.count);
  Grid grid = scan->grid;
  grid.height = rows.count;
  grid.origin_y += rows.first * grid.spacing_y;
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), file.path());
  if (!builder) return tl::unexpected(builder.error());
  struct Worker {
    std::vector<float> row;
    HeightTally tally;
  };
  tbb::enumerable_thread_specific<Worker> workers;
  Status status;
  const bool known = withSampleType(*scan, [&](auto zero) {
    status = samples.readAll(job, [&](const TiffPiece& piece) {
      Worker& worker = workers.local();
      placeSpan<decltype(zero)>(*scan, piece, rows, *builder, worker.row, worker.tally);
    });
  });
  if (!known) return inputError("the samples are of a type that cannot be heights", file.path());
  if (!status) return tl::unexpected(status.error());
  HeightTally tally;
  for (const Worker& worker : workers) tally.merge(worker.tally);
  Imported imported;
  imported.warnings = scan->warnings;
  describeTally(tally, scan->grid.height_unit.name, imported.warnings);
  imported.field = std::move(*builder).build();
  imported.format = "GTiff";
  return imported;
}

bool looksLikeTiff(std::string_view head, std::string_view) {
  using namespace std::string_view_literals;
  return head.starts_with("II*\0"sv) || head.starts_with("MM\0*"sv) || head.starts_with("II+\0"sv) ||
         head.starts_with("MM\0+"sv);
}

Result<Imported> readTiff(const InputFile& file, const ImportOptions& options, JobControl& job) {
  const std::string& path = file.path();
  GdalSession session;
  Result<TiffScan> scan = openTiffScan(file, options, session);
  if (!scan) return tl::unexpected(scan.error());
  TiffSamples samples(file, *scan);
  Result<FieldBuilder> builder =
      FieldBuilder::create(std::move(scan->grid), path, FieldBuilder::Start::kUnwritten);
  if (!builder) return tl::unexpected(builder.error());
  HeightTally tally;
  Status status;
  const bool known = withSampleType(
      *scan, [&](auto zero) { status = readSamples<decltype(zero)>(*scan, samples, *builder, tally, job); });
  if (!known) return inputError("the samples are of a type that cannot be heights", path);
  if (!status) return tl::unexpected(status.error());
  return finishImport(std::move(*builder), scan->rule, tally, "GTiff", std::move(scan->warnings));
}

}  // namespace

FormatPreviewer previewTiff;  // tiff_preview.cpp

constexpr std::string_view kTiffExtensions[] = {".tif", ".tiff"};
constexpr Format kTiffFormat{
    .info = {"GTiff", "GeoTIFF and TIFF", kTiffExtensions, true, true},
    .recognises = looksLikeTiff,
    .read = readTiff,
    .write = writeTiff,
    .preview = previewTiff,
    .grid = gridOfTiff,
    .read_rows = readTiffRows,
    .picture = true,
    .tiff = true,
};

}  // namespace fettle::engine
