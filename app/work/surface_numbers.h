#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/field/grid.h"
#include "engine/measure/areal.h"
#include "engine/measure/profile_spectrum.h"

namespace fettle::app {

// The numbers of a surface's curves, which plots, tables and the window show.

/// The material ratios of the Abbott curve, 0 .. 1.
[[nodiscard]] std::vector<double> curveRatios();
/// The heights at them, of a surface that was measured with curveRatios() as the last of its ratios.
[[nodiscard]] std::span<const double> curveHeights(const engine::ArealParameters& measured);

/// The autocorrelation over the distance, in one direction.
struct DecayCurve {
  std::string name;
  double degrees = 0.0;        ///< from x to y
  std::vector<double> values;  ///< at steps of decayStepMm()
};
/// The directions of the fastest and slowest decay; where there are none, x and y.
[[nodiscard]] std::vector<DecayCurve> decayCurves(const engine::SpatialAnalysis& analysis);
[[nodiscard]] double decayStepMm(const engine::SpatialAnalysis& analysis);

/// The curves of a surface that was measured as those want it, without what they were found from.
struct SurfaceCurves {
  std::vector<double> heights;  ///< at curveRatios(), about the mean [height_unit]
  std::vector<DecayCurve> decay;
  double decay_step_mm = 0.0;
  engine::ProfileSpectrum along_x, along_y;  ///< densities [mm^2 mm]
  std::string no_decay;                      ///< why there is neither decay nor spectrum; empty: there are
};
/// `measured`: with curveRatios() as the last of its ratios, and with its analysis. Time: as engine::profileSpectrum.
[[nodiscard]] SurfaceCurves curvesOf(const engine::ArealParameters& measured, const engine::Grid& grid);

}  // namespace fettle::app
