// TIFF and GeoTIFF through GDAL: every real sample type, strips and tiles, all compressions of the package.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include <cpl_conv.h>
#include <fmt/format.h>
#include <gdal.h>
#include <ogr_srs_api.h>
#include <tbb/task_group.h>

#include "engine/io/field_limits.h"
#include "engine/io/format.h"
#include "engine/io/gdal_session.h"
#include "engine/io/geo_reference.h"
#include "engine/io/tiff_directory.h"
#include "engine/io/tiff_metadata.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

// Dispatches on the band's type; `signed_byte` because GDAL 3.6 has no type of its own for it.
template <class Use>
bool withSampleType(GDALDataType type, bool signed_byte, Use&& use) {
  switch (type) {
    case GDT_Byte:
      signed_byte ? use(std::int8_t{}) : use(std::uint8_t{});
      return true;
    case GDT_UInt16:
      use(std::uint16_t{});
      return true;
    case GDT_Int16:
      use(std::int16_t{});
      return true;
    case GDT_UInt32:
      use(std::uint32_t{});
      return true;
    case GDT_Int32:
      use(std::int32_t{});
      return true;
    case GDT_UInt64:
      use(std::uint64_t{});
      return true;
    case GDT_Int64:
      use(std::int64_t{});
      return true;
    case GDT_Float32:
      use(float{});
      return true;
    case GDT_Float64:
      use(double{});
      return true;
    default:
      return false;
  }
}

bool isInteger(GDALDataType type) {
  return type != GDT_Float32 && type != GDT_Float64;
}

std::optional<double> declaredNoData(GDALRasterBandH band, GDALDataType type) {
  int has = 0;
  double value = 0.0;
  if (type == GDT_Int64)
    value = static_cast<double>(GDALGetRasterNoDataValueAsInt64(band, &has));
  else if (type == GDT_UInt64)
    value = static_cast<double>(GDALGetRasterNoDataValueAsUInt64(band, &has));
  else
    value = GDALGetRasterNoDataValue(band, &has);
  return has != 0 ? std::optional(value) : std::nullopt;
}

// The one band that holds heights; anything that is a picture rather than heights is refused.
Result<GDALRasterBandH> heightBand(GDALDatasetH dataset, const std::string& path,
                                   std::vector<std::string>& warnings) {
  const int bands = GDALGetRasterCount(dataset);
  if (bands < 1) return inputError("the file holds no raster", path);
  GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
  const bool alpha =
      bands == 2 && GDALGetRasterColorInterpretation(GDALGetRasterBand(dataset, 2)) == GCI_AlphaBand;
  if (bands > 1 && !alpha)
    return inputError(fmt::format("the file holds {} bands, heights are one", bands), path,
                      "take one out, e.g. with gdal_translate -b 1");
  if (alpha) warnings.emplace_back("the second band is transparency and was left out");
  if (GDALGetRasterColorTable(band) != nullptr)
    return inputError("the file is a picture with a palette, not heights", path,
                      "export the heights themselves");
  if (GDALDataTypeIsComplex(GDALGetRasterDataType(band)) != 0)
    return inputError("the samples are complex numbers", path, "export a real height");
  return band;
}

void readGeoReference(GDALDatasetH dataset, const TiffDirectory& directory,
                      std::optional<GeoTransform>& transform, std::string& wkt, StatedUnits& units,
                      std::vector<std::string>& warnings) {
  GeoTransform gt{};
  if (GDALGetGeoTransform(dataset, gt.data()) == CE_None) transform = gt;
  if (OGRSpatialReferenceH crs = GDALGetSpatialRef(dataset); crs != nullptr) {
    char* text = nullptr;
    const std::array<const char*, 2> options{"FORMAT=WKT2_2019", nullptr};
    if (OSRExportToWktEx(crs, &text, options.data()) == OGRERR_NONE && text != nullptr) wkt = text;
    CPLFree(text);
  }
  if (transform || !directory.x_per_unit || !directory.y_per_unit || directory.resolution_unit == 1) return;
  const double per_unit[2] = {*directory.x_per_unit, *directory.y_per_unit};
  if (directory.resolution_unit == 3) {
    units.spacing_mm = std::pair{10.0 / per_unit[0], 10.0 / per_unit[1]};
    return;
  }
  // Programs that know nothing of the spacing write the resolution of a printer or a screen.
  for (const double print : {72.0, 96.0, 150.0, 300.0, 600.0})
    if (per_unit[0] == print && per_unit[1] == print) {
      warnings.push_back(
          fmt::format("the file says {} samples an inch, a print resolution: not believed", print));
      return;
    }
  units.spacing_mm = std::pair{25.4 / per_unit[0], 25.4 / per_unit[1]};
}

