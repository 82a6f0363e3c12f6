// A coarse picture of a TIFF: its own overview, or every n-th sample of every m-th row.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "engine/field/builder.h"
#include "engine/io/files/gdal_calls.h"
#include "engine/io/format.h"
#include "engine/io/import.h"
#include "engine/io/tiff/tiff_samples.h"

namespace fettle::engine {

namespace {

constexpr std::int64_t kMostUnpacked = std::int64_t{24} << 20;  // samples
constexpr std::int32_t kFewestRows = 16;                        // fewer are of no use

// Position of the picture's samples among those of the file.
struct Lattice {
  std::int32_t columns = 0, rows = 0;            // of the picture
  std::int32_t step_columns = 1, step_rows = 1;  // of the file
};

// The grid of samples that begin with the file's first one.
Grid gridOf(const TiffScan& scan, const Lattice& lattice) {
  Grid grid = scan.grid;
  // The last column and row of the picture need not be the file's.
  const std::int32_t left =
      scan.right_to_left ? grid.width - 1 - (lattice.columns - 1) * lattice.step_columns : 0;
  const std::int32_t below = scan.top_down ? grid.height - 1 - (lattice.rows - 1) * lattice.step_rows : 0;
  grid.origin_x += left * grid.spacing_x;
  grid.origin_y += below * grid.spacing_y;
  grid.spacing_x *= lattice.step_columns;
  grid.spacing_y *= lattice.step_rows;
  grid.width = lattice.columns;
  grid.height = lattice.rows;
  return grid;
}

// One row of the file's numbers, of which every step-th is copied to its position.
template <class T>
void place(const TiffScan& scan, const Lattice& lattice, const TiffPiece& piece, FieldBuilder& builder) {
  const TiffWindow& w = piece.window;
  const std::int32_t step = lattice.step_columns;
  const std::int32_t file_row = w.row / lattice.step_rows;
  const std::int32_t row = scan.top_down ? lattice.rows - 1 - file_row : file_row;
  const T* numbers = static_cast<const T*>(piece.numbers);
  HeightTally tally;
  for (std::int32_t c = (w.column + step - 1) / step * step; c < w.column + w.columns; c += step) {
    float height = 0.0F;
    scan.rule.convert(numbers + (c - w.column), &height, 1, tally);
    if (piece.mask != nullptr && piece.mask[c - w.column] == 0)
      height = std::numeric_limits<float>::quiet_NaN();
    const std::int32_t column = scan.right_to_left ? lattice.columns - 1 - c / step : c / step;
    builder.writeHeights(column, row, 1, 1, &height, 1);
  }
}

// The largest overview within `max_samples`, read completely.
struct Overview {
  GDALRasterBandH band = nullptr;
  Lattice lattice;
};
std::optional<Overview> overviewOf(const TiffScan& scan, std::int64_t max_samples) {
  std::optional<Overview> best;
  for (int i = 0; i < gdal().GDALGetOverviewCount(scan.band); ++i) {
    Overview o;
    o.band = gdal().GDALGetOverview(scan.band, i);
    if (o.band == nullptr) continue;
    o.lattice.columns = gdal().GDALGetRasterBandXSize(o.band);
    o.lattice.rows = gdal().GDALGetRasterBandYSize(o.band);
    const std::int64_t samples = std::int64_t{o.lattice.columns} * o.lattice.rows;
    if (o.lattice.columns < kFewestRows || o.lattice.rows < kFewestRows || samples > max_samples ||
        (best && samples <= std::int64_t{best->lattice.columns} * best->lattice.rows))
      continue;
    o.lattice.step_columns = (scan.grid.width + o.lattice.columns / 2) / o.lattice.columns;
    o.lattice.step_rows = (scan.grid.height + o.lattice.rows / 2) / o.lattice.rows;
    best = o;
  }
  return best;
}

template <class T>
Status readOverview(const TiffScan& scan, const Overview& overview, FieldBuilder& builder,
                    const std::string& path, JobControl& job) {
  const GdalSession session;
  const std::int32_t columns = overview.lattice.columns;
  Lattice own = overview.lattice;
  own.step_columns = own.step_rows = 1;
  std::vector<T> row(static_cast<std::size_t>(columns));
  std::vector<std::uint8_t> mask(scan.mask != nullptr ? row.size() : 0);
  GDALRasterBandH mask_band = scan.mask != nullptr ? gdal().GDALGetMaskBand(overview.band) : nullptr;
  job.begin("reading", static_cast<std::uint64_t>(own.rows));
  for (std::int32_t r = 0; r < own.rows; ++r) {
    CPLErr error = gdal().GDALRasterIO(overview.band, GF_Read, 0, r, columns, 1, row.data(), columns, 1,
                                       scan.type, 0, 0);
    if (error == CE_None && mask_band != nullptr)
      error =
          gdal().GDALRasterIO(mask_band, GF_Read, 0, r, columns, 1, mask.data(), columns, 1, GDT_Byte, 0, 0);
    if (error != CE_None || session.failed())
      return inputError("the overview cannot be read: " + session.reason("the file is damaged"), path,
                        "the file is cut short or damaged");
    if (job.cancelled()) return cancelled();
    place<T>(scan, own, {{0, r, columns, 1}, row.data(), 0, mask_band != nullptr ? mask.data() : nullptr},
             builder);
    job.advance();
  }
  return {};
}

// Rows as far apart as columns where that costs little; otherwise fewer.
std::optional<Lattice> latticeOf(const TiffScan& scan, const TiffSamples& samples, std::int64_t max_samples) {
  const double all = static_cast<double>(scan.grid.samples());
  const auto step = static_cast<std::int32_t>(std::ceil(std::sqrt(all / static_cast<double>(max_samples))));
  const std::int32_t block = samples.blockRows();
  for (const std::int32_t rows : {step, block / 8, block / 4, block / 2, block, 2 * block, 4 * block}) {
    if (rows < step || samples.costOfEvery(rows) > kMostUnpacked) continue;
    Lattice lattice;
    lattice.step_columns = step;
    lattice.step_rows = rows;
    lattice.columns = (scan.grid.width - 1) / step + 1;
    lattice.rows = (scan.grid.height - 1) / rows + 1;
    if (rows > step && lattice.rows < kFewestRows) return std::nullopt;
    return lattice;
  }
  return std::nullopt;
}

}  // namespace

Result<std::optional<Preview>> previewTiff(const InputFile& file, const ImportOptions& options,
                                           std::int64_t max_samples, JobControl& job) {
  GdalSession session;
  const Result<TiffScan> scan = openTiffScan(file, options, session);
  if (!scan) return tl::unexpected(scan.error());
  if (scan->grid.samples() / 4 <= max_samples) return std::nullopt;
  const std::optional<Overview> overview = overviewOf(*scan, max_samples);
  TiffSamples samples(file, *scan);
  const std::optional<Lattice> lattice =
      overview ? overview->lattice : latticeOf(*scan, samples, max_samples);
  if (!lattice) return std::nullopt;
  Grid grid = gridOf(*scan, *lattice);
  if (overview) {
    // An overview covers the whole field, with any sides.
    grid.spacing_x = scan->grid.spacing_x * scan->grid.width / lattice->columns;
    grid.spacing_y = scan->grid.spacing_y * scan->grid.height / lattice->rows;
    grid.origin_x = scan->grid.origin_x + 0.5 * (grid.spacing_x - scan->grid.spacing_x);
    grid.origin_y = scan->grid.origin_y + 0.5 * (grid.spacing_y - scan->grid.spacing_y);
  }
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), file.path());
  if (!builder) return tl::unexpected(builder.error());
  Status status;
  const bool known = withSampleType(*scan, [&](auto zero) {
    using T = decltype(zero);
    if (overview)
      status = readOverview<T>(*scan, *overview, *builder, file.path(), job);
    else
      status = samples.readEvery(lattice->step_rows, job,
                                 [&](const TiffPiece& piece) { place<T>(*scan, *lattice, piece, *builder); });
  });
  if (!known) return std::nullopt;  // the full import refuses it with a message
  if (!status) return tl::unexpected(status.error());
  Preview preview;
  preview.field = std::move(*builder).build();
  if (preview.field.reader().bounds().empty()) return std::nullopt;
  preview.step_columns = lattice->step_columns;
  preview.step_rows = lattice->step_rows;
  preview.overview = overview.has_value();
  preview.width = scan->grid.width;
  preview.height = scan->grid.height;
  return preview;
}

}  // namespace fettle::engine
