#pragma once

#include <string>

#include "bench/accuracy/study.h"
#include "engine/base/error.h"

namespace fettle::app {

/// A study as a picture: error over cost, both logarithmic where they span more than a factor of three. A
/// line a subject joins what is worth choosing, which nothing beats in both; the rest are hollow points.
/// Points are numbered as the methods are in the tables (methodNumber). No error at all is drawn on the lower
/// edge. An SVG element of its own, 860 x 480, drawn by gnuplot. Errors (kFailed): gnuplot is missing or
/// refuses.
[[nodiscard]] engine::Result<std::string> plotSvg(const bench::Study& study);

/// 1 for the first method of a study, 2 for the next that has another name, ...
[[nodiscard]] int methodNumber(const bench::Study& study, const std::string& method);

}  // namespace fettle::app
