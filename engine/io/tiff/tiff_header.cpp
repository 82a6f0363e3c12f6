// The header of the GeoTIFFs that Fettle writes, by GDAL.
#include "engine/io/tiff/tiff_header.h"

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "engine/io/files/atomic_file.h"
#include "engine/io/files/gdal_calls.h"
#include "engine/io/geo/geo_reference.h"
#include "engine/io/tiff/tiff_metadata.h"

namespace fettle::engine {

namespace {

constexpr std::int32_t kTiffBlock = 256;
constexpr std::int32_t kPlainStripBytes = 1 << 20;  // of an uncompressed strip, or one row

// By TiffCompression. Programs with few decoders, Gwyddion 2.62 among them, support neither tiles nor
// predictors.
constexpr std::array<TiffCoding, 4> kCodings{{{"none", "NONE", nullptr, false},
                                              {"lzw", "LZW", nullptr, false},
                                              {"deflate", "DEFLATE", "3", true},
                                              {"zstd", "ZSTD", "3", true}}};

// The unit that the coordinate system states.
std::optional<LengthUnit> unitOfCrs(const Grid& grid) {
  if (grid.crs_wkt.empty()) return std::nullopt;
  StatedUnits units;
  std::vector<std::string> ignored;
  unitsOfCrs(grid.crs_wkt, grid.origin_y, units, ignored);
  return units.lateral;
}

Status describe(GDALDatasetH dataset, const Grid& grid, const GdalSession& session, const std::string& path) {
  GeoTransform gt = geoTransformOf(grid);
  GDALRasterBandH band = gdal().GDALGetRasterBand(dataset, 1);
  bool done = gdal().GDALSetGeoTransform(dataset, gt.data()) == CE_None;
  if (done && !grid.crs_wkt.empty()) {
    OGRSpatialReferenceH crs = gdal().OSRNewSpatialReference(grid.crs_wkt.c_str());
    if (crs != nullptr) {
      gdal().OSRSetAxisMappingStrategy(crs, OAMS_TRADITIONAL_GIS_ORDER);
      done = gdal().GDALSetSpatialRef(dataset, crs) == CE_None;
      gdal().OSRDestroySpatialReference(crs);
    }
  }
  done = done && gdal().GDALSetRasterNoDataValue(band, std::numeric_limits<double>::quiet_NaN()) == CE_None &&
         gdal().GDALSetRasterUnitType(band, grid.height_unit.name.c_str()) == CE_None;
  if (done) writeOwnMetadata(dataset, grid, unitOfCrs(grid));
  if (!done || session.failed()) return cannotWriteTiff(session, path);
  return {};
}

}  // namespace

const TiffCoding& tiffCodingOf(TiffCompression compression) {
  return kCodings[static_cast<std::size_t>(compression)];
}

TiffBlocks::TiffBlocks(const Grid& grid, TiffCompression compression)
    : tiled(tiffCodingOf(compression).tiles && grid.width > kTiffBlock && grid.height > kTiffBlock),
      columns(tiled ? kTiffBlock : grid.width),
      rows(tiffCodingOf(compression).tiles
               ? kTiffBlock
               : std::clamp(kPlainStripBytes / (4 * grid.width), std::int32_t{1}, kTiffBlock)),
      across((grid.width + columns - 1) / columns),
      down((grid.height + rows - 1) / rows) {}

tl::unexpected<Error> cannotWriteTiff(const GdalSession& session, const std::string& path) {
  if (session.diskError() != 0) return writeError(path, session.diskError());
  return failure("the file cannot be written: " + session.reason("the library gives no reason"), path,
                 "check the disk or choose another folder");
}

Status writeTiffHeader(const Grid& grid, TiffCompression compression, const std::string& temporary,
                       const std::string& path) {
  const GdalSession session;
  const TiffCoding& coding = tiffCodingOf(compression);
  const TiffBlocks blocks(grid, compression);
  const std::string columns = fmt::format("{}", blocks.columns), rows = fmt::format("{}", blocks.rows);
  std::unique_ptr<char*, FreeCslList> creation;
  const auto set = [&](const char* key, const char* value) {
    creation.reset(gdal().CSLSetNameValue(creation.release(), key, value));
  };
  set("COMPRESS", coding.gdal);
  if (coding.predictor != nullptr) set("PREDICTOR", coding.predictor);
  set("BIGTIFF", "IF_SAFER");
  set("SPARSE_OK", "TRUE");
  set("TILED", blocks.tiled ? "YES" : "NO");
  set("BLOCKYSIZE", rows.c_str());
  if (blocks.tiled) set("BLOCKXSIZE", columns.c_str());
  DatasetPtr dataset(gdal().GDALCreate(gdal().GDALGetDriverByName("GTiff"), temporary.c_str(), grid.width,
                                       grid.height, 1, GDT_Float32, creation.get()));
  if (!dataset) return cannotWriteTiff(session, path);
  if (Status status = describe(dataset.get(), grid, session, path); !status) return status;
  dataset.reset();
  if (session.failed()) return cannotWriteTiff(session, path);
  return {};
}

std::optional<TiffCompression> tiffCompressionFromName(std::string_view name) {
  for (std::size_t i = 0; i < kCodings.size(); ++i)
    if (kCodings[i].name == name) return static_cast<TiffCompression>(i);
  return std::nullopt;
}

}  // namespace fettle::engine
