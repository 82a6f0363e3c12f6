#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/edge_line.h"
#include "engine/field/version.h"

namespace fettle::engine {

// Step height and edge angle along lines, measured in the samples on both sides: of the scan that a line was located
// in, or of what a filter made of it.

/// The surfaces on both sides of a line at one of its points. "Left" as in edge_line.h.
struct EdgeSection {
  double along_mm = 0.0;     ///< length of the line up to here
  glm::dvec2 position{0.0};  ///< [samples]
  /// Whether the point is located and both sides have samples for a plane; if not, what follows is 0.
  bool measured = false;
  /// Height of the left surface minus that of the right one, at the line, and its standard deviation
  /// [height_unit].
  double step = 0.0, step_deviation = 0.0;
  /// How far the surface turns across the line, and its standard deviation [degrees]: inclination of the left surface,
  /// across the line and rising to the left, minus that of the right one. 0: none; above 0 a concave edge.
  double turn = 0.0, turn_deviation = 0.0;
};

/// Noise of a field, as standard deviations [height_unit], >= 0.
struct EdgeNoise {
  double sigma = 0.0;                ///< of each sample by itself
  double rows = 0.0, columns = 0.0;  ///< of what all samples of a row, or of a column, are off together
};

/// Means over the measured points of a line; their deviations are those of the points or, where that is more, the
/// spread of the values. Points share samples with their neighbours: 2 kHalf + 1 count once. What rows and columns are
/// off is added as it enters the mean: along a row it hardly averages away.
struct EdgeMeans {
  static constexpr int kHalf = 5;  ///< points before and after whose samples a section is fitted to

  int measured = 0;                         ///< points; without any the rest is 0
  double step = 0.0, step_deviation = 0.0;  ///< [height_unit]
  double step_low = 0.0, step_high = 0.0;   ///< [height_unit]
  double turn = 0.0, turn_deviation = 0.0;  ///< [degrees]
  double turn_low = 0.0, turn_high = 0.0;   ///< [degrees]
};

/// A line's sections, one per point, and their means.
struct MeasuredEdge {
  std::vector<EdgeSection> sections;
  EdgeMeans means;
};

/// The sections at the points of each line of a field. At a point, planes are fitted by least squares to the samples
/// up to 10 samples from the line (fewer where these fit no plane), more than 0.75 from it, and kHalf points along, up
/// to the next line; slopes come out 1.2e-4 of themselves too small. Samples that no surface explains, such as mixed
/// pixels, are left out. Where the samples scatter more about their planes than `noise` says, that counts. Noise that
/// neighbouring samples share is not known but for rows and columns: 1.3 times the variance is assumed, as by
/// locateEdgeLines(). At rounded corners the surfaces are no planes, and the deviations say less than the error; of a
/// field that was filtered they do as well.
///
/// Signs follow Version::reader(): of an inverted version both figures have the other sign. Memory and time as
/// locateEdgeLines(), a tenth of its time. Progress counts points. Thread: any; blocks, on all workers. Errors: kInput
/// for a noise that is not a number; kCancelled.
[[nodiscard]] Result<std::vector<MeasuredEdge>> measureEdges(const Version& field, const EdgeNoise& noise,
                                                             const std::vector<EdgeLine>& lines,
                                                             JobControl& job);

}  // namespace fettle::engine
