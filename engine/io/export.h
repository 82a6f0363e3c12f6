#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// How the samples of a TIFF are packed. Who reads which is in docs/formats.md.
enum class TiffCompression : std::uint8_t {
  kNone,     ///< strips of plain floats, which every program reads; the default
  kLzw,      ///< strips, no predictor: what older programs unpack; no smaller where heights are noisy
  kDeflate,  ///< tiles, floating-point predictor
  kZstd,     ///< the same, packed and unpacked faster, read by fewer programs
};

/// "none", "lzw", "deflate", "zstd"; nothing for others.
[[nodiscard]] std::optional<TiffCompression> tiffCompressionFromName(std::string_view name);

struct ExportOptions {
  /// 16-bit PNG: height of one count [height_unit], finite and > 0. Without it Grid::height_per_count, and
  /// where that is 0 or the heights do not fit it, the range of the field spread over 1 .. 65535.
  std::optional<double> height_per_count;
  /// PLY: the surface as triangles instead of points. STL is always triangles.
  bool mesh = false;
  /// Mesh: as few triangles as keep every sample within this of the surface [height_unit], finite, >= 0;
  /// without it two a cell. Implies mesh.
  std::optional<double> max_error;
  /// TIFF: laid out for reading parts over a network, with overviews (means of 2 x 2, 4 x 4 ... samples).
  bool cloud_optimised = false;
  /// Session: the scan that the field was made from, grid and way up as the field's. The session begins with
  /// it, and where the two differ the field is a step from there. Without it the session begins with the
  /// field.
  std::optional<Version> original;
  /// TIFF: not said, kNone, and kDeflate where cloud-optimised.
  std::optional<TiffCompression> tiff_compression;
};

struct Exported {
  std::string format;                 ///< FormatInfo::name of the writer
  std::vector<std::string> warnings;  ///< what the format could not keep; one line each, no full stop
};

/// Writes a field, its sign applied, in the format that the extension of `path` names (any case):
///
///   .tif .tiff  GeoTIFF, float32, compressed without loss if asked, geo-reference, CRS, units, holes = NaN,
///               declared
///   .asc        ESRI ASCII grid, every float with enough digits to come back bit for bit, holes = declared
///               number (ESRI readers know no NaN); anisotropic spacing as dx, dy; a coordinate system goes
///               into a .prj file beside it, which is there before the grid is
///   .xyz        text, one "x y z" a sample that is no hole, world coordinates, shortest exact digits; raster
///   and
///               units in comments
///   .ply        binary little-endian points, double x and y, float z, world coordinates; raster and units in
///               comments; with ExportOptions::mesh the surface: cells without a hole as triangles
///   .stl        the surface as triangles, binary; x and y from the field's corner, float32, lateral unit
///   .png        16-bit grey, 0 = hole, quantised: the warning says count and largest error
///   .x3p        ISO 25178-72, metres: float32 where the field is in metres, else float64, and every digit of
///               units, spacing and origin in an entry of its own, so that each float comes back
///   .exr        OpenEXR, channel Y, float32, holes = NaN; units, spacing, origin: an attribute of its own
///   .fettle     a session (engine/session) that begins with this field, or with ExportOptions::original,
///               marks and sign included, bit for bit
///
/// Other formats take no marks: these go to their own file (marks.h). The file appears whole or not at all
/// (atomic_file.h). Errors: kInput for an unknown extension, a path that cannot be written; kFailed for a
/// full disk; kCancelled. Thread: any; a long job.
[[nodiscard]] Result<Exported> exportField(const Version& field, const std::string& path,
                                           const ExportOptions& options, JobControl& job);

}  // namespace fettle::engine
