#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fettle::engine {

/// What the files beside a raster say of its first band and not the raster itself.
struct Sidecar {
  std::optional<double> no_data;
  std::string height_unit;  ///< its name in the file; empty if none
  std::string crs_wkt;      ///< WKT 2; empty if none
};

/// Reads NAME.EXT.aux.xml (GDAL's "persistent auxiliary metadata", which QGIS and ArcGIS write too) beside
/// `path`. One that is missing says nothing; one that is not understood is warned of and says nothing, as are
/// scales and offsets of heights. Thread: any.
[[nodiscard]] Sidecar readAuxXml(const std::string& path, std::vector<std::string>& warnings);

/// The .prj file of a scan: its path with another extension, in whatever case there is one; in lower case
/// where there is none.
[[nodiscard]] std::string prjBeside(const std::string& path);

/// The coordinate system that the .prj file beside `path` names, as WKT 2; empty where there is none, or none
/// that is understood, which is warned of. Thread: any.
[[nodiscard]] std::string readPrj(const std::string& path, std::vector<std::string>& warnings);

/// What means a hole by the raster's own word and by its sidecar's: the sidecar wins, as in GDAL, with a
/// warning where the two differ.
[[nodiscard]] std::optional<double> settledNoData(std::optional<double> own, const Sidecar& beside,
                                                  std::vector<std::string>& warnings);

}  // namespace fettle::engine
