#pragma once

#include <string>

#include "engine/io/files/gdal_calls.h"

namespace fettle::engine {

/// A coordinate system as WKT 2, the form of Grid::crs_wkt; empty where GDAL cannot express it.
[[nodiscard]] std::string wktOf(OGRSpatialReferenceH crs);

/// The system described by the text of a .prj file, Esri's WKT or its older key words, as WKT 2; under the
/// name of the EPSG registry where it equals a registered system in all parameters. Empty where it cannot be
/// parsed. Call during the lifetime of a GdalSession.
[[nodiscard]] std::string wktOfPrj(const std::string& text);

/// A system as the text of a .prj file: Esri's WKT, or plain WKT 1 where Esri's is not read back correctly;
/// empty where neither is. Call during the lifetime of a GdalSession.
[[nodiscard]] std::string prjOf(const std::string& wkt);

/// Whether two systems place the same numbers at the same points of the plane: a vertical system counts for nothing, nor
/// do names. Empty ones, and such as cannot be parsed, are equal to every other. Call during the lifetime of a
/// GdalSession.
[[nodiscard]] bool sameHorizontalCrs(const std::string& a, const std::string& b);

/// The name of a system, "WGS 84 / UTM zone 33N"; "no coordinate system" for an empty text.
[[nodiscard]] std::string crsName(const std::string& wkt);

/// GeoTIFF keys (OGC 19-008) outside a TIFF, as LAS keeps them: the bytes of three tags, little-endian.
struct GeoKeys {
  std::string directory;  ///< 34735: 16-bit numbers
  std::string numbers;    ///< 34736: doubles
  std::string text;       ///< 34737
};

/// The projected or geographic coordinate system that the keys name, with the vertical one if named, as WKT
/// 2; empty where they name no known system. Call during the lifetime of a GdalSession. Errors: none, damaged
/// keys name no system. Thread: any.
[[nodiscard]] std::string wktOfGeoKeys(const GeoKeys& keys);

}  // namespace fettle::engine
