#pragma once

#include <string>

#include <ogr_srs_api.h>

namespace fettle::engine {

/// A coordinate system as WKT 2, the form that Grid::crs_wkt holds; empty where GDAL cannot express it.
[[nodiscard]] std::string wktOf(OGRSpatialReferenceH crs);

/// The system that the text of a .prj file describes, Esri's WKT or its older key words, as WKT 2; where it
/// is one of the EPSG registry by all its parameters, under the registry's name. Empty where it is not
/// understood. Call with a GdalSession alive.
[[nodiscard]] std::string wktOfPrj(const std::string& text);

/// A system as the text of a .prj file: Esri's WKT, or plain WKT 1 where Esri's does not read back; empty
/// where neither does. Call with a GdalSession alive.
[[nodiscard]] std::string prjOf(const std::string& wkt);

}  // namespace fettle::engine
