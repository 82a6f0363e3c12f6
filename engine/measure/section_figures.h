#pragma once

#include "engine/base/error.h"
#include "engine/measure/section.h"
#include "engine/measure/section_noise.h"

namespace fettle::engine {

// What is measured in a section, each with the standard error that the noise of the scan gives it. Lengths in millimetres;
// `noise`: of samples, independent from sample to sample (estimateNoise(); NaN where it is not known), and of whole rows and
// columns (measureNoise()).
//
// The errors are those of the fit, propagated from the samples through interpolation and averaging (Section::covariance), and
// from the rows and columns that they lie in: a section along a row has one offset, which no difference of its heights has;
// one across the rows has another at each place. Where the heights scatter about the fit by more than this noise explains, at
// three standard errors of that scatter, the rest counts as noise of samples, as it does where that is not known.
// Noise that neighbours share otherwise, as filters leave it, is neither measured nor known: the error is too small then.

/// Part of a section, from one length along it to another [mm].
struct Stretch {
  double from_mm = 0.0, to_mm = 0.0;
};

struct Estimate {
  double value = 0.0;
  double error = 0.0;  ///< standard error
};

/// A straight line fitted to a stretch by least squares of heights.
struct LineFigures {
  Estimate slope;            ///< height over length [mm/mm]
  Estimate inclination_deg;  ///< atan of it
  Estimate height_mm;        ///< in the middle of what of the stretch lies on the section
  double rms_mm = 0.0;       ///< of the heights about the line
  int places = 0;
};
/// Errors (kInput): fewer than 3 heights.
[[nodiscard]] Result<LineFigures> lineFigures(const Section& section, const Stretch& stretch,
                                              const SectionNoise& noise);

struct AngleFigures {
  LineFigures first, second;
  Estimate turn_deg;  ///< inclination of the second less that of the first: above 0 a concave edge
  Estimate
      included_deg;  ///< the angle between the two lines on the side of the smaller turn, 180 for one line
  Estimate meet_along_mm, meet_height_mm;  ///< where the lines meet; NaN for parallel ones
};
/// The angle between the lines fitted to two stretches, with what their heights have in common.
[[nodiscard]] Result<AngleFigures> angleFigures(const Section& section, const Stretch& first,
                                                const Stretch& second, const SectionNoise& noise);

struct StepFigures {
  Estimate
      step_mm;  ///< of an edge: heights after it less those before. Of a groove: its depth, below 0 a ridge
  Estimate inclination_deg;    ///< of the common lines
  Stretch before, edge_after;  ///< the stretches that count; of a groove before and in it,
  Stretch behind;              ///< and behind it; empty of an edge
  double rms_mm = 0.0;
  int places = 0;
};
/// Step height at `edge_mm` within a stretch: two parallel lines fitted together, z = a x + b + h d with d = 0 before
/// and 1 after the edge; the distance between them, across them. As ISO 5436-1 does beside a groove, the third of the
/// width next to the edge is left out, and as much is taken on both sides: the width is what the shorter side has.
/// Errors (kInput): fewer than 2 heights on a side.
[[nodiscard]] Result<StepFigures> stepFigures(const Section& section, double edge_mm, const Stretch& within,
                                              const SectionNoise& noise);

/// Depth of a groove, or height of a ridge, between two edges after ISO 5436-1:2000, type A1: with its width W, lines
/// of a length of 3 W, of which the third of W next to each edge is left out outside, and all but the central third
/// inside. z = a x + b + h d by least squares, the depth across the lines.
/// Errors (kInput): edges out of order, fewer than 2 heights in any of the three stretches.
[[nodiscard]] Result<StepFigures> grooveFigures(const Section& section, double first_mm, double second_mm,
                                                const SectionNoise& noise);

/// The place in a stretch at which two parallel lines fit best: an edge for stepFigures(). NaN with fewer than 4
/// heights. Linear time.
[[nodiscard]] double edgeIn(const Section& section, const Stretch& within) noexcept;
/// The two places at which a common line with one offset between them fits best. Quadratic in 256 places at most, then
/// exact around them; beside both is a surface for grooveFigures(). NaN with fewer than 16 heights, and where one edge
/// alone fits as well: by no more than 25 variances of what is left, which noise does not reach.
[[nodiscard]] Stretch grooveIn(const Section& section, const Stretch& within);

struct ArcFigures {
  Estimate radius_mm;   ///< above 0
  bool hollow = false;  ///< the centre lies above the surface
  Estimate centre_along_mm, centre_height_mm;
  double rms_mm = 0.0;  ///< across the arc
  int places = 0;
};
/// The circle of a stretch by least squares of heights: distances from the circle over the inclination's cosine, by
/// Levenberg and Marquardt in height, direction and curvature at the middle, which stay well determined for a short arc.
/// Where the arc is steeper than 84 degrees heights count as there. Errors (kInput): fewer than 4 heights; a
/// curvature that does not differ from 0 by three standard errors.
[[nodiscard]] Result<ArcFigures> arcFigures(const Section& section, const Stretch& stretch,
                                            const SectionNoise& noise);

struct CursorFigures {
  double dx_mm = 0.0;                      ///< along the line
  Estimate dz_mm;                          ///< height at the second less that at the first
  double slope_deg = 0.0;                  ///< NaN without a distance
  double distance_mm = 0.0;                ///< from point to point in space, straight
  double first_mm = 0.0, second_mm = 0.0;  ///< heights
};
/// What lies between two lengths along the line; heights between places are linear. The error is that of the samples of both
/// places, and of the rows and columns that are not in both alike. Errors (kInput): no height there.
[[nodiscard]] Result<CursorFigures> cursorFigures(const Section& section, double first_mm, double second_mm,
                                                  const SectionNoise& noise);

}  // namespace fettle::engine
