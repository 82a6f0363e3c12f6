#pragma once

#include <span>
#include <string>

#include "engine/field/grid.h"
#include "engine/measure/areal.h"

namespace fettle::app {

// The curves of a surface as scripts for gnuplot (plots/gnuplot.h), those of several states over each other: a colour each.

/// A state of a surface, measured with the heights of curveRatios() (surface_numbers.h) as the last ones of its ratios, and with its analysis.
struct PlottedState {
  std::string name;  ///< "before"; of a single one empty
  const engine::ArealParameters* measured = nullptr;
};

/// Material ratio (Abbott) curves, with the limits of the first state's core where there is one state.
[[nodiscard]] std::string abbottPlot(std::span<const PlottedState> states, const engine::Grid& grid);
/// Autocorrelation in the directions of its fastest and slowest decay; of states that have an analysis.
[[nodiscard]] std::string correlationPlot(std::span<const PlottedState> states);
/// Whether samples of lines lie so near to each other that their profiles have a spectrum; of a state that has an analysis.
[[nodiscard]] bool hasSpectrum(const engine::ArealParameters& measured);
/// Power spectral density of profiles along x and along y; of states that have one.
[[nodiscard]] std::string spectrumPlot(std::span<const PlottedState> states, const engine::Grid& grid);

}  // namespace fettle::app
