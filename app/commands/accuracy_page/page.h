#pragma once

#include <string>
#include <vector>

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

struct PlottedStudy {
  bench::Study study;
  std::string svg;
  std::vector<std::string> view_svgs;  ///< of study.views
};

/// The whole report as one HTML page without other files. `machine` and `made_with` (the options) are printed
/// at its head.
[[nodiscard]] std::string accuracyPage(const std::vector<PlottedStudy>& studies, const std::string& machine,
                                       const std::string& made_with);

/// Every row of every study:
/// study,subject,number,method,cost,cost_worst,cost_unit,error,error_p99,error_worst,
/// error_unit,wrong,hash,note, then the further columns of all studies. Texts are quoted; values that a study
/// does not have are empty.
[[nodiscard]] std::string accuracyCsv(const std::vector<PlottedStudy>& studies);

}  // namespace fettle::app
