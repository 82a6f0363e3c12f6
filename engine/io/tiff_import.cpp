// TIFF and GeoTIFF: every real sample type, strips and tiles, all compressions of the GDAL package.

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "engine/io/field_limits.h"
#include "engine/io/format.h"
#include "engine/io/tiff_samples.h"
#include "engine/io/tiff_scan.h"

namespace fettle::engine {

namespace {

// Turns a piece into heights where it belongs. `row` holds a row of the piece.
template <class T>
void place(const TiffScan& scan, const TiffPiece& piece, FieldBuilder& builder, std::vector<float>& row,
           HeightTally& tally) {
  const Grid& grid = builder.grid();
  const TiffWindow& w = piece.window;
  const std::int32_t first = scan.right_to_left ? grid.width - w.column - w.columns : w.column;
  for (std::int32_t r = 0; r < w.rows; ++r) {
    const T* numbers = static_cast<const T*>(piece.numbers) + std::ptrdiff_t{r} * piece.stride;
    const std::int32_t to = scan.top_down ? grid.height - 1 - (w.row + r) : w.row + r;
    if (piece.mask == nullptr && !scan.right_to_left) {
      for (std::int32_t c = first; c < first + w.columns;) {
        const std::int32_t end = std::min(first + w.columns, (c | (kTileSide - 1)) + 1);
        Tile& tile = builder.tile(c / kTileSide, to / kTileSide);
        scan.rule.convert(numbers + (c - first),
                          tile.samples.data() + (to % kTileSide) * kTileSide + c % kTileSide,
                          static_cast<std::size_t>(end - c), tally);
        c = end;
      }
      continue;
    }
    row.resize(static_cast<std::size_t>(w.columns));
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
    place<T>(scan, piece, builder, worker.row, worker.tally);
  });
  for (const Worker& worker : workers) total.merge(worker.tally);
  return status;
}

}  // namespace

bool looksLikeTiff(std::string_view head, std::string_view) {
  using namespace std::string_view_literals;
  return head.starts_with("II*\0"sv) || head.starts_with("MM\0*"sv) || head.starts_with("II+\0"sv) ||
         head.starts_with("MM\0+"sv);
}

Result<Imported> readTiff(const InputFile& file, const ImportOptions& options, JobControl& job) {
  const std::string& path = file.path();
  GdalSession gdal;
  Result<TiffScan> scan = openTiffScan(file, options, gdal);
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
  return finishImport(std::move(*builder), tally, "GTiff", std::move(scan->warnings), path);
}

}  // namespace fettle::engine
