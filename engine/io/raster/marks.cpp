#include "engine/io/raster/marks.h"

#include <array>
#include <limits>
#include <new>
#include <optional>
#include <unordered_set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/field/mark_setter.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/files/gdal_calls.h"
#include "engine/io/files/gdal_session.h"
#include "engine/io/format.h"
#include "engine/io/geo/crs_text.h"
#include "engine/io/geo/geo_reference.h"
#include "engine/io/geo/sidecar.h"
#include "engine/io/raster/marks_fit.h"
#include "engine/io/raster/png_stream.h"
#include "engine/io/tiff/tiff_directory.h"

namespace fettle::engine {

namespace {

Result<Version> noMemory(const std::string& path) {
  return failure("there is not enough memory for the marks", path);
}

Result<Version> fromPng(const Version& field, const InputFile& file) {
  Result<PngReader> reader = PngReader::open(file);
  if (!reader) return tl::unexpected(reader.error());
  const PngHeader& header = reader->header();
  if (header.bits > 8)
    return inputError("the PNG has 16 bits, marks have 8", file.path(), "is this the scan itself?");
  const auto part = partOfMarks(field.grid(), {header.width, header.height, {}, {}}, file.path());
  if (!part) return tl::unexpected(part.error());
  MarkSetter setter(field);
  std::vector<unsigned char> row(static_cast<std::size_t>(header.width));
  for (std::int32_t r = header.height - 1; r >= 0; --r) {
    if (Status s = reader->readRow(row.data()); !s) return tl::unexpected(s.error());
    if (!setter.take(r, row.data())) return noMemory(file.path());
  }
  if (Status s = reader->finish(); !s) return tl::unexpected(s.error());
  return setter.result();
}

// What a TIFF states about its place, also in NAME.tif.aux.xml.
MarksPlace placeOf(GDALDatasetH dataset, const Sidecar& sidecar) {
  MarksPlace place;
  place.width = gdal().GDALGetRasterXSize(dataset);
  place.height = gdal().GDALGetRasterYSize(dataset);
  GeoTransform gt{};
  if (gdal().GDALGetGeoTransform(dataset, gt.data()) == CE_None) place.transform = gt;
  if (OGRSpatialReferenceH crs = gdal().GDALGetSpatialRef(dataset); crs != nullptr)
    place.crs_wkt = wktOf(crs);
  if (place.crs_wkt.empty()) place.crs_wkt = sidecar.crs_wkt;
  return place;
}

// The rows of a band of integers as marks.
class MarkBand {
 public:
  // `columns` pixels of each row, from `first` on.
  MarkBand(GDALRasterBandH band, std::int32_t first, std::int32_t columns, const Sidecar& sidecar)
      : band_(band),
        first_(first),
        numbers_(static_cast<std::size_t>(columns)),
        type_(gdal().GDALGetRasterDataType(band)) {
    const char* const pixels = gdal().GDALGetMetadataItem(band, "PIXELTYPE", "IMAGE_STRUCTURE");
    signed_byte_ = pixels != nullptr && std::strcmp(pixels, "SIGNEDBYTE") == 0;
    int has = 0;
    double none = 0.0;
    if (type_ == GDT_Int64)
      none = static_cast<double>(gdal().GDALGetRasterNoDataValueAsInt64(band, &has));
    else if (type_ == GDT_UInt64)
      none = static_cast<double>(gdal().GDALGetRasterNoDataValueAsUInt64(band, &has));
    else
      none = gdal().GDALGetRasterNoDataValue(band, &has);
    std::vector<std::string> ignored;
    no_data_ = chooseNoData(has != 0 ? std::optional(none) : std::nullopt, sidecar, ignored);
  }

