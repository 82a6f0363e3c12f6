#include "engine/io/raster/marks.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gdal.h>

#include "engine/field/live_field.h"
#include "engine/io/files/atomic_file.h"
#include "engine/io/files/gdal_session.h"
#include "engine/io/format.h"
#include "engine/io/raster/png_stream.h"
#include "engine/io/tiff/tiff_directory.h"

namespace fettle::engine {

namespace {

// Sets the marks of a field one tile row at a time, from the rows of a picture from top to bottom.
class MarkSetter {
 public:
  explicit MarkSetter(const Version& field)
      : live_(field, Growth::kAllowed), width_(field.grid().width), height_(field.grid().height) {
    strip_.resize(static_cast<std::size_t>(width_) * kTileSide);
  }

  // `row` counts from the bottom, and decreases from call to call. False when memory ran out.
  [[nodiscard]] bool take(std::int32_t row, const unsigned char* pixels) {
    std::memcpy(strip_.data() + static_cast<std::size_t>(row % kTileSide) * width_, pixels,
                static_cast<std::size_t>(width_));
    return row % kTileSide != 0 || applyTileRow(row / kTileSide);
  }
  [[nodiscard]] Version result() { return live_.snapshot(); }

 private:
  [[nodiscard]] bool applyTileRow(std::int32_t tr) {
    const std::int32_t rows = std::min(kTileSide, height_ - tr * kTileSide);
    for (std::int32_t tc = 0; tc * kTileSide < width_; ++tc) {
      const std::int32_t columns = std::min(kTileSide, width_ - tc * kTileSide);
      std::array<std::uint64_t, kTileSide> marks{};
      for (std::int32_t r = 0; r < rows; ++r) {
        const unsigned char* from = strip_.data() + static_cast<std::size_t>(r) * width_ + tc * kTileSide;
        for (std::int32_t c = 0; c < columns; ++c)
          marks[static_cast<std::size_t>(r)] |= std::uint64_t{from[c] != 0} << c;
      }
      const Tile& old = live_.reader().tile(tc, tr);
      if (old.marks == marks) continue;
      TileRef fresh = live_.newTile();
      if (!fresh) return false;
      *fresh = old;
      fresh->marks = marks;
      refreshMarks(*fresh);
      if (!live_.replaceTile(tc, tr, std::move(fresh))) return false;
    }
    return true;
  }

  LiveField live_;
  std::int32_t width_;
  std::int32_t height_;
  std::vector<unsigned char> strip_;  // one tile row, lowest row first
};

Status checkSize(const Version& field, std::int64_t width, std::int64_t height, const std::string& path) {
  if (width == field.grid().width && height == field.grid().height) return {};
  return inputError(fmt::format("the marks are {} x {}, the field is {} x {}", width, height,
                                field.grid().width, field.grid().height),
                    path, "take the marks that belong to this field");
}

Result<Version> noMemory(const std::string& path) {
  return failure("there is not enough memory for the marks", path);
}

Result<Version> fromPng(const Version& field, const InputFile& file) {
  Result<PngReader> reader = PngReader::open(file);
  if (!reader) return tl::unexpected(reader.error());
  const PngHeader& header = reader->header();
  if (header.bits > 8)
    return inputError("the PNG has 16 bits, marks have 8", file.path(), "is this the scan itself?");
  if (Status s = checkSize(field, header.width, header.height, file.path()); !s)
    return tl::unexpected(s.error());
  MarkSetter setter(field);
  std::vector<unsigned char> row(static_cast<std::size_t>(header.width));
  for (std::int32_t r = header.height - 1; r >= 0; --r) {
    if (Status s = reader->readRow(row.data()); !s) return tl::unexpected(s.error());
    if (!setter.take(r, row.data())) return noMemory(file.path());
  }
  if (Status s = reader->finish(); !s) return tl::unexpected(s.error());
  return setter.result();
}

Result<Version> fromTiff(const Version& field, const InputFile& file) {
  const Result<TiffDirectory> directory = readTiffDirectory(file);
  if (!directory) return tl::unexpected(directory.error());
  if (Status s = checkSize(field, static_cast<std::int64_t>(directory->width),
                           static_cast<std::int64_t>(directory->height), file.path());
      !s)
    return tl::unexpected(s.error());
  if (directory->photometric == 0)
    return inputError("0 is white in these marks (MINISWHITE): what is kept, white or black?", file.path(),
                      "write them with 0 as black, e.g. as PNG");
  if (directory->cut)
    return inputError("the marks reach past the end of the file", file.path(), "the file is cut short");
  GdalSession gdal;
  const std::array<const char*, 2> drivers{"GTiff", nullptr};
  const DatasetPtr dataset(GDALOpenEx(file.pathForGdal().c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY,
                                      drivers.data(), nullptr, nullptr));
  if (!dataset) return inputError("the TIFF cannot be opened: " + gdal.reason("damaged header"), file.path());
  GDALRasterBandH band = GDALGetRasterBand(dataset.get(), 1);
  if (GDALGetRasterCount(dataset.get()) != 1 || GDALGetRasterDataType(band) != GDT_Byte)
    return inputError("marks are one band of 8 bits", file.path(), "is this the scan itself?");
  MarkSetter setter(field);
  const std::int32_t width = field.grid().width;
  std::vector<unsigned char> row(static_cast<std::size_t>(width));
  for (std::int32_t r = field.grid().height - 1; r >= 0; --r) {
    if (GDALRasterIO(band, GF_Read, 0, field.grid().height - 1 - r, width, 1, row.data(), width, 1, GDT_Byte,
                     0, 0) != CE_None ||
        gdal.failed())
      return inputError("the marks cannot be read: " + gdal.reason("the file is damaged"), file.path(),
                        "the file is cut short or damaged");
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
  GdalSession gdal;
  const auto full = [&] {
    return tl::unexpected(
        file.explained(failure("the file cannot be written: " + gdal.reason("the library gives no reason"),
                               file.finalPath(), "check the disk or choose another folder")
                           .value()));
  };
  const std::array<const char*, 3> options{"COMPRESS=DEFLATE", "BIGTIFF=IF_SAFER", nullptr};
  const std::int32_t width = field.grid().width;
  const std::int32_t height = field.grid().height;
  DatasetPtr dataset(GDALCreate(GDALGetDriverByName("GTiff"), file.temporaryPath().c_str(), width, height, 1,
                                GDT_Byte, options.data()));
  if (!dataset) return full();
  GDALRasterBandH band = GDALGetRasterBand(dataset.get(), 1);
  std::vector<std::uint8_t> row(static_cast<std::size_t>(width));
  for (std::int32_t r = height - 1; r >= 0; --r) {
    readRow(field.reader(), r, row);
    if (GDALRasterIO(band, GF_Write, 0, height - 1 - r, width, 1, row.data(), width, 1, GDT_Byte, 0, 0) !=
        CE_None)
      return full();
  }
  GDALFlushCache(dataset.get());
  dataset.reset();
  return gdal.failed() ? Status(full()) : Status{};
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
