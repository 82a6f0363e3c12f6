// The properties of a TIFF through GDAL: geo-reference, units, no-data.
#include "engine/io/tiff/tiff_scan.h"

#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "engine/io/field_limits.h"
#include "engine/io/files/gdal_calls.h"
#include "engine/io/geo/crs_text.h"
#include "engine/io/geo/geo_reference.h"
#include "engine/io/geo/sidecar.h"
#include "engine/io/tiff/tiff_metadata.h"
#include "engine/io/tiff/tiff_samples.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

bool isInteger(GDALDataType type) {
  return type != GDT_Float32 && type != GDT_Float64;
}

std::optional<double> declaredNoData(GDALRasterBandH band, GDALDataType type) {
  int has = 0;
  double value = 0.0;
  if (type == GDT_Int64)
    value = static_cast<double>(gdal().GDALGetRasterNoDataValueAsInt64(band, &has));
  else if (type == GDT_UInt64)
    value = static_cast<double>(gdal().GDALGetRasterNoDataValueAsUInt64(band, &has));
  else
    value = gdal().GDALGetRasterNoDataValue(band, &has);
  return has != 0 ? std::optional(value) : std::nullopt;
}

// The one band with heights; pictures that are not heights are refused.
Result<GDALRasterBandH> heightBand(GDALDatasetH dataset, const TiffDirectory& directory,
                                   const ImportOptions& options, const std::string& path,
                                   std::vector<std::string>& warnings) {
  const int bands = gdal().GDALGetRasterCount(dataset);
  if (bands < 1) return inputError("the file holds no raster", path);
  GDALRasterBandH band = gdal().GDALGetRasterBand(dataset, 1);
  const bool alpha = bands == 2 && gdal().GDALGetRasterColorInterpretation(
                                       gdal().GDALGetRasterBand(dataset, 2)) == GCI_AlphaBand;
  if (bands > 1 && !alpha)
    return inputError(fmt::format("the file holds {} bands, heights have one", bands), path,
                      "extract one, e.g. with gdal_translate -b 1");
  if (alpha) warnings.emplace_back("the second band is transparency and was left out");
  // GDAL makes a palette for these, only of integers: for floats the order of white is not defined.
  const bool white_is_0 = directory.photometric == 0 && isInteger(gdal().GDALGetRasterDataType(band));
  if (white_is_0 && !options.z_scale)
    return inputError("0 is white in this TIFF (MINISWHITE), so that its numbers may be heights or depths",
                      path, "give --z-scale 1 to take them as heights, --z-scale -1 as depths");
  if (gdal().GDALGetRasterColorTable(band) != nullptr && !white_is_0)
    return inputError("the file is a picture with a palette, not heights", path,
                      "export the heights themselves");
  if (gdal().GDALDataTypeIsComplex(gdal().GDALGetRasterDataType(band)) != 0)
    return inputError("the samples are complex numbers", path, "export a real height");
  return band;
}

void readGeoReference(GDALDatasetH dataset, const TiffDirectory& directory,
                      std::optional<GeoTransform>& transform, std::string& wkt, StatedUnits& units,
                      std::vector<std::string>& warnings) {
  GeoTransform gt{};
  if (gdal().GDALGetGeoTransform(dataset, gt.data()) == CE_None) transform = gt;
  if (OGRSpatialReferenceH crs = gdal().GDALGetSpatialRef(dataset); crs != nullptr) wkt = wktOf(crs);
  if (transform || !directory.x_per_unit || !directory.y_per_unit || directory.resolution_unit == 1) return;
  const double per_unit[2] = {*directory.x_per_unit, *directory.y_per_unit};
  if (directory.resolution_unit == 3) {
    units.spacing_mm = std::pair{10.0 / per_unit[0], 10.0 / per_unit[1]};
    return;
  }
  // Programs without knowledge of the spacing write the resolution of a printer or a screen.
  for (const double print : {72.0, 96.0, 150.0, 300.0, 600.0})
    if (per_unit[0] == print && per_unit[1] == print) {
      warnings.push_back(
          fmt::format("the file states {} samples per inch, a print resolution, which was ignored", print));
      return;
    }
  units.spacing_mm = std::pair{25.4 / per_unit[0], 25.4 / per_unit[1]};
}

}  // namespace

