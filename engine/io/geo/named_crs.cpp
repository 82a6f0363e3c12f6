#include "engine/io/geo/named_crs.h"

#include <charconv>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "engine/io/files/gdal_calls.h"
#include "engine/io/files/gdal_session.h"
#include "engine/io/geo/crs_text.h"

namespace fettle::engine {

Result<std::string> crsOf(const std::string& text) {
  const GdalSession quiet;
  constexpr std::string_view kRegistry = "EPSG:";
  const CrsPtr crs(gdal().OSRNewSpatialReference(nullptr));
  if (text.starts_with(kRegistry)) {
    int code = 0;
    const char *const digits = text.data() + kRegistry.size(), *const end = text.data() + text.size();
    if (const auto [read, problem] = std::from_chars(digits, end, code);
        problem == std::errc() && read == end && gdal().OSRImportFromEPSG(crs.get(), code) == OGRERR_NONE)
      return wktOf(crs.get());
  } else if (text.find('[') != std::string::npos) {
    std::string wkt = text;
    char* rest = wkt.data();
    if (gdal().OSRImportFromWkt(crs.get(), &rest) == OGRERR_NONE) return text;
  }
  return inputError(fmt::format("{} names no coordinate system", text.substr(0, 60)), "crs",
                    "give WKT, or a code as EPSG:28992");
}

}  // namespace fettle::engine
