#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "engine/io/export.h"
#include "engine/io/import.h"

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
/// Errors (all ErrorKind::kInput, one line): a path that cannot be read, an unknown or damaged file, a cloud
/// without a point (a raster of holes alone gives a warning), more samples than memory can hold (determined from the header, before anything is
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

/// The grid that importField gives, from the header alone; nothing where only a full import tells it, and importRows() then reads
/// all. Errors: as importField, for the header. The size is not held against the memory. Thread: any.
[[nodiscard]] Result<std::optional<Grid>> importGrid(const std::string& path, const ImportOptions& options);

/// Rows [first, first + count) of the field that importField gives, bit by bit, as a field of their own: grid and origin are
/// those of the rows. A TIFF's other rows are not read and take no memory; of every other format the whole is read and the
/// rows are cut out of it, edge lines and original included. Warnings are those of these rows: none of what only the whole
/// field shows (lone values, doubtful units), and rows without a height are no error. Rows outside the field are
/// kInput. Errors, threads, progress otherwise as importField.
[[nodiscard]] Result<Imported> importRows(const std::string& path, const ImportOptions& options,
                                          std::int32_t first, std::int32_t count, JobControl& job);

/// Writes a field, its sign applied, in the format that the extension of `path` names (any case). What a
/// format stores is stated at its writer and, for the user, in docs/formats.md.
///
/// Only sessions store marks; other formats have a file of marks (marks.h). The file appears completely or not at
/// all (atomic_file.h). Errors: kInput for an unknown extension, a path that cannot be written; kFailed for a
/// full disk; kCancelled. Thread: any; a long job.
[[nodiscard]] Result<Exported> exportField(const Version& field, const std::string& path,
                                           const ExportOptions& options, JobControl& job);

}  // namespace fettle::engine