Result<TiffScan> openTiffScan(const InputFile& file, const ImportOptions& options, GdalSession& session,
                              TiffExtent extent) {
  const std::string& path = file.path();
  const auto checkSize = [&](std::uint64_t across, std::uint64_t down, std::uint64_t extra_bytes) {
    return extent == TiffExtent::kWhole ? checkFieldSize(across, down, extra_bytes, path)
                                        : checkFieldSides(across, down, path);
  };
  const Result<TiffDirectory> directory = readTiffDirectory(file);
  if (!directory) return tl::unexpected(directory.error());
  if (Status s = checkSize(directory->width, directory->height, TiffSamples::extraBytes(*directory)); !s)
    return tl::unexpected(s.error());
  if (Status s =
          checkPromise(directory->rawBytes(), directory->stored_bytes, directory->largestRatio(), path);
      !s)
    return tl::unexpected(s.error());
  if (directory->cut)
    return inputError("the samples reach past the end of the file", path, "the file is cut short");

  std::vector<std::string> warnings;
  DatasetPtr dataset = openTiffForReading(file, true);
  if (!dataset)
    return inputError("the TIFF cannot be opened: " + session.reason("damaged header"), path,
                      "the file is damaged or of a kind that the library does not support");
  const Result<GDALRasterBandH> band = heightBand(dataset.get(), *directory, options, path, warnings);
  if (!band) return tl::unexpected(band.error());
  const int width = gdal().GDALGetRasterXSize(dataset.get());
  const int height = gdal().GDALGetRasterYSize(dataset.get());
  if (Status s = checkSize(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), 0); !s)
    return tl::unexpected(s.error());
  if (char** pages = gdal().GDALGetMetadata(dataset.get(), "SUBDATASETS");
      pages != nullptr && pages[0] != nullptr)
    warnings.emplace_back("the file holds several pictures, the first was read");

  const GDALDataType type = gdal().GDALGetRasterDataType(*band);
  const char* pixel_type = gdal().GDALGetMetadataItem(*band, "PIXELTYPE", "IMAGE_STRUCTURE");
  const bool signed_byte = pixel_type != nullptr && std::strcmp(pixel_type, "SIGNEDBYTE") == 0;

  StatedUnits units;
  std::optional<GeoTransform> transform;
  Grid grid;
  readGeoReference(dataset.get(), *directory, transform, grid.crs_wkt, units, warnings);
  grid.width = width;
  grid.height = height;
  TiffScan scan;
  if (transform) {
    const Result<RasterPlacement> placement = placementOf(*transform, width, height, path);
    if (!placement) return tl::unexpected(placement.error());
    units.spacing = std::pair{placement->spacing_x, placement->spacing_y};
    grid.origin_x = placement->origin_x;
    grid.origin_y = placement->origin_y;
    scan.top_down = placement->top_down;
    scan.right_to_left = placement->right_to_left;
    if (!scan.top_down)
      warnings.emplace_back(
          "the file's rows go upwards: rows are counted from the highest y here, in marks too");
    if (scan.right_to_left)
      warnings.emplace_back(
          "the file's columns go leftwards: columns are counted from the lowest x here, in marks too");
  }
  const Sidecar sidecar = readAuxXml(path, warnings);
  if (grid.crs_wkt.empty()) grid.crs_wkt = sidecar.crs_wkt;
  const char* const unit = gdal().GDALGetRasterUnitType(*band);
  units.height =
      heightUnitNamed(unit != nullptr && *unit != '\0' ? unit : sidecar.height_unit, options, warnings);
  if (!grid.crs_wkt.empty())
    unitsOfCrs(grid.crs_wkt, grid.origin_y + 0.5 * height * (units.spacing ? units.spacing->second : 0.0),
               units, warnings);
  readOwnMetadata(dataset.get(), units, grid, units.spacing.value_or(std::pair{1.0, 1.0}),
                  grid.crs_wkt.empty() ? std::nullopt : units.lateral, warnings);
  determineUnits(grid, units, options, warnings);

  int has = 0;
  scan.rule.scale = gdal().GDALGetRasterScale(*band, &has);
  if (has == 0) scan.rule.scale = 1.0;
  scan.rule.offset = gdal().GDALGetRasterOffset(*band, &has);
  if (has == 0) scan.rule.offset = 0.0;
  if (options.z_scale) {
    if (scan.rule.scale != 1.0 || scan.rule.offset != 0.0)
      warnings.push_back(
          fmt::format("the file states height = number * {} + {}, read as number * {} as requested",
                      scan.rule.scale, scan.rule.offset, *options.z_scale));
    scan.rule.scale = *options.z_scale;
    scan.rule.offset = 0.0;
  }
  if (isInteger(type)) grid.height_per_count = scan.rule.offset == 0.0 ? std::abs(scan.rule.scale) : 0.0;
  scan.rule.declared_no_data = chooseNoData(declaredNoData(*band, type), sidecar, warnings);
  scan.rule.user_no_data = options.no_data;
  const int mask_flags = gdal().GDALGetMaskFlags(*band);
  if ((mask_flags & GMF_PER_DATASET) != 0 && (mask_flags & GMF_ALPHA) == 0)
    scan.mask = gdal().GDALGetMaskBand(*band);

  session.clear();
  scan.directory = *directory;
  scan.dataset = std::move(dataset);
  scan.band = *band;
  scan.type = type;
  scan.signed_byte = signed_byte;
  scan.grid = std::move(grid);
  scan.warnings = std::move(warnings);
  return scan;
}

}  // namespace fettle::engine
