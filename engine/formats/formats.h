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
/// a degree of longitude and latitude at the field's middle (warned about, with the error); none = mm (warned
/// about). Height unit: that of the band or of the vertical coordinate system, else the lateral one. Rows
/// that run upwards and columns that run leftwards in the file are warned about too.
///
/// Errors (all ErrorKind::kInput, one line): a path that cannot be read, an unknown or damaged file, one that
/// holds no valid height, more samples than memory can hold (told from the header, before anything is
/// allocated); kCancelled. Memory: the field plus at most 256 MB plus the size of the file; clouds take
/// 40 bytes a point and 8 a cell more while they are gridded.
///
/// Thread: any, several at once; a long job: reports progress and looks at cancel() in `job`.
[[nodiscard]] Result<Imported> importField(const std::string& path, const ImportOptions& options,
                                           JobControl& job);

/// Reads a coarse picture of at most `max_samples` samples (>= 4), when the file is so large that this is of
/// use - over four times as many - and it can be had for a small share of the whole: a TIFF that is not
/// packed, that has overviews, or whose packed blocks need not all be unpacked. Nothing otherwise: other
/// formats, depth images, a field without a valid height at the samples looked at.
///
/// Cost: at most 24 million samples unpacked, or the rows looked at read. Rows lie farther apart than columns
/// where packed blocks would cost more: their first rows are looked at alone.
///
/// What is left unsaid are the warnings; who reads the whole gets them. Errors: as importField, as far as the
/// file is looked at. Thread: any; reports progress and looks at cancel() in `job`.
[[nodiscard]] Result<std::optional<Preview>> importPreview(const std::string& path,
                                                           const ImportOptions& options,
                                                           std::int64_t max_samples, JobControl& job);

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