  [[nodiscard]] bool holdsIntegers() const noexcept {
    return type_ != GDT_Unknown && gdal().GDALDataTypeIsInteger(type_) != 0 &&
           gdal().GDALDataTypeIsComplex(type_) == 0;
  }
  // A stored row; false where it cannot be read.
  [[nodiscard]] bool read(std::int32_t row) {
    const auto columns = static_cast<int>(numbers_.size());
    // A double has every number of 32 bits; of 64 it still tells 0 from others.
    if (gdal().GDALRasterIO(band_, GF_Read, first_, row, columns, 1, numbers_.data(), columns, 1, GDT_Float64,
                            0, 0) != CE_None)
      return false;
    if (type_ != GDT_Byte && values_.size() <= kMostMarkValues) {
      double before = std::numeric_limits<double>::quiet_NaN();
      for (const double number : numbers_)
        if (number != before) values_.insert(before = number);
    }
    return true;
  }
  [[nodiscard]] bool looksLikeScan() const noexcept { return values_.size() > kMostMarkValues; }
  // The marks of the row that was read, 0 or 1.
  void marks(std::vector<unsigned char>& row) const {
    std::ranges::transform(numbers_, row.begin(), [&](double number) {
      if (signed_byte_ && number > 127.0) number -= 256.0;
      return static_cast<unsigned char>(number != 0.0 && !(no_data_ && number == *no_data_));
    });
  }

