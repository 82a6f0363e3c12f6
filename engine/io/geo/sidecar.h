#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fettle::engine {

/// What the sidecar files of a raster state about its first band in addition to the raster.
struct Sidecar {
  std::optional<double> no_data;
  std::string height_unit;  ///< its name in the file; empty if none
  std::string crs_wkt;      ///< WKT 2; empty if none
};

/// Reads NAME.EXT.aux.xml (GDAL's "persistent auxiliary metadata", also written by QGIS and ArcGIS) next to
/// `path`. A missing file gives an empty result; one that cannot be parsed gives a warning and an empty
/// result, as do scales and offsets of heights. Thread: any.
[[nodiscard]] Sidecar readAuxXml(const std::string& path, std::vector<std::string>& warnings);

/// The .prj file of a scan: its path with another extension, in the case that exists; in lower case where
/// there is none.
[[nodiscard]] std::string prjPathOf(const std::string& path);

/// The coordinate system of the .prj file next to `path`, as WKT 2; empty where there is none, or where it
/// cannot be parsed, with a warning. Thread: any.
[[nodiscard]] std::string readPrj(const std::string& path, std::vector<std::string>& warnings);

/// The number that means a hole, from the raster and its sidecar: the sidecar has priority, as in GDAL, with
/// a warning where the two differ.
[[nodiscard]] std::optional<double> chooseNoData(std::optional<double> own, const Sidecar& sidecar,
                                                 std::vector<std::string>& warnings);

}  // namespace fettle::engine
