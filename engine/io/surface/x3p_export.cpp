// x3p (ISO 25178-72:2017): a zip of main.xml, the heights in metres as one block of bytes, and checksums.

#include <bit>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/io/files/md5.h"
#include "engine/io/files/zip_archive.h"
#include "engine/io/format.h"
#include "engine/io/grid_notes.h"

namespace fettle::engine {

namespace {

std::string mainXml(const Grid& grid, char type, const std::string& checksum) {
  // 15 digits: 2.5e-06, not 2.4999999999999998e-06. The notes have every digit.
  const double metre_xy = grid.lateral_unit.mm / 1000.0;
  const auto axis = [&](const char* name, double spacing, double origin) {
    return fmt::format(
        "      <{0}>\n        <AxisType>I</AxisType>\n        <DataType>D</DataType>\n"
        "        <Increment>{1:.15g}</Increment>\n        <Offset>{2:.15g}</Offset>\n      </{0}>\n",
        name, spacing * metre_xy, origin * metre_xy);
  };
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<p:ISO5436_2 xmlns:p=\"http://www.opengps.eu/2008/ISO5436_2\">\n"
      "  <Record1>\n    <Revision>ISO5436 - 2000</Revision>\n    <FeatureType>SUR</FeatureType>\n"
      "    <Axes>\n{}{}      <CZ>\n        <AxisType>A</AxisType>\n        <DataType>{}</DataType>\n"
      "        <Increment>1</Increment>\n        <Offset>0</Offset>\n      </CZ>\n"
      "    </Axes>\n  </Record1>\n"
      "  <Record3>\n    <MatrixDimension>\n      <SizeX>{}</SizeX>\n      <SizeY>{}</SizeY>\n"
      "      <SizeZ>1</SizeZ>\n    </MatrixDimension>\n    <DataLink>\n"
      "      <PointDataLink>bindata/data.bin</PointDataLink>\n"
      "      <MD5ChecksumPointData>{}</MD5ChecksumPointData>\n    </DataLink>\n  </Record3>\n"
      "  <Record4>\n    <ChecksumFile>md5checksum.hex</ChecksumFile>\n  </Record4>\n"
      "</p:ISO5436_2>\n",
      axis("CX", grid.spacing_x, grid.origin_x), axis("CY", grid.spacing_y, grid.origin_y), type, grid.width,
      grid.height, checksum);
}

static_assert(std::endian::native == std::endian::little, "x3p stores numbers little-endian");

// Rows from the top, as in other programs, each number as Number in metres.
template <class Number>
Status writeHeights(const Version& field, ZipWriter& zip, Md5& md5, JobControl& job) {
  const Grid& grid = field.grid();
  const double metre = grid.height_unit.mm / 1000.0;
  const auto width = static_cast<std::size_t>(grid.width);
  if (Status status =
          zip.begin("bindata/data.bin", static_cast<std::uint64_t>(grid.samples()) * sizeof(Number));
      !status)
    return status;
  std::vector<float> heights(width);
  std::vector<Number> numbers(width);
  job.begin("writing", static_cast<std::uint64_t>(grid.height));
  const FieldReader reader = field.reader();
  for (std::int32_t row = grid.height - 1; row >= 0; --row) {
    reader.readHeights(0, row, grid.width, 1, heights.data(), grid.width);
    for (std::size_t c = 0; c < width; ++c) {
      if constexpr (sizeof(Number) == sizeof(float))
        numbers[c] = heights[c];
      else
        numbers[c] = static_cast<double>(heights[c]) * metre;
    }
    const std::string_view bytes(reinterpret_cast<const char*>(numbers.data()), width * sizeof(Number));
    md5.add(bytes);
    if (Status status = zip.write(bytes.data(), bytes.size()); !status) return status;
    if (job.cancelled()) return cancelled();
    job.advance();
  }
  return {};
}

Status writeAll(const Version& field, ZipWriter& zip, JobControl& job) {
  const Grid& grid = field.grid();
  // Metres are stored unchanged as floats. For another unit the product takes the digits of a double; divided
  // again it rounds to exactly the original float.
  const bool metres = grid.height_unit.mm == 1000.0;
  Md5 md5;
  if (Status status =
          metres ? writeHeights<float>(field, zip, md5, job) : writeHeights<double>(field, zip, md5, job);
      !status)
    return status;
  const std::string xml = mainXml(grid, metres ? 'F' : 'D', md5.hex());
  md5.add(xml);
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"main.xml", xml},
                                   {"md5checksum.hex", md5.hex() + " *main.xml\n"},
                                   {"fettle.txt", gridNotes(grid)}}) {
    if (Status status = zip.begin(name, text.size()); !status) return status;
    if (Status status = zip.write(text.data(), text.size()); !status) return status;
  }
  return zip.finish();
}

}  // namespace

// ISO 25178-72, metres: float32 where the field is in metres, otherwise float64, and every digit of units,
// spacing and origin in an entry of its own, so that each float is restored.
Result<Exported> writeX3p(const Version& field, const std::string& path, const ExportOptions&,
                          JobControl& job) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  ZipWriter zip(*file);
  if (Status status = writeAll(field, zip, job); !status) return tl::unexpected(status.error());
  if (Status done = file->commit(); !done) return tl::unexpected(done.error());
  std::vector<std::string> warnings;
  if (!field.grid().crs_wkt.empty())
    warnings.emplace_back(
        "x3p has no coordinate system: it is kept in an entry that only this program reads");
  return Exported{"X3P", std::move(warnings)};
}

}  // namespace fettle::engine
