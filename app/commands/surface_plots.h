#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/field/grid.h"
#include "engine/measure/areal.h"

namespace fettle::app {

// The curves of a surface as scripts for gnuplot (plots/gnuplot.h), those of several states over each other: a colour each.

/// A state of a surface, measured with the heights of curveRatios() as the last ones of its ratios, and with its analysis.
struct PlottedState {
  std::string name;  ///< "before"; of a single one empty
  const engine::ArealParameters* measured = nullptr;
};

/// The material ratios of the Abbott curve, 0 .. 1.
[[nodiscard]] std::vector<double> curveRatios();
/// The heights at them.
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

/// Material ratio (Abbott) curves, with the limits of the first state's core where there is one state.
[[nodiscard]] std::string abbottPlot(std::span<const PlottedState> states, const engine::Grid& grid);
/// Autocorrelation in the directions of its fastest and slowest decay; of states that have an analysis.
[[nodiscard]] std::string correlationPlot(std::span<const PlottedState> states);
/// Power spectral density of profiles along x and along y; of states that have an analysis.
[[nodiscard]] std::string spectrumPlot(std::span<const PlottedState> states, const engine::Grid& grid);

}  // namespace fettle::app
