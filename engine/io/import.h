#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// Height of a cell that contains several points of a cloud.
enum class CellRule {
  kMedian,   ///< of an even number of points: the mean of the two middle ones
  kMean,     ///< sum in double, rounded once
  kHighest,  ///< as seen by a laser from above
};

/// A pinhole camera: pixel (column u, row v from the top) at distance Z along its axis is the point (u - cx)
/// * Z / fx to the right of the axis and (cy - v) * Z / fy above it. All in pixels; fx, fy > 0. Without cx and cy the axis goes
/// through the middle of the picture, as that of most cameras does within a few pixels.
struct DepthCamera {
  double fx = 0.0, fy = 0.0;
  std::optional<double> cx = {}, cy = {};
};

/// What the user states about a file. It has priority over the file, with a warning where the two differ.
struct ImportOptions {
  /// One more value that means "hole", in the numbers as stored (before z_scale), compared after both were
  /// rounded to float32 when the samples are floats, exactly when they are integers. NaN is always a hole.
  std::optional<double> no_data;
  /// Distance of neighbouring columns, rows [unit of the import, see `unit`]; finite and > 0.
  std::optional<std::pair<double, double>> spacing;
  /// height = stored number * z_scale, in double, rounded once to float; finite, not 0. For integer samples
  /// it becomes Grid::height_per_count.
  std::optional<double> z_scale;
  /// Lateral and height unit. Without it: as stated in the file, else millimetres. Spacing that a file states
  /// in a unit of its own (resolution tags: pixels per centimetre) is converted into this one.
  std::optional<LengthUnit> unit;
  /// Point clouds: side of a cell in the file's unit, finite and > 0. Without it the lattice on which the
  /// points lie, otherwise estimated from their density. With it no lattice is searched.
  std::optional<double> cell_size;
  CellRule cell_rule = CellRule::kMedian;
  /// PNG and TIFF: the samples are distances from this camera. They stay pixels in its perspective and stay
  /// distances; spacing and origin come from the camera (stated in a warning). 0 is a hole unless no_data is
  /// given. Not together with spacing; fx, fy positive, all finite.
  std::optional<DepthCamera> depth_camera;
};

/// How a field was made from a cloud of points.
struct GriddingReport {
  std::int64_t points = 0;          ///< points with three finite coordinates; a warning counts the others
  std::int64_t cells = 0;           ///< width * height
  std::int64_t empty_cells = 0;     ///< cells without a point: holes
  std::int64_t multiple_cells = 0;  ///< cells with more than one point, where CellRule applied
  bool lattice = false;             ///< the points lay on a raster (with gaps), whose spacing was used
};

/// A height that looks like an undeclared hole.
struct LoneValue {
  float height = 0.0F;  ///< as read
  float number = 0.0F;  ///< as stored, in the form of ImportOptions::no_data
  friend bool operator==(const LoneValue&, const LoneValue&) = default;
};

struct Imported {
  /// Of a session with a form over its field what is seen (Version::seenOf).
  Version field;
  /// Of a session: the scan that it began with, with the grid and sign of `field`, seen under the same form.
  std::optional<Version> original;
  std::string recipe = {};    ///< of a session: its note "recipe", as ExportOptions::recipe; may be empty
  std::string steps = {};     ///< as ExportOptions::steps, where these led to `field`; else empty
  std::string sections = {};  ///< of a session: its note "sections", as the window keeps them; may be empty
  std::string format;         ///< FormatInfo::name of the reader, e.g. "GTiff", "XYZ"
  std::vector<std::string> warnings;  ///< what was guessed, converted or lost; one line each, no full stop
  std::optional<GriddingReport> gridding;  ///< point clouds only
  /// lone_value.h; `warnings` name each.
  std::vector<LoneValue> lone_values;
  /// Columns and rows are rays of a camera and heights distances from it: a plane is bent.
  bool in_perspective = false;
};

/// "mm", "m", "um", "µm", "nm", "cm", "km", "ft", "ftUS", "in" and their English names, any case; nothing for
/// others. "deg" is not a length and not accepted.
[[nodiscard]] std::optional<LengthUnit> lengthUnitFromName(std::string_view name);
/// Their names, as a LengthUnit has them: "nm", "um", ...; the smallest metric one first.
[[nodiscard]] std::vector<std::string> lengthUnitNames();

/// One row of the table of formats.
struct FormatInfo {
  std::string_view name;                         ///< stable, e.g. "GTiff"; goes into Imported::format
  std::string_view description;                  ///< for the user, e.g. "GeoTIFF and TIFF"
  std::span<const std::string_view> extensions;  ///< with the dot, lower case; the first is the usual one
  bool reads = false;
  bool writes = false;
  bool text = false;  ///< its files are text
};

/// A coarse picture of a raster, shown while the rest is read. Never edited, never saved.
struct Preview {
  /// Every step_columns-th sample of every step_rows-th row, with the corresponding spacing; or the file's
  /// own overview. Holes where the file has holes. Its origin is that of its own lower-left sample.
  Version field;
  std::int32_t step_columns = 1, step_rows = 1;  ///< samples of the file from one of these to the next
  bool overview =
      false;  ///< the file's own: each sample represents those around it by the file's rule, usually their mean, and holes narrower than a step may be missing
  std::int32_t width = 0, height = 0;  ///< of the file
};

}  // namespace fettle::engine
