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
  double rate_hz = 1000.0;   ///< rows a second, 100 .. 10000
  double speed_mm_s = 20.0;  ///< along an edge, > 0
  double lift_mm = 3.0;      ///< free height over the highest point of the scan between strokes, > 0
  double press_mm = 0.3;     ///< depth of the tip below the scan's surface while tracing, >= 0
  /// Standard deviation of the tip's tremor along each axis of the plane, 8 to 12 Hz [mm]; height takes half
  /// of it. 0.049 mm is what eye surgeons' hands did holding an instrument still: Riviere, Rader and Khosla,
  /// Characteristics of hand motion of eye surgeons (1997).
  double tremor_mm = 0.049;
  /// Standard deviation of the slow wander off the line that the eye corrects, 0.1 to 1.5 Hz [mm]. With the
  /// tremor it makes the 0.133 mm that the same hands were off in repeated movements (same source).
  double wander_mm = 0.124;
  /// Passes along each edge with the smooth tool, then with the mark tool; 0 .. 16 each.
  int smooth_passes = 1;
  int mark_passes = 1;
  /// How far to the high side of a step (the flatter one of a crease) the smooth passes run [mm], >= 0: a
  /// smoothing window that reaches over an edge blurs it, so a person smooths the land beside it. How far is
  /// enough: offTheEdges().
  double smooth_offset_mm = 0.6;
  /// Along a step the mark passes keep the tip down at the lower land that lies within this distance [mm],
  /// >= 0, and come down on the low side: the wall guides the tip, as a concave corner guides the paper's
  /// users. 0 = the tip's height follows the surface right under it, also up and down the wall within a
  /// millisecond. ContactLevel::kCertified follows either; the local search of kPaper is left behind in the
  /// noise's own minima after such a jump, and where the tip lies deep inside a wall.
  double guide_mm = 0.0;
  /// The smooth passes only feel where any edge lies nearer than this to the way of the tool (narrow ribs,
  /// corners) [mm], 0 .. smooth_offset_mm; 0 = smooth everywhere.
  double smooth_clear_mm = 0.55;
  /// Distance between parallel mark passes, spread evenly about the edge [mm], >= 0.
  double mark_offset_mm = 0.0;
  /// Edges shorter than this are left out [mm], >= 0.
  double shortest_mm = 0.0;
};

/// The same person, whose smooth passes keep off the edges of a scan of this grid: offset and clearance large
/// enough that no sample beside an edge is smoothed, however the hand wanders and trembles. The land that is
/// smoothed begins there. What reaches over an edge otherwise, and is added up here:
///  - the hand's own error, to four times its standard deviation;
///  - the press: a tip that lies deeper below the land than it is away from a wall is nearer to the wall, and
///    the contact, hence the brush, is there and no longer on the land;
///  - the brush: its 3 x 3 window about the lower-left sample of the cell, two samples.
[[nodiscard]] OperatorSpec offTheEdges(OperatorSpec spec, const engine::Grid& grid);

/// The strokes of a person tracing the edges of a scan with a stylus: for each edge in turn, the smooth
/// passes, then the mark passes; each stroke comes down from above, presses to `press_mm`, follows the edge
/// (closed ones all the way round), lifts, and travels on to the next one through free air.
///
/// The tip is never on the exact edge: it wanders and trembles about it. Its height is the scan's bilinear
/// surface (noise, outliers and all) less the press depth, beside a step the lowest within guide_mm; over
/// holes the last height found holds. While the tool is in the air its rows say Tool::kFeel. Rows are 1 /
/// rate_hz apart from t = 0 on. Tips stay inside the field. Deterministic by seed, one thread, no state.
/// Empty without edges. Asserts the ranges above.
[[nodiscard]] std::vector<StrokeSample> operatorStrokes(const engine::Version& scan,
                                                        std::span<const engine::Edge> edges,
                                                        const OperatorSpec& spec);

}  // namespace fettle::haptic
