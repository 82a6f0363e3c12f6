#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/field/version.h"
#include "engine/scanner/scanner.h"
#include "haptic/base/strokes.h"

namespace fettle::haptic {

/// How the simulated person works. Every amplitude may be 0.
struct OperatorSpec {
  std::uint64_t seed = 1;
  double rate_hz = 1000.0;   ///< rows per second, 100 .. 10000
  double speed_mm_s = 20.0;  ///< along an edge, > 0
  double lift_mm = 3.0;      ///< free height over the highest point of the scan between strokes, > 0
  double press_mm = 0.3;     ///< depth of the tip below the scan's surface while tracing, >= 0
  /// Standard deviation of the tip's tremor along each axis of the plane, 8 to 12 Hz [mm]; height has half of
  /// it. 0.049 mm was measured on eye surgeons' hands holding an instrument still: Riviere, Rader and Khosla,
  /// Characteristics of hand motion of eye surgeons (1997).
  double tremor_mm = 0.049;
  /// Standard deviation of the slow drift from the line that visual feedback corrects, 0.1 to 1.5 Hz [mm].
  /// Together with the tremor it gives the 0.133 mm error of the same hands in repeated movements (same
  /// source).
  double wander_mm = 0.124;
  /// Passes along each edge with the smooth tool, then with the mark tool; 0 .. 16 each.
  int smooth_passes = 1;
  int mark_passes = 1;
  /// How far to the high side of a step (the flatter one of a crease) the smooth passes run [mm], >= 0: a
  /// smoothing window that reaches over an edge blurs it, so a person smooths the area next to it.
  /// offTheEdges() gives the distance needed.
  double smooth_offset_mm = 0.6;
  /// Along a step the mark passes keep the tip at the lowest height within this distance [mm], >= 0, and come
  /// down on the low side: the wall guides the tip, as a concave corner guides the paper's users. 0 = the
  /// tip's height follows the surface below it, also up and down the wall within a millisecond.
  /// ContactLevel::kCertified follows either; the local search of kPaper stays in local minima of the noise
  /// after such a jump, and where the tip lies deep inside a wall.
  double guide_mm = 0.0;
  /// The smooth passes only feel where an edge lies nearer than this to the path of the tool (narrow ribs,
  /// corners) [mm], 0 .. smooth_offset_mm; 0 = smooth everywhere.
  double smooth_clear_mm = 0.55;
  /// Distance between parallel mark passes, spread evenly about the edge [mm], >= 0.
  double mark_offset_mm = 0.0;
  /// Edges shorter than this are left out [mm], >= 0.
  double shortest_mm = 0.0;
};

/// The same person, whose smooth passes keep a distance from the edges of a scan of this grid: offset and
/// clearance large enough that no sample next to an edge is smoothed, for any drift and tremor. The smoothed
/// area begins there. The sum of:
///  - the hand's own error, to four times its standard deviation;
///  - the press: a tip deeper below the surface than its distance from a wall is nearer to the wall, and the
///    contact, and so the brush, is then on the wall;
///  - the brush: its 3 x 3 window about the lower-left sample of the cell, two samples.
[[nodiscard]] OperatorSpec offTheEdges(OperatorSpec spec, const engine::Grid& grid);

/// The strokes of a person tracing the edges of a scan with a stylus: for each edge in turn, the smooth
/// passes, then the mark passes; each stroke comes down from above, presses to `press_mm`, follows the edge
/// (closed ones completely), lifts, and moves to the next one through free space.
///
/// The tip is never on the exact edge: drift and tremor move it. Its height is the scan's bilinear surface
/// (with noise and outliers) minus the press depth, near a step the lowest within guide_mm; over holes the
/// last height found. Above the surface the rows have Tool::kFeel. Rows are 1 / rate_hz apart from t = 0 on.
/// Tips stay inside the field. Deterministic by seed, one thread, no state. Empty without edges. Asserts the
/// ranges above.
[[nodiscard]] std::vector<StrokeSample> operatorStrokes(const engine::Version& scan,
                                                        std::span<const engine::Edge> edges,
                                                        const OperatorSpec& spec);

}  // namespace fettle::haptic
