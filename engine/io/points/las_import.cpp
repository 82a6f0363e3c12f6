// LAS 1.0 to 1.4: points of airborne and terrestrial laser scanners (ASPRS, "LAS Specification 1.4 - R15",
// 2019). Coordinates are 32-bit integers times a scale plus an offset; other data of points are not read.
// LAZ, the compressed form, is refused with a message: no library of Debian 12 decompresses it.

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "engine/io/files/gdal_calls.h"
#include "engine/io/files/gdal_session.h"
#include "engine/io/files/little_endian.h"
#include "engine/io/files/text_reader.h"
#include "engine/io/format.h"
#include "engine/io/geo/crs_text.h"
#include "engine/io/geo/geo_reference.h"
#include "engine/io/points/gridding.h"

namespace fettle::engine {

namespace {

constexpr std::size_t kSmallestHeader = 227;
constexpr std::size_t kHeader14 = 375;
constexpr std::size_t kRecordHeader = 54;
constexpr std::uint16_t kGeoKeys = 34735;
constexpr std::uint16_t kGeoNumbers = 34736;
constexpr std::uint16_t kGeoText = 34737;
constexpr std::uint16_t kWkt = 2112;
// Least bytes of each point format, 0 .. 10.
constexpr std::array<std::uint16_t, 11> kPointBytes = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

struct LasHeader {
  int minor = 0;
  int format = 0;
  bool wkt_holds = false;
  std::uint16_t header_bytes = 0;
  std::uint32_t records = 0;
  std::uint64_t points_at = 0;
  std::uint16_t stride = 0;
  std::uint64_t points = 0;
  std::array<double, 3> scale{}, offset{};
  double low_y = 0.0, high_y = 0.0;
};

Result<LasHeader> readHeader(const InputFile& file) {
  std::array<char, kHeader14> h{};
  const Result<std::size_t> got = file.read(0, h.data(), h.size());
  if (!got) return tl::unexpected(got.error());
  if (*got < kSmallestHeader)
    return inputError("the header is cut short", file.path(), "the file is cut short");
  LasHeader out;
  out.minor = static_cast<unsigned char>(h[25]);
  if (h[24] != 1 || out.minor > 4)
    return inputError(fmt::format("LAS {}.{} is not known", static_cast<int>(h[24]), out.minor), file.path(),
                      "write it as LAS 1.2 or 1.4");
  constexpr unsigned kWktBit = 1U << 4;  // of the global encoding
  out.wkt_holds = (little<std::uint16_t>(&h[6]) & kWktBit) != 0;
  out.header_bytes = little<std::uint16_t>(&h[94]);
  out.points_at = little<std::uint32_t>(&h[96]);
  out.records = little<std::uint32_t>(&h[100]);
  const auto format = static_cast<unsigned char>(h[104]);
  // LASzip marks its files in the two highest bits, which LAS does not use.
  if ((format & 0xC0U) != 0)
    return inputError(
        "the points are packed (LAZ), which Fettle does not read", file.path(),
        "unpack it to LAS first: pdal translate IN.laz OUT.las, or las2las -i IN.laz -o OUT.las");
  out.format = format;
  if (out.format >= static_cast<int>(kPointBytes.size()))
    return inputError(fmt::format("point format {} is not known", out.format), file.path(),
                      "write it with point format 0 to 10");
  out.stride = little<std::uint16_t>(&h[105]);
  out.points = little<std::uint32_t>(&h[107]);
  if (out.minor >= 4 && *got >= kHeader14 && out.header_bytes >= kHeader14 && out.points == 0)
    out.points = little<std::uint64_t>(&h[247]);
  for (std::size_t k = 0; k < 3; ++k) {
    out.scale[k] = little<double>(&h[131 + 8 * k]);
    out.offset[k] = little<double>(&h[155 + 8 * k]);
    if (!std::isfinite(out.scale[k]) || out.scale[k] == 0.0 || !std::isfinite(out.offset[k]))
      return inputError("the header's scales are not numbers", file.path(), "the file is damaged");
  }
  out.high_y = little<double>(&h[195]);
  out.low_y = little<double>(&h[203]);
  const auto damaged = [&](const char* what) { return inputError(what, file.path(), "the file is damaged"); };
  if (out.header_bytes < kSmallestHeader || out.points_at < out.header_bytes || out.points_at > file.size())
    return damaged("the header's offsets point outside the file");
  if (out.stride < kPointBytes[static_cast<std::size_t>(out.format)])
    return damaged("a point takes fewer bytes than its format needs");
  if (out.points == 0) return inputError("the file holds no points", file.path(), "give a file with points");
  if (out.points > (file.size() - out.points_at) / out.stride)
    return inputError("the file ends before all that its header states", file.path(),
                      "the file is cut short");
  return out;
}

// The length units named by GeoTIFF keys (OGC 19-008, 7.1 and 7.3), for files without a complete system.
LengthUnit unitOfCode(std::uint16_t code) {
  return *lengthUnitFromName(code == 9002 ? "ft" : code == 9003 ? "ftUS" : "m");
}

void takeGeoKeys(std::string_view keys, PointCloud& cloud) {
  constexpr std::uint16_t kProjectedUnits = 3076;
  constexpr std::uint16_t kVerticalUnits = 4099;
  for (std::size_t at = 8; at + 8 <= keys.size(); at += 8) {
    const auto key = little<std::uint16_t>(keys.data() + at);
    const auto value = little<std::uint16_t>(keys.data() + at + 6);
    if (value < 9001 || value > 9003) continue;
    if (key == kProjectedUnits && !cloud.unit) cloud.unit = unitOfCode(value);
    if (key == kVerticalUnits && !cloud.height_unit) cloud.height_unit = unitOfCode(value);
  }
}

// Sets the system that a WKT names, and its units; false where it cannot be parsed.
[[nodiscard]] bool takeSystem(std::string wkt, const LasHeader& header, PointCloud& cloud) {
  if (wkt.empty()) return false;
  StatedUnits units;
  const double middle = 0.5 * (header.low_y + header.high_y);
  unitsOfCrs(wkt, std::isfinite(middle) ? middle : 0.0, units, cloud.warnings);
  if (!units.lateral) return false;
  cloud.unit = units.lateral;
  cloud.height_unit = units.height;
  cloud.crs_wkt = std::move(wkt);
  return true;
}

// Whether two texts name the same system, ignoring vertical systems, which one of them may lack.
bool sameSystem(const std::string& a, const std::string& b) {
  const auto horizontal = [](const std::string& wkt) {
    CrsPtr crs(gdal().OSRNewSpatialReference(wkt.c_str()));
    if (crs) gdal().OSRStripVertical(crs.get());
    return crs;
  };
  const CrsPtr one = horizontal(a), other = horizontal(b);
  const char* const options[] = {"CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS",
                                 "IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES", nullptr};
  return one && other && gdal().OSRIsSameEx(one.get(), other.get(), options) != 0;
}

std::string shownSystem(const std::string& wkt) {
  const std::size_t open = wkt.find('"');
  return open == std::string::npos ? wkt : wkt.substr(open + 1, wkt.find('"', open + 1) - open - 1);
}

// Coordinate system and units from the records between header and points: keys, or WKT where the header's bit
// for it is set (LAS 1.4 - R15, "global encoding"); the other one where that is missing or cannot be parsed.
void readSystem(const InputFile& file, const LasHeader& header, PointCloud& cloud) {
  std::uint64_t at = header.header_bytes;
  std::array<char, kRecordHeader> h{};
  GeoKeys keys;
  std::string wkt;
  for (std::uint32_t i = 0; i < header.records && at + kRecordHeader <= header.points_at; ++i) {
    const Result<std::size_t> got = file.read(at, h.data(), h.size());
    if (!got || *got != h.size()) break;
    const auto bytes = little<std::uint16_t>(&h[20]);
    const auto id = little<std::uint16_t>(&h[18]);
    std::string* const wanted = id == kWkt          ? &wkt
                                : id == kGeoKeys    ? &keys.directory
                                : id == kGeoNumbers ? &keys.numbers
                                : id == kGeoText    ? &keys.text
                                                    : nullptr;
    if (wanted != nullptr && std::string_view(&h[2], 15) == "LASF_Projection") {
      wanted->resize(bytes);
      const Result<std::size_t> read = file.read(at + kRecordHeader, wanted->data(), bytes);
      if (!read || *read != bytes) break;
    }
    at += kRecordHeader + bytes;
  }
  wkt.resize(std::min(wkt.find('\0'), wkt.size()));
  const bool named = !wkt.empty() || !keys.directory.empty();
  const GdalSession quiet;
  const std::string keyed = wktOfGeoKeys(keys);
  const std::string &first = header.wkt_holds ? wkt : keyed, &second = header.wkt_holds ? keyed : wkt;
  if (!takeSystem(first, header, cloud)) {
    (void)takeSystem(second, header, cloud);
  } else if (!second.empty() && !sameSystem(first, second)) {
    cloud.warnings.push_back(
        fmt::format("the file names two coordinate systems, {} in {} and {} in {}: the first was used, as "
                    "its header's bit for WKT states",
                    shownSystem(first), header.wkt_holds ? "WKT" : "GeoTIFF keys", shownSystem(second),
                    header.wkt_holds ? "GeoTIFF keys" : "WKT"));
  }
  takeGeoKeys(keys.directory, cloud);
  if (named && cloud.crs_wkt.empty() && cloud.warnings.empty())
    cloud.warnings.push_back(fmt::format("the file's coordinate system cannot be parsed{}",
                                         cloud.unit ? ", only its unit is used" : ""));
}

bool looksLikeLas(std::string_view head, std::string_view) {
  return head.starts_with("LASF");
}

Result<Imported> readLas(const InputFile& file, const ImportOptions& options, JobControl& job) {
  const Result<LasHeader> header = readHeader(file);
  if (!header) return tl::unexpected(header.error());
  PointCloud cloud;
  readSystem(file, *header, cloud);
  for (auto* axis : {&cloud.x, &cloud.y, &cloud.z}) axis->reserve(header->points);
  job.begin("reading", header->points);
  TextReader body(file, header->points_at);
  constexpr std::uint64_t kLook = 65536;
  for (std::uint64_t i = 0; i < header->points; ++i) {
    const char* point = body.bytes(header->stride);
    if (point == nullptr) {
      if (!body.status()) return tl::unexpected(body.status().error());
      return inputError("the file ends before all that its header states", file.path(),
                        "the file is cut short");
    }
    std::array<double, 3> at{};
    for (std::size_t k = 0; k < 3; ++k)
      at[k] = little<std::int32_t>(point + 4 * k) * header->scale[k] + header->offset[k];
    cloud.add(at[0], at[1], at[2]);
    if (i % kLook == kLook - 1) {
      job.advance(kLook);
      if (job.cancelled()) return cancelled();
    }
  }
  return gridPoints(std::move(cloud), options, "LAS", file.path(), job);
}

}  // namespace

constexpr std::string_view kLasExtensions[] = {".las", ".laz"};
constexpr Format kLasFormat{
    .info = {"LAS", "LAS points", kLasExtensions, true, false},
    .recognises = looksLikeLas,
    .read = readLas,
};

}  // namespace fettle::engine
