#pragma once

#include <string>

#include "engine/base/error.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// The keep mask as a picture: 8-bit grey PNG, or TIFF of one band of integers; one pixel per sample, non-zero = marked
/// (keep), the top row of the picture = the HIGHEST row of the field. A GeoTIFF is laid on the field by its position
/// (partOfMarks), so that it may be larger than the field; its no-data value means not marked.

/// The same heights, sign and grid with exactly the marks of the picture; previous marks of `field` are
/// removed. Tiles whose marks do not change stay shared with `field`. Errors (kInput): not such a picture,
/// more than kMostMarkValues different numbers of more than 8 bits (a scan), those of partOfMarks. Thread: any.
inline constexpr int kMostMarkValues = 256;
[[nodiscard]] Result<Version> importMarks(const Version& field, const std::string& path);

/// Writes the marks as 0 and 255; PNG or GeoTIFF, with position and coordinate system of the field, by extension
/// (.png, .tif, .tiff). Completely or not at all.
/// Errors: kInput. Thread: any.
[[nodiscard]] Status exportMarks(const Version& field, const std::string& path);

}  // namespace fettle::engine