 private:
  GDALRasterBandH band_;
  std::int32_t first_;
  std::vector<double> numbers_;
  GDALDataType type_;
  bool signed_byte_ = false;  // GDAL 3.6 has no type of its own for these
  std::optional<double> no_data_;
  std::unordered_set<double> values_;  // of more than 8 bits; not all once they are too many
};

Result<Version> fromTiff(const Version& field, const InputFile& file) {
  const Result<TiffDirectory> directory = readTiffDirectory(file);
  if (!directory) return tl::unexpected(directory.error());
  if (directory->photometric == 0)
    return inputError("0 is white in these marks (MINISWHITE): what is kept, white or black?", file.path(),
                      "write them with 0 as black, e.g. as PNG");
  if (directory->cut)
    return inputError("the marks reach past the end of the file", file.path(), "the file is cut short");
  GdalSession session;
  const std::array<const char*, 2> drivers{"GTiff", nullptr};
  const DatasetPtr dataset(gdal().GDALOpenEx(file.pathForGdal().c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY,
                                             drivers.data(), nullptr, nullptr));
  if (!dataset)
    return inputError("the TIFF cannot be opened: " + session.reason("damaged header"), file.path());
  std::vector<std::string> ignored;
  const Sidecar sidecar = readAuxXml(file.path(), ignored);
  const auto part = partOfMarks(field.grid(), placeOf(dataset.get(), sidecar), file.path());
  if (!part) return tl::unexpected(part.error());
  const std::int32_t width = field.grid().width, height = field.grid().height;
  MarkBand band(gdal().GDALGetRasterBand(dataset.get(), 1), part->first_column, width, sidecar);
  if (gdal().GDALGetRasterCount(dataset.get()) != 1 || !band.holdsIntegers())
    return inputError("marks are one band of integers", file.path(), "is this the scan itself?");
  MarkSetter setter(field);
  std::vector<unsigned char> row(static_cast<std::size_t>(width));
  for (std::int32_t r = height - 1; r >= 0; --r) {
    if (!band.read(part->first_row + (part->top_down ? height - 1 - r : r)) || session.failed())
      return inputError("the marks cannot be read: " + session.reason("the file is damaged"), file.path(),
                        "the file is cut short or damaged");
    if (band.looksLikeScan())
      return inputError(fmt::format("marks have at most {} different numbers", kMostMarkValues), file.path(),
                        "is this the scan itself?");
    band.marks(row);
    if (part->right_to_left) std::ranges::reverse(row);
    if (!setter.take(r, row.data())) return noMemory(file.path());
  }
  return setter.result();
}

// Row r from the bottom, 0 and 255.
void readRow(const FieldReader& reader, std::int32_t r, std::vector<std::uint8_t>& row) {
  reader.readMarks(0, r, reader.width(), 1, row.data(), reader.width());
  for (std::uint8_t& pixel : row) pixel = pixel != 0 ? 255 : 0;
}

Status toPng(const Version& field, AtomicFile& file) {
  PngHeader header;
  header.width = field.grid().width;
  header.height = field.grid().height;
  header.bits = 8;
  Result<PngWriter> writer = PngWriter::create(file, header, "keep mask: 255 = keep");
  if (!writer) return tl::unexpected(writer.error());
  std::vector<std::uint8_t> row(static_cast<std::size_t>(header.width));
  for (std::int32_t r = header.height - 1; r >= 0; --r) {
    readRow(field.reader(), r, row);
    if (Status s = writer->writeRow(row.data()); !s) return s;
  }
  return writer->finish();
}

Status toTiff(const Version& field, const AtomicFile& file) {
  GdalSession session;
  const auto full = [&] {
    return tl::unexpected(
        file.explained(failure("the file cannot be written: " + session.reason("the library gives no reason"),
                               file.finalPath(), "check the disk or choose another folder")
                           .value()));
  };
  const std::array<const char*, 3> options{"COMPRESS=DEFLATE", "BIGTIFF=IF_SAFER", nullptr};
  const std::int32_t width = field.grid().width;
  const std::int32_t height = field.grid().height;
  DatasetPtr dataset(gdal().GDALCreate(gdal().GDALGetDriverByName("GTiff"), file.temporaryPath().c_str(),
                                       width, height, 1, GDT_Byte, options.data()));
  if (!dataset) return full();
  GeoTransform gt = geoTransformOf(field.grid());
  if (gdal().GDALSetGeoTransform(dataset.get(), gt.data()) != CE_None) return full();
  if (const std::string& wkt = field.grid().crs_wkt; !wkt.empty())
    if (OGRSpatialReferenceH crs = gdal().OSRNewSpatialReference(wkt.c_str()); crs != nullptr) {
      gdal().OSRSetAxisMappingStrategy(crs, OAMS_TRADITIONAL_GIS_ORDER);
      const bool set = gdal().GDALSetSpatialRef(dataset.get(), crs) == CE_None;
      gdal().OSRDestroySpatialReference(crs);
      if (!set) return full();
    }
  GDALRasterBandH band = gdal().GDALGetRasterBand(dataset.get(), 1);
  std::vector<std::uint8_t> row(static_cast<std::size_t>(width));
  for (std::int32_t r = height - 1; r >= 0; --r) {
    readRow(field.reader(), r, row);
    if (gdal().GDALRasterIO(band, GF_Write, 0, height - 1 - r, width, 1, row.data(), width, 1, GDT_Byte, 0,
                            0) != CE_None)
      return full();
  }
  gdal().GDALFlushCache(dataset.get());
  dataset.reset();
  return session.failed() ? Status(full()) : Status{};
}

}  // namespace

Result<Version> importMarks(const Version& field, const std::string& path) {
  const Result<InputFile> file = InputFile::open(path);
  if (!file) return tl::unexpected(file.error());
  std::array<char, 16> head{};
  const Result<std::size_t> got = file->read(0, head.data(), head.size());
  if (!got) return tl::unexpected(got.error());
  try {
    if (kPngFormat.recognises({head.data(), *got}, {})) return fromPng(field, *file);
    if (kTiffFormat.recognises({head.data(), *got}, {})) return fromTiff(field, *file);
  } catch (const std::bad_alloc&) {
    return noMemory(path);
  }
  return inputError("marks are neither PNG nor TIFF", path, "give an 8-bit grey picture");
}

Status exportMarks(const Version& field, const std::string& path) {
  const std::string extension = extensionOf(path);
  if (extension != ".png" && extension != ".tif" && extension != ".tiff")
    return inputError("marks are written as PNG or TIFF", path, "use .png or .tif");
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  try {
    if (Status status = extension == ".png" ? toPng(field, *file) : toTiff(field, *file); !status)
      return status;
  } catch (const std::bad_alloc&) {
    return failure("there is not enough memory for the marks", path);
  }
  return file->commit();
}

}  // namespace fettle::engine
