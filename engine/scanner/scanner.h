#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

// A simulated laser-triangulation scan of a machined part, with its true surface, which a real scan does not
// have. The scanner is the usual industrial one (a vertical sheet of light, a camera in front of it at an
// angle, the part moved along):
//
//        z   laser sheet (x-z)    camera
//        |        |              /              rows    = laser lines, x along them
//        |        |            /  30 degrees    columns = pixels along one laser line
//        |   _____v__________/___               scan    = along y, one row per line
//        +------------------------> y
//
// A part is a formula in millimetres, not a raster, so its truth is exact at every size. Noise is a pure
// function of (seed, effect, column, row): bit-identical for any thread count and order.

/// Kind of an edge.
enum class EdgeKind {
  kStep,    ///< the height jumps (vertical wall)
  kCrease,  ///< the height is continuous, its slope jumps (chamfer, ridge, groove)
};

/// One sharp line of a part, at its true position.
struct Edge {
  EdgeKind kind = EdgeKind::kStep;
  /// The line in field coordinates [mm] (x = column * spacing, y = row * spacing, see Grid), two points or
  /// more, exact to 1e-6 mm at the points; neighbours lie at most one sample apart. It stays in the field.
  std::vector<glm::dvec2> points_mm;
  /// Step height at each point [mm], high side minus low side, > 0; for a crease the jump of the slope's
  /// component across the line [mm/mm], > 0. As many as points_mm.
  std::vector<double> strength;
  /// True when the higher side (of a crease: the flatter one) is on the left going along the points.
  bool high_side_left = true;
  /// True when the last point joins the first.
  bool closed = false;
};

/// What to scan, and the errors to simulate. An effect with amplitude zero is not computed.
struct ScannerSpec {
  std::string part = "bracket";  ///< a name from parts()
  int width = 1024;              ///< columns, 1 .. Grid::kMaxSide
  int height = 1024;             ///< rows, 1 .. Grid::kMaxSide
  /// Scale of the height noise (sensor noise, speckle, line offset, quantisation), 0 .. 100; 1 = a realistic
  /// industrial scanner, sigma_mm about 0.02 mm; 0 = none of them.
  double noise = 1.0;
  /// Share of the samples next to a step that become mixed pixels, 0 .. 1; 0 = none; 0.05 is realistic.
  double outliers = 0.0;
  /// Scale of the lost samples, 0 .. 10: 0 = none lost; 1 = realistic loss on steep faces, and samples that
  /// the camera cannot see are holes (any value > 0).
  double dropouts = 0.0;
  /// Standard deviation of the spot of light that a height is the mean of [samples], 0 .. 4; 0 = none: walls of one
  /// sample; 0.5 to 2 is realistic. The truth stays sharp.
  double spot = 0.0;
  std::uint64_t seed = 1;
};

/// A scan and its true surface. The three versions share one grid (mm, origin 0, square spacing) and one
/// memory; tiles in which truth and edges do not differ are shared.
struct SimulatedScan {
  Version scan;
  Version truth;  ///< no noise; holes only where the part has through holes
  Version edges;  ///< truth with the true-edge samples marked: the sample nearest each point of an edge
  std::vector<Edge> edge_lines;  ///< in the order of the part's features
  double sigma_mm = 0.0;  ///< standard deviation of the sensor noise at the reference height, 0 without noise
};

/// Scans a part. The part is centred in the field, the spacing is the smallest square one with which all of
/// it fits; the plate around it fills the field. Threading: rows on all workers of the calling arena; blocks
/// until done. Bit-identical for the same spec. Errors: unknown part, a size or parameter outside its range,
/// memory exhausted, cancelled.
[[nodiscard]] Result<SimulatedScan> simulateScan(const ScannerSpec& spec, JobControl& job);

struct PartInfo {
  std::string_view name;         ///< value for ScannerSpec::part
  std::string_view description;  ///< one line
  double width_mm = 0.0;         ///< extent along x of the shown area
  double height_mm = 0.0;        ///< extent along y
};

/// All parts, in a fixed order.
[[nodiscard]] std::span<const PartInfo> parts() noexcept;

}  // namespace fettle::engine
