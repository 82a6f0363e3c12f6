#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "engine/io/export.h"
#include "engine/io/import.h"
#include "engine/io/preview.h"

namespace fettle::engine {

/// All formats, in the order in which they are tried. Static, any thread.
[[nodiscard]] std::span<const FormatInfo> formats();

/// Reads a height field from a file of any format of formats() that can be read. The format is recognised by
/// content; the extension only decides between formats whose files look alike (text).
///
/// Rows of top-down formats are flipped so that row 0 has the lowest y; Grid::origin is the centre of the
/// lower-left sample. Lateral unit: that of the coordinate system; degrees are approximated by the length of
/// a degree of longitude and latitude at the field's middle (with a warning that states the error); none = mm
/// (with a warning). Height unit: that of the band or of the vertical coordinate system, otherwise the
/// lateral one. Rows from bottom to top and columns from right to left in the file give a warning too.
///
/// Errors (all ErrorKind::kInput, one line): a path that cannot be read, an unknown or damaged file, one that
/// holds no valid height, more samples than memory can hold (determined from the header, before anything is
/// allocated); kCancelled. Memory: the field plus at most 256 MB plus the size of the file; clouds take
/// another 40 bytes per point and 8 per cell while they are gridded.
///
/// Thread: any, several at once; a long job: reports progress and checks cancel() in `job`.
[[nodiscard]] Result<Imported> importField(const std::string& path, const ImportOptions& options,
                                           JobControl& job);

/// Reads a coarse picture of at most `max_samples` samples (>= 4), when the file has over four times as many
/// and the picture takes a small share of the time of a full import: a TIFF that is not compressed, that has
/// overviews, or whose compressed blocks need not all be decompressed. Nothing otherwise: other formats,
/// depth images, a field without a valid height at the samples read.
///
/// Cost: at most 24 million samples decompressed, or the requested rows read. Rows are farther apart than
/// columns where compressed blocks would cost more: only their first rows are read.
///
/// Gives no warnings; the full import does. Errors: as importField, for the parts that are read. Thread: any;
/// reports progress and checks cancel() in `job`.
[[nodiscard]] Result<std::optional<Preview>> importPreview(const std::string& path,
                                                           const ImportOptions& options,
                                                           std::int64_t max_samples, JobControl& job);

/// Writes a field, its sign applied, in the format that the extension of `path` names (any case):
///
///   .tif .tiff  GeoTIFF, float32, compressed without loss if requested, geo-reference, CRS, units, holes =
///               NaN, declared
///   .asc        ESRI ASCII grid, every float with enough digits to be read back bit-identical, holes = a
///               declared number (ESRI readers do not support NaN); anisotropic spacing as dx, dy; a
///               coordinate system goes into a .prj file next to it, which is written before the grid
///   .xyz        text, one "x y z" per sample that is not a hole, world coordinates, shortest exact digits;
///               raster and units in comments
///   .ply        binary little-endian points, double x and y, float z, world coordinates; raster and units in
///               comments; with ExportOptions::mesh the surface: cells without a hole as triangles
///   .stl        the surface as triangles, binary; x and y from the field's corner, float32, lateral unit
///   .png        16-bit grey, 0 = hole, quantised: a warning states count and largest error
///   .x3p        ISO 25178-72, metres: float32 where the field is in metres, otherwise float64, and every
///               digit of units, spacing and origin in an entry of its own, so that each float is restored
///   .exr        OpenEXR, channel Y, float32, holes = NaN; units, spacing, origin: an attribute of its own
///   .fettle     a session (engine/session) that begins with this field, or with ExportOptions::original,
///               marks and sign included, bit-identical
///
/// Other formats store no marks: these have their own file (marks.h). The file appears completely or not at
/// all (atomic_file.h). Errors: kInput for an unknown extension, a path that cannot be written; kFailed for a
/// full disk; kCancelled. Thread: any; a long job.
[[nodiscard]] Result<Exported> exportField(const Version& field, const std::string& path,
                                           const ExportOptions& options, JobControl& job);

}  // namespace fettle::engine
