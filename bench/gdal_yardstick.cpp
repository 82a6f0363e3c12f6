#include "bench/gdal_yardstick.h"

#include <algorithm>
#include <array>
#include <memory>

#include "engine/base/stopwatch.h"
#include "engine/io/files/gdal_calls.h"

namespace fettle::bench {

namespace {

struct Close {
  void operator()(GDALDatasetH dataset) const noexcept { engine::gdal().GDALClose(dataset); }
};
using Dataset = std::unique_ptr<void, Close>;

Dataset openTiff(const std::string& path) {
  engine::gdal().GDALRegister_GTiff();
  const std::array<const char*, 2> drivers{"GTiff", nullptr};
  const std::array<const char*, 2> options{"NUM_THREADS=ALL_CPUS", nullptr};
  return Dataset(engine::gdal().GDALOpenEx(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers.data(),
                                           options.data(), nullptr));
}

// Rows per call.
bool readBand(const std::string& path, bool whole, char* buffer) {
  const Dataset dataset = openTiff(path);
  if (!dataset || engine::gdal().GDALGetRasterCount(dataset.get()) < 1) return false;
  GDALRasterBandH band = engine::gdal().GDALGetRasterBand(dataset.get(), 1);
  const GDALDataType type = engine::gdal().GDALGetRasterDataType(band);
  const int width = engine::gdal().GDALGetRasterXSize(dataset.get());
  const int height = engine::gdal().GDALGetRasterYSize(dataset.get());
  const std::size_t row_bytes = static_cast<std::size_t>(width) *
                                static_cast<std::size_t>(engine::gdal().GDALGetDataTypeSizeBytes(type));
  int columns = 0, rows = height;
  if (!whole) engine::gdal().GDALGetBlockSize(band, &columns, &rows);
  for (int row = 0; row < height; row += rows) {
    const int now = std::min(rows, height - row);
    if (engine::gdal().GDALRasterIO(band, GF_Read, 0, row, width, now,
                                    buffer + row_bytes * static_cast<std::size_t>(row), width, now, type, 0,
                                    0) != CE_None)
      return false;
  }
  return true;
}

// Of the first band; nothing for a file that GDAL does not open as a TIFF.
std::optional<std::size_t> bytesOfBand(const std::string& path) {
  const Dataset dataset = openTiff(path);
  if (!dataset || engine::gdal().GDALGetRasterCount(dataset.get()) < 1) return std::nullopt;
  const GDALDataType type =
      engine::gdal().GDALGetRasterDataType(engine::gdal().GDALGetRasterBand(dataset.get(), 1));
  return static_cast<std::size_t>(engine::gdal().GDALGetRasterXSize(dataset.get())) *
         static_cast<std::size_t>(engine::gdal().GDALGetRasterYSize(dataset.get())) *
         static_cast<std::size_t>(engine::gdal().GDALGetDataTypeSizeBytes(type));
}

}  // namespace

engine::Status writeTiffAs(TiffLayout layout, const engine::Version& field, const std::string& path,
                           engine::JobControl& job) {
  engine::gdal().GDALRegister_GTiff();
  const bool packed = layout == TiffLayout::kPackedStrips;
  const bool tiled = layout == TiffLayout::kPlainTiles;
  std::vector<const char*> creation{"BIGTIFF=IF_SAFER", "NUM_THREADS=ALL_CPUS"};
  if (packed) creation.insert(creation.end(), {"COMPRESS=DEFLATE", "PREDICTOR=3", "BLOCKYSIZE=16"});
  if (tiled) creation.insert(creation.end(), {"TILED=YES", "BLOCKXSIZE=256", "BLOCKYSIZE=256"});
  creation.push_back(nullptr);
  const engine::Grid& grid = field.grid();
  const engine::Error cannot = engine::inputError("the file cannot be written", path).value();
  const Dataset dataset(engine::gdal().GDALCreate(engine::gdal().GDALGetDriverByName("GTiff"), path.c_str(),
                                                  grid.width, grid.height, 1, GDT_Float32,
                                                  const_cast<char**>(creation.data())));
  if (!dataset) return tl::unexpected(cannot);
  std::array<double, 6> place{0.0, grid.spacing_x, 0.0, grid.height * grid.spacing_y, 0.0, -grid.spacing_y};
  engine::gdal().GDALSetGeoTransform(dataset.get(), place.data());
  GDALRasterBandH band = engine::gdal().GDALGetRasterBand(dataset.get(), 1);
  constexpr std::int32_t kRows = 256;  // whole blocks of each layout
  std::vector<float> heights(static_cast<std::size_t>(grid.width) * kRows);
  const engine::FieldReader reader = field.reader();
  for (std::int32_t top = 0; top < grid.height; top += kRows) {
    const std::int32_t rows = std::min(kRows, grid.height - top);
    reader.readHeights(0, grid.height - top - rows, grid.width, rows,
                       heights.data() + std::ptrdiff_t{rows - 1} * grid.width, -grid.width);
    if (engine::gdal().GDALRasterIO(band, GF_Write, 0, top, grid.width, rows, heights.data(), grid.width,
                                    rows, GDT_Float32, 0, 0) != CE_None)
      return tl::unexpected(cannot);
    if (job.cancelled()) return engine::cancelled();
  }
  engine::gdal().GDALFlushCache(dataset.get());
  return {};
}

engine::Result<std::optional<double>> secondsOfGdal(const std::string& path, std::vector<char>& buffer) {
  const auto bytes = bytesOfBand(path);
  if (!bytes) return std::nullopt;
  if (buffer.size() < *bytes) buffer.resize(*bytes);
  double best = 0.0;
  for (const bool whole : {true, false}) {
    const engine::Stopwatch watch;
    if (!readBand(path, whole, buffer.data())) return engine::inputError("the file cannot be read", path);
    const double took = watch.seconds();
    best = whole ? took : std::min(best, took);
  }
  return best;
}

engine::Result<std::optional<double>> secondsOfGdalIntoNewMemory(const std::string& path) {
  const auto bytes = bytesOfBand(path);
  if (!bytes) return std::nullopt;
  const engine::Stopwatch watch;
  const auto buffer = std::make_unique_for_overwrite<char[]>(*bytes);
  if (!readBand(path, true, buffer.get())) return engine::inputError("the file cannot be read", path);
  return watch.seconds();
}

}  // namespace fettle::bench
