#include "engine/io/geo/crs_text.h"

#include <cstdint>
#include <vector>

#include "engine/io/files/gdal_calls.h"
#include "engine/io/files/gdal_session.h"
#include "engine/io/files/little_endian.h"

// GDAL reads keys only from TIFFs: they are put into one of a single pixel, in memory.

namespace fettle::engine {

namespace {

std::string crsAs(OGRSpatialReferenceH crs, const char* form) {
  char* text = nullptr;
  const char* const options[] = {form, nullptr};
  std::string out;
  if (gdal().OSRExportToWktEx(crs, &text, options) == OGRERR_NONE && text != nullptr) out = text;
  gdal().CPLFree(text);
  return out;
}

// The registry's system that equals this one in all parameters; null where there is none, or more than one.
CrsPtr registered(OGRSpatialReferenceH crs) {
  constexpr int kSameParameters = 90;  // GDAL: equivalent, the names may differ
  int count = 0;
  int* confidence = nullptr;
  OGRSpatialReferenceH* found = gdal().OSRFindMatches(crs, nullptr, &count, &confidence);
  CrsPtr match;
  if (count > 0 && confidence[0] >= kSameParameters && (count == 1 || confidence[1] < confidence[0]))
    match.reset(gdal().OSRClone(found[0]));
  if (found != nullptr) gdal().OSRFreeSRSArray(found);
  gdal().CPLFree(confidence);
  return match;
}

constexpr std::uint16_t kDirectory = 34735;
constexpr std::uint16_t kNumbers = 34736;
constexpr std::uint16_t kText = 34737;

// Whether every key is inside the directory, and its value inside the tag that it names.
bool keysAreSound(const GeoKeys& keys) {
  const std::size_t shorts = keys.directory.size() / 2;
  const auto number = [&](std::size_t i) { return little<std::uint16_t>(keys.directory.data() + 2 * i); };
  if (shorts < 4 || number(0) != 1 || 4 + std::size_t{number(3)} * 4 > shorts) return false;
  for (std::size_t k = 1; k <= number(3); ++k) {
    const std::size_t tag = number(4 * k + 1), end = std::size_t{number(4 * k + 2)} + number(4 * k + 3);
    const std::size_t room = tag == kDirectory ? shorts
                             : tag == kNumbers ? keys.numbers.size() / 8
                             : tag == kText    ? keys.text.size()
                                               : SIZE_MAX;
    if (end > room) return false;
  }
  return true;
}

// A TIFF of one black pixel with the keys. Layout: TIFF Revision 6.0 (Aldus, 1992), section 2.
std::string tiffOf(const GeoKeys& keys) {
  enum Type : std::uint16_t { kTypeAscii = 2, kTypeShort = 3, kTypeDouble = 12 };
  struct Entry {
    std::uint16_t tag;
    Type type;
    std::uint32_t count;
    std::string value;
  };
  const auto one = [](std::uint16_t tag, std::uint16_t value) {
    std::string bytes;
    appendLittle(bytes, value);
    return Entry{tag, kTypeShort, 1, bytes};
  };
  std::vector<Entry> entries{one(256, 1), one(257, 1), one(258, 8), one(259, 1), one(262, 1),
                             one(273, 8), one(277, 1), one(278, 1), one(279, 1)};
  entries.push_back(
      {kDirectory, kTypeShort, static_cast<std::uint32_t>(keys.directory.size() / 2), keys.directory});
  if (keys.numbers.size() >= 8)
    entries.push_back(
        {kNumbers, kTypeDouble, static_cast<std::uint32_t>(keys.numbers.size() / 8), keys.numbers});
  if (!keys.text.empty()) {
    entries.push_back({kText, kTypeAscii, static_cast<std::uint32_t>(keys.text.size() + 1), keys.text});
    entries.back().value += '\0';
  }
  // Header, the pixel and a byte to align the directory, the directory, the long values.
  constexpr std::uint32_t kFirst = 10;
  std::string bytes("II*\0", 4), values;
  appendLittle(bytes, kFirst);
  bytes.append(2, '\0');
  appendLittle(bytes, static_cast<std::uint16_t>(entries.size()));
  const auto values_at = static_cast<std::uint32_t>(bytes.size() + 12 * entries.size() + 4);
  for (Entry& e : entries) {
    appendLittle(bytes, e.tag);
    appendLittle(bytes, static_cast<std::uint16_t>(e.type));
    appendLittle(bytes, e.count);
    if (e.value.size() <= 4) {
      e.value.resize(4, '\0');
      bytes += e.value;
    } else {
      appendLittle(bytes, static_cast<std::uint32_t>(values_at + values.size()));
      values += e.value;
      values.resize((values.size() + 7) / 8 * 8, '\0');
    }
  }
  appendLittle(bytes, std::uint32_t{0});
  return bytes + values;
}

}  // namespace

std::string wktOf(OGRSpatialReferenceH crs) {
  return crsAs(crs, "FORMAT=WKT2_2019");
}

bool sameHorizontalCrs(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return true;
  const CrsPtr first(gdal().OSRNewSpatialReference(a.c_str())),
      second(gdal().OSRNewSpatialReference(b.c_str()));
  if (!first || !second) return true;
  for (const CrsPtr* crs : {&first, &second}) gdal().OSRStripVertical(crs->get());
  // A program may list the axes in another order: files keep x before y all the same.
  const char* const options[] = {"CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS",
                                 "IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES", nullptr};
  return gdal().OSRIsSameEx(first.get(), second.get(), options) != 0;
}

std::string crsName(const std::string& wkt) {
  const CrsPtr crs(wkt.empty() ? nullptr : gdal().OSRNewSpatialReference(wkt.c_str()));
  const char* const name = crs ? gdal().OSRGetName(crs.get()) : nullptr;
  return name != nullptr && *name != '\0' ? name : "no coordinate system";
}

std::string wktOfPrj(const std::string& text) {
  const CrsPtr crs(gdal().OSRNewSpatialReference(nullptr));
  char** lines = gdal().CSLTokenizeString2(text.c_str(), "\r\n", 0);
  const bool understood = gdal().OSRImportFromESRI(crs.get(), lines) == OGRERR_NONE;
  gdal().CSLDestroy(lines);
  if (!understood) return {};
  const CrsPtr known = registered(crs.get());
  return wktOf(known ? known.get() : crs.get());
}

std::string prjOf(const std::string& wkt) {
  const CrsPtr crs(gdal().OSRNewSpatialReference(wkt.c_str()));
  if (!crs) return {};
  // PROJ writes units as small as a micrometre with digits that no reader accepts: "1E-06.0".
  for (const char* form : {"FORMAT=WKT1_ESRI", "FORMAT=WKT1_GDAL"}) {
    std::string text = crsAs(crs.get(), form);
    if (!text.empty() && !wktOfPrj(text).empty()) return text;
  }
  return {};
}

std::string wktOfGeoKeys(const GeoKeys& keys) {
  if (!keysAreSound(keys)) return {};
  const MemoryFile file(".tif", tiffOf(keys));
  // GDAL ignores vertical systems in keys of version 1.0, which are those of LAS 1.2.
  gdal().CPLSetThreadLocalConfigOption("GTIFF_REPORT_COMPD_CS", "YES");
  const char* const drivers[] = {"GTiff", nullptr};
  const DatasetPtr dataset(
      gdal().GDALOpenEx(file.path().c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers, nullptr, nullptr));
  OGRSpatialReferenceH crs = dataset ? gdal().GDALGetSpatialRef(dataset.get()) : nullptr;
  gdal().CPLSetThreadLocalConfigOption("GTIFF_REPORT_COMPD_CS", nullptr);
  if (crs == nullptr || (gdal().OSRIsProjected(crs) == 0 && gdal().OSRIsGeographic(crs) == 0)) return {};
  return wktOf(crs);
}

}  // namespace fettle::engine
