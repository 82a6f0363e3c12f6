#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/edge_line.h"
#include "engine/field/grid.h"
#include "engine/field/version.h"

namespace fettle::engine {

// Edge lines as files. The extension selects the format; docs/formats.md has the columns and attributes.
//
//   .csv            one row per point, all its values: reads back bit-identical. Field coordinates in millimetres,
//                   as in strokes files: without the origin of the scan.
//   .geojson .json  a feature per run of located points, and per run of others: number of the line, closed, located,
//   .gpkg           kind by majority, mean deviation and step. The values of single points are lost.
//   .dxf            a polyline per run; its layer states whether it was located. All else is lost.
//
// The last three are in the scan's own coordinates, where a program that draws the scan expects them: with a
// coordinate system those of its GeoTIFF (Grid: world coordinates, lateral unit), else millimetres from the origin.
// Deviations and heights are in millimetres everywhere. Where the spacing differs between the axes, a sample across a
// line counts as the geometric mean of both.

/// The extensions with their dots.
inline constexpr std::string_view kLineExtensions[] = {".csv", ".dxf", ".geojson", ".gpkg", ".json"};

/// Most points of a file of lines, also after points were inserted.
inline constexpr std::int64_t kMostLinePoints = std::int64_t{1} << 22;

/// The extension of the format that the first bytes of a file of lines are of, with its dot; empty where they are of
/// none.
[[nodiscard]] std::string_view lineExtensionOf(std::string_view head) noexcept;

/// Reads edge lines for `field`. Positions are rounded to multiples of 2^-20 samples. Where located points lie more than
/// EdgeLine::kMostApart apart, others are inserted between them, at most one sample apart. A line of another program,
/// without attributes, counts as a step that was located without deviation.
/// Errors (kInput): unreadable or damaged file, unknown extension, no line in it, a geometry that is no line, numbers
/// that are not finite, points farther from the field than it is long, none in it, too many points. Memory: for .csv that of the
/// points, else some ten times the file, which may have 1 GiB. Thread: any.
/// `job`: kCancelled soon after it is cancelled; a file of another program only once it is opened.
[[nodiscard]] Result<std::vector<EdgeLine>> importLines(const std::string& path, const Version& field,
                                                        const JobControl* job = nullptr);

/// Writes edge lines of a field with `grid`, whole or not at all. A file without lines cannot be read back.
/// Errors: kInput, unknown extension, path that cannot be written, too many points; kFailed, full disk.
/// Thread: any.
[[nodiscard]] Status exportLines(const std::string& path, std::span<const EdgeLine> lines, const Grid& grid);

}  // namespace fettle::engine
