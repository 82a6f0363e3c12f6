#pragma once

#include <string>

#include "bench/accuracy/study.h"
#include "engine/base/error.h"

namespace fettle::app {

/// A study as a plot: error over cost, both logarithmic where they span more than a factor of three. A line
/// per subject connects the Pareto front; the other points are hollow. Points are numbered as the methods are
/// in the tables (methodNumber). An error of zero is drawn on the lower edge. An SVG element, 860 x 480,
/// drawn by gnuplot. Errors (kFailed): gnuplot is missing or fails.
[[nodiscard]] engine::Result<std::string> plotSvg(const bench::Study& study);

/// 1 for the first method of a study, 2 for the next that has another name, ...
[[nodiscard]] int methodNumber(const bench::Study& study, const std::string& method);

}  // namespace fettle::app
