// SDF (sdf.h), binary unless text is asked for.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/io/files/atomic_file.h"
#include "engine/io/files/little_endian.h"
#include "engine/io/format.h"
#include "engine/io/surface/sdf.h"

namespace fettle::engine {

namespace {

// A length of this unit in metres, by 17 digits at most: 0.25 mm is 2.5e-4, and 1 mm exactly 0.001.
double inMetres(double length, const LengthUnit& unit) {
  return length * unit.mm / 1000.0;
}

// Dates of zeros: not recorded, so that the same field gives the same bytes.
constexpr std::string_view kNoDate = "000000000000";

void appendBinaryHeader(std::string& out, const Grid& grid, bool second) {
  out += second ? "bISO-2.0" : "bISO-1.0";
  out += "Fettle    ";
  out += kNoDate;
  out += kNoDate;
  for (const std::int32_t count : {grid.width, grid.height}) {
    if (second)
      appendLittle(out, static_cast<std::uint32_t>(count));
    else
      appendLittle(out, static_cast<std::uint16_t>(count));
  }
  appendLittle(out, inMetres(grid.spacing_x, grid.lateral_unit));
  appendLittle(out, inMetres(grid.spacing_y, grid.lateral_unit));
  appendLittle(out, inMetres(1.0, grid.height_unit));
  appendLittle(out, -1.0);  // Zresolution: not known
  out += '\0';              // not compressed
  out += static_cast<char>(SdfType::kDouble);
  out += '\0';  // no checksum
}

void appendTextHeader(std::string& out, const Grid& grid, bool second) {
  fmt::format_to(std::back_inserter(out),
                 "{}\r\nManufacID = Fettle\r\nCreateDate = {}\r\nModDate = {}\r\nNumPoints = {}\r\n"
                 "NumProfiles = {}\r\nXscale = {}\r\nYscale = {}\r\nZscale = {}\r\nZresolution = -1\r\n"
                 "Compression = 0\r\nDataType = {}\r\nCheckType = 0\r\n*\r\n",
                 second ? "aISO-2.0" : "aISO-1.0", kNoDate, kNoDate, grid.width, grid.height,
                 inMetres(grid.spacing_x, grid.lateral_unit), inMetres(grid.spacing_y, grid.lateral_unit),
                 inMetres(1.0, grid.height_unit), static_cast<int>(SdfType::kDouble));
}

std::vector<std::string> lostBySdf(const Grid& grid, bool second) {
  std::vector<std::string> warnings;
  if (!grid.crs_wkt.empty()) warnings.emplace_back("SDF has no coordinate system, it was left out");
  if (grid.origin_x != 0.0 || grid.origin_y != 0.0)
    warnings.emplace_back("SDF has no origin, it was left out");
  if (!(grid.lateral_unit == grid.height_unit))
    warnings.push_back(fmt::format("SDF has one unit: spacings in {} are read back in {}",
                                   grid.lateral_unit.name, grid.height_unit.name));
  if (second)
    warnings.emplace_back("a side above 65535 samples needs version 2.0 of SDF, which fewer programs read");
  return warnings;
}

}  // namespace

// ISO 25178-71, version 1.0, or 2.0 where a side is too long for it; heights as doubles, or as decimals, in the field's own
// unit, whose size is Zscale, so that every float is restored. Holes are NaN, as other programs read doubles, and BAD in
// text. Profiles from the top.
Result<Exported> writeSdf(const Version& field, const std::string& path, const ExportOptions& options,
                          JobControl& job) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  const Grid& grid = field.grid();
  const bool second = static_cast<std::uint64_t>(std::max(grid.width, grid.height)) > kSdfMostShort;
  TextWriter out{*file};
  if (options.ascii)
    appendTextHeader(out.text, grid, second);
  else
    appendBinaryHeader(out.text, grid, second);
  const FieldReader reader = field.reader();
  std::vector<float> heights(static_cast<std::size_t>(grid.width));
  job.begin("writing", static_cast<std::uint64_t>(grid.height));
  for (std::int32_t row = grid.height - 1; row >= 0; --row) {
    reader.readHeights(0, row, grid.width, 1, heights.data(), grid.width);
    for (const float z : heights) {
      if (!options.ascii)
        appendLittle(out.text,
                     std::isnan(z) ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(z));
      else if (std::isnan(z))
        out.text += "BAD ";
      else
        fmt::format_to(std::back_inserter(out.text), "{} ", z);
    }
    if (options.ascii) {
      out.text.back() = '\r';
      out.text += '\n';
    }
    if (Status status = out.flushIfLarge(); !status) return tl::unexpected(status.error());
    if (job.cancelled()) return cancelled();
    job.advance();
  }
  if (options.ascii) out.text += "*\r\n*\r\n";  // an empty trailer
  if (Status status = out.flush(); !status) return tl::unexpected(status.error());
  if (Status status = file->commit(); !status) return tl::unexpected(status.error());
  return Exported{"SDF", lostBySdf(grid, second)};
}

}  // namespace fettle::engine
