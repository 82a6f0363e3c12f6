#pragma once

#include <string>

namespace fettle::engine {

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
