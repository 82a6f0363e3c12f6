// GeoTIFF float32: Deflate with the floating-point predictor, which every reader knows and keeps every bit.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include "engine/io/atomic_file.h"
#include "engine/io/format.h"
#include "engine/io/gdal_session.h"
#include "engine/io/geo_reference.h"
#include "engine/io/tiff_metadata.h"

namespace fettle::engine {

namespace {

constexpr int kBlock = 256;

struct FreeList {
  void operator()(char** list) const noexcept { CSLDestroy(list); }
};

// Whether the file will say the lateral unit by itself.
bool crsStatesUnit(const Grid& grid) {
  if (grid.crs_wkt.empty()) return false;
  StatedUnits units;
  std::vector<std::string> ignored;
  unitsOfCrs(grid.crs_wkt, grid.origin_y, units, ignored);
  return units.lateral && (units.lateral->name == "deg" ? grid.lateral_unit.name == "deg"
                                                        : *units.lateral == grid.lateral_unit);
}

tl::unexpected<Error> cannotWrite(const GdalSession& gdal, const std::string& path) {
  return inputError("the file cannot be written: " + gdal.reason("the disk may be full"), path,
                    "make room on the disk or choose another folder");
}

Status describe(GDALDatasetH dataset, const Grid& grid, const GdalSession& gdal, const std::string& path) {
  GeoTransform gt = geoTransformOf(grid);
  GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
  bool done = GDALSetGeoTransform(dataset, gt.data()) == CE_None;
  if (done && !grid.crs_wkt.empty()) {
    OGRSpatialReferenceH crs = OSRNewSpatialReference(grid.crs_wkt.c_str());
    if (crs != nullptr) {
      OSRSetAxisMappingStrategy(crs, OAMS_TRADITIONAL_GIS_ORDER);
      done = GDALSetSpatialRef(dataset, crs) == CE_None;
      OSRDestroySpatialReference(crs);
    }
  }
  done = done && GDALSetRasterNoDataValue(band, std::numeric_limits<double>::quiet_NaN()) == CE_None &&
         GDALSetRasterUnitType(band, grid.height_unit.name.c_str()) == CE_None;
  if (done) writeOwnMetadata(dataset, grid, crsStatesUnit(grid));
  if (!done || gdal.failed()) return cannotWrite(gdal, path);
  return {};
}

Status writePlain(const Version& field, const std::string& temporary, const std::string& path,
                  JobControl& job) {
  const FieldReader reader = field.reader();
  const Grid& grid = field.grid();

  GdalSession gdal;
  // Threads compress blocks; the blocks are written in order, so the bytes do not depend on their number.
  const std::string block = fmt::format("{}", kBlock);
  std::unique_ptr<char*, FreeList> creation;
  const bool tiled = grid.width > kBlock && grid.height > kBlock;
  for (const auto& [key, value] : {std::pair{"COMPRESS", "DEFLATE"},
                                   {"PREDICTOR", "3"},
                                   {"ZLEVEL", "6"},
                                   {"BIGTIFF", "IF_SAFER"},
                                   {"NUM_THREADS", "ALL_CPUS"},
                                   {"TILED", tiled ? "YES" : "NO"},
                                   {"BLOCKYSIZE", block.c_str()}})
    creation.reset(CSLSetNameValue(creation.release(), key, value));
  if (tiled) creation.reset(CSLSetNameValue(creation.release(), "BLOCKXSIZE", block.c_str()));
  DatasetPtr dataset(GDALCreate(GDALGetDriverByName("GTiff"), temporary.c_str(), grid.width, grid.height, 1,
                                GDT_Float32, creation.get()));
  if (!dataset) return cannotWrite(gdal, path);
  if (Status status = describe(dataset.get(), grid, gdal, path); !status) return status;

  GDALRasterBandH band = GDALGetRasterBand(dataset.get(), 1);
  // A few blocks at a time, flushed at once: left in the cache, all blocks would be compressed in one last
  // step that cannot be cancelled; it takes as long either way. Strips are as wide as the field and must be
  // whole when they are flushed.
  const std::int32_t piece = tiled ? std::min(8 * kBlock, grid.width) : grid.width;
  std::vector<float> heights(static_cast<std::size_t>(piece) * kBlock);
  job.begin("writing", static_cast<std::uint64_t>(grid.height));
  for (std::int32_t top = 0; top < grid.height; top += kBlock) {
    const std::int32_t rows = std::min(kBlock, grid.height - top);
    for (std::int32_t left = 0; left < grid.width; left += piece) {
      const std::int32_t columns = std::min(piece, grid.width - left);
      // Read upside down: the first row of the file is the highest one of the field.
      reader.readHeights(left, grid.height - top - rows, columns, rows,
                         heights.data() + static_cast<std::ptrdiff_t>(rows - 1) * columns, -columns);
      CPLErr error = GDALRasterIO(band, GF_Write, left, top, columns, rows, heights.data(), columns, rows,
                                  GDT_Float32, 0, 0);
      if (error == CE_None) error = GDALFlushRasterCache(band);
      if (error != CE_None || gdal.failed()) return cannotWrite(gdal, path);
      if (job.cancelled()) return cancelled();
    }
    job.advance(static_cast<std::uint64_t>(rows));
  }
  GDALFlushCache(dataset.get());
  dataset.reset();
  if (gdal.failed()) return cannotWrite(gdal, path);
  if (job.cancelled()) return cancelled();
  return {};
}

// The same samples in the order in which they are wanted over a network, with overviews. Means: what lies
// between two samples of an overview is in it.
Status writeCloudOptimised(const std::string& from, const std::string& to, const GdalSession& gdal,
                           const std::string& path, JobControl& job) {
  const std::array<const char*, 2> drivers{"GTiff", nullptr};
  const DatasetPtr source(
      GDALOpenEx(from.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers.data(), nullptr, nullptr));
  if (!source) return cannotWrite(gdal, path);
  std::unique_ptr<char*, FreeList> creation;
  for (const auto& [key, value] : {std::pair{"COMPRESS", "DEFLATE"},
                                   {"PREDICTOR", "FLOATING_POINT"},
                                   {"LEVEL", "6"},
                                   {"BLOCKSIZE", "256"},
                                   {"OVERVIEWS", "IGNORE_EXISTING"},
                                   {"OVERVIEW_RESAMPLING", "AVERAGE"},
                                   {"BIGTIFF", "IF_SAFER"},
                                   {"NUM_THREADS", "ALL_CPUS"}})
    creation.reset(CSLSetNameValue(creation.release(), key, value));
  job.begin("overviews", 100);
  struct Told {
    JobControl& job;
    std::uint64_t percent = 0;
  } told{job};
  const auto progress = [](double done, const char*, void* self) {
    auto& at = *static_cast<Told*>(self);
    const auto percent = static_cast<std::uint64_t>(done * 100.0);
    if (percent > at.percent) at.job.advance(percent - std::exchange(at.percent, percent));
    return at.job.cancelled() ? 0 : 1;
  };
  const DatasetPtr copy(GDALCreateCopy(GDALGetDriverByName("COG"), to.c_str(), source.get(), FALSE,
                                       creation.get(), progress, &told));
  if (job.cancelled()) return cancelled();
  if (!copy || gdal.failed()) return cannotWrite(gdal, path);
  return {};
}

}  // namespace

Result<Exported> writeTiff(const Version& field, const std::string& path, const ExportOptions& options,
                           JobControl& job) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  if (options.cloud_optimised) {
    // An ordinary file first, beside the final one and never committed: gone at the end of this scope.
    Result<AtomicFile> plain = AtomicFile::create(path);
    if (!plain) return tl::unexpected(plain.error());
    if (Status status = writePlain(field, plain->temporaryPath(), path, job); !status)
      return tl::unexpected(status.error());
    const GdalSession gdal;
    if (Status status = writeCloudOptimised(plain->temporaryPath(), file->temporaryPath(), gdal, path, job);
        !status)
      return tl::unexpected(status.error());
  } else if (Status status = writePlain(field, file->temporaryPath(), path, job); !status) {
    return tl::unexpected(status.error());
  }
  if (Status status = file->commit(); !status) return tl::unexpected(status.error());
  return Exported{"GTiff", {}};
}

}  // namespace fettle::engine
