#include "engine/io/geo/crs_text.h"

#include <memory>

#include <cpl_conv.h>
#include <cpl_string.h>

namespace fettle::engine {

namespace {

struct ReleaseCrs {
  void operator()(OGRSpatialReferenceH crs) const noexcept { OSRRelease(crs); }
};
using CrsPtr = std::unique_ptr<void, ReleaseCrs>;

std::string crsAs(OGRSpatialReferenceH crs, const char* form) {
  char* text = nullptr;
  const char* const options[] = {form, nullptr};
  std::string out;
  if (OSRExportToWktEx(crs, &text, options) == OGRERR_NONE && text != nullptr) out = text;
  CPLFree(text);
  return out;
}

// The registry's system that equals this one in all parameters; null where there is none, or more than one.
CrsPtr registered(OGRSpatialReferenceH crs) {
  constexpr int kSameParameters = 90;  // GDAL: equivalent, the names may differ
  int count = 0;
  int* confidence = nullptr;
  OGRSpatialReferenceH* found = OSRFindMatches(crs, nullptr, &count, &confidence);
  CrsPtr match;
  if (count > 0 && confidence[0] >= kSameParameters && (count == 1 || confidence[1] < confidence[0]))
    match.reset(OSRClone(found[0]));
  if (found != nullptr) OSRFreeSRSArray(found);
  CPLFree(confidence);
  return match;
}

}  // namespace

std::string wktOf(OGRSpatialReferenceH crs) {
  return crsAs(crs, "FORMAT=WKT2_2019");
}

std::string wktOfPrj(const std::string& text) {
  const CrsPtr crs(OSRNewSpatialReference(nullptr));
  char** lines = CSLTokenizeString2(text.c_str(), "\r\n", 0);
  const bool understood = OSRImportFromESRI(crs.get(), lines) == OGRERR_NONE;
  CSLDestroy(lines);
  if (!understood) return {};
  const CrsPtr known = registered(crs.get());
  return wktOf(known ? known.get() : crs.get());
}

std::string prjOf(const std::string& wkt) {
  const CrsPtr crs(OSRNewSpatialReference(wkt.c_str()));
  if (!crs) return {};
  // PROJ writes units as small as a micrometre with digits that no reader accepts: "1E-06.0".
  for (const char* form : {"FORMAT=WKT1_ESRI", "FORMAT=WKT1_GDAL"}) {
    std::string text = crsAs(crs.get(), form);
    if (!text.empty() && !wktOfPrj(text).empty()) return text;
  }
  return {};
}

}  // namespace fettle::engine