struct Plan {
  GDALRasterBandH band = nullptr;
  GDALRasterBandH mask = nullptr;  // of a mask of its own, else null
  bool top_down = true;
  bool right_to_left = false;
  HeightRule rule;
};

// Strips of whole tile rows, read by GDAL on this thread while a worker turns the strip before into heights.
template <class T>
Status readSamples(const Plan& plan, GDALDataType type, FieldBuilder& builder, HeightTally& total,
                   GdalSession& gdal, const std::string& path, JobControl& job) {
  const std::int32_t width = builder.grid().width;
  const std::int32_t height = builder.grid().height;
  struct Strip {
    std::vector<T> numbers;
    std::vector<std::uint8_t> mask;
    std::vector<float> heights;
    HeightTally tally;
  };
  std::array<Strip, 2> strips;
  tbb::task_group worker;
  const std::int32_t tile_rows = (height + kTileSide - 1) / kTileSide;
  Status status;
  for (std::int32_t i = 0; i < tile_rows && status; ++i) {
    // Strips follow the order of the file, so that compressed blocks are unpacked once.
    const std::int32_t tr = plan.top_down ? tile_rows - 1 - i : i;
    const std::int32_t row = tr * kTileSide;
    const std::int32_t rows = std::min(kTileSide, height - row);
    const std::int32_t file_row = plan.top_down ? height - row - rows : row;
    Strip& strip = strips[static_cast<std::size_t>(i % 2)];
    const auto samples = static_cast<std::size_t>(width) * rows;
    strip.numbers.resize(samples);
    strip.heights.resize(samples);
    CPLErr error = GDALRasterIO(plan.band, GF_Read, 0, file_row, width, rows, strip.numbers.data(), width,
                                rows, type, 0, 0);
    if (error == CE_None && plan.mask != nullptr) {
      strip.mask.resize(samples);
      error = GDALRasterIO(plan.mask, GF_Read, 0, file_row, width, rows, strip.mask.data(), width, rows,
                           GDT_Byte, 0, 0);
    }
    worker.wait();
    if (error != CE_None || gdal.failed())
      status = inputError("the samples cannot be read: " + gdal.reason("the file is damaged"), path,
                          "the file is cut short or damaged");
    else if (job.cancelled())
      status = cancelled();
    else
      worker.run([&strip, &plan, &builder, width, row, rows] {
        plan.rule.convert(strip.numbers.data(), strip.heights.data(), strip.numbers.size(), strip.tally);
        for (std::size_t k = 0; k < strip.mask.size(); ++k)
          if (strip.mask[k] == 0) strip.heights[k] = std::numeric_limits<float>::quiet_NaN();
        for (std::int32_t r = 0; r < rows && plan.right_to_left; ++r)
          std::reverse(strip.heights.begin() + std::ptrdiff_t{r} * width,
                       strip.heights.begin() + std::ptrdiff_t{r + 1} * width);
        const float* first = strip.heights.data() + (plan.top_down ? std::ptrdiff_t{rows - 1} * width : 0);
        builder.writeHeights(0, row, width, rows, first, plan.top_down ? -width : width);
      });
    job.advance(static_cast<std::uint64_t>(rows));
  }
  worker.wait();
  for (const Strip& strip : strips) total.merge(strip.tally);
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
  const Result<TiffDirectory> directory = readTiffDirectory(file);
  if (!directory) return tl::unexpected(directory.error());
  const std::uint64_t row_bytes = directory->width * directory->bits / 8;
  if (Status s = checkFieldSize(directory->width, directory->height, row_bytes * kTileSide * 4, path); !s)
    return tl::unexpected(s.error());
  if (Status s =
          checkPromise(directory->rawBytes(), directory->stored_bytes, directory->largestRatio(), path);
      !s)
    return tl::unexpected(s.error());
  if (directory->cut)
    return inputError("the samples reach past the end of the file", path, "the file is cut short");

  std::vector<std::string> warnings;
  GdalSession gdal;
  const std::array<const char*, 2> drivers{"GTiff", nullptr};
  const std::array<const char*, 3> open_options{"NUM_THREADS=ALL_CPUS", "GEOREF_SOURCES=INTERNAL,WORLDFILE",
                                                nullptr};
  const DatasetPtr dataset(GDALOpenEx(file.pathForGdal().c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY,
                                      drivers.data(), open_options.data(), nullptr));
  if (!dataset)
    return inputError("the TIFF cannot be opened: " + gdal.reason("damaged header"), path,
                      "the file is damaged or of a kind that the library does not know");
  const Result<GDALRasterBandH> band = heightBand(dataset.get(), path, warnings);
  if (!band) return tl::unexpected(band.error());
  const int width = GDALGetRasterXSize(dataset.get());
  const int height = GDALGetRasterYSize(dataset.get());
  if (Status s =
          checkFieldSize(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), 0, path);
      !s)
    return tl::unexpected(s.error());
  if (char** pages = GDALGetMetadata(dataset.get(), "SUBDATASETS"); pages != nullptr && pages[0] != nullptr)
    warnings.emplace_back("the file holds several pictures, the first was read");

  const GDALDataType type = GDALGetRasterDataType(*band);
  const char* pixel_type = GDALGetMetadataItem(*band, "PIXELTYPE", "IMAGE_STRUCTURE");
  const bool signed_byte = pixel_type != nullptr && std::strcmp(pixel_type, "SIGNEDBYTE") == 0;

  StatedUnits units;
  std::optional<GeoTransform> transform;
  Grid grid;
  readGeoReference(dataset.get(), *directory, transform, grid.crs_wkt, units, warnings);
  grid.width = width;
  grid.height = height;
  Plan plan;
  plan.band = *band;
  if (transform) {
    const Result<RasterPlacement> placement = placementOf(*transform, width, height, path);
    if (!placement) return tl::unexpected(placement.error());
    units.spacing = std::pair{placement->spacing_x, placement->spacing_y};
    grid.origin_x = placement->origin_x;
    grid.origin_y = placement->origin_y;
    plan.top_down = placement->top_down;
    plan.right_to_left = placement->right_to_left;
    if (!plan.top_down)
      warnings.emplace_back(
          "the file's rows run upwards: rows are counted from the highest y here, in marks too");
    if (plan.right_to_left)
      warnings.emplace_back(
          "the file's columns run leftwards: columns are counted from the lowest x here, in marks too");
  }
  if (const char* name = GDALGetRasterUnitType(*band); name != nullptr && name[0] != '\0') {
    units.height = lengthUnitFromName(name);
    if (!units.height && !options.unit)
      warnings.push_back(fmt::format("the height unit \"{}\" is not known, give --unit", name));
  }
  if (!grid.crs_wkt.empty())
    unitsOfCrs(grid.crs_wkt, grid.origin_y + 0.5 * height * (units.spacing ? units.spacing->second : 0.0),
               units, warnings);
  readOwnMetadata(dataset.get(), units, grid, units.spacing.value_or(std::pair{1.0, 1.0}));
  settleUnits(grid, units, options, warnings);

  int has = 0;
  plan.rule.scale = GDALGetRasterScale(*band, &has);
  if (has == 0) plan.rule.scale = 1.0;
  plan.rule.offset = GDALGetRasterOffset(*band, &has);
  if (has == 0) plan.rule.offset = 0.0;
  if (options.z_scale) {
    if (plan.rule.scale != 1.0 || plan.rule.offset != 0.0)
      warnings.push_back(fmt::format("the file says height = number * {} + {}, taken as number * {} as asked",
                                     plan.rule.scale, plan.rule.offset, *options.z_scale));
    plan.rule.scale = *options.z_scale;
    plan.rule.offset = 0.0;
  }
  if (isInteger(type)) grid.height_per_count = plan.rule.offset == 0.0 ? std::abs(plan.rule.scale) : 0.0;
  plan.rule.declared_no_data = declaredNoData(*band, type);
  plan.rule.user_no_data = options.no_data;
  const int mask_flags = GDALGetMaskFlags(*band);
  if ((mask_flags & GMF_PER_DATASET) != 0 && (mask_flags & GMF_ALPHA) == 0)
    plan.mask = GDALGetMaskBand(*band);

  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), path);
  if (!builder) return tl::unexpected(builder.error());
  gdal.clear();
  job.begin("reading", static_cast<std::uint64_t>(height));
  HeightTally tally;
  Status status;
  const bool known = withSampleType(type, signed_byte, [&](auto zero) {
    status = readSamples<decltype(zero)>(plan, type, *builder, tally, gdal, path, job);
  });
  if (!known) return inputError("the samples are of a type that cannot be heights", path);
  if (!status) return tl::unexpected(status.error());
  return finishImport(std::move(*builder), tally, "GTiff", std::move(warnings), path);
}

}  // namespace fettle::engine
