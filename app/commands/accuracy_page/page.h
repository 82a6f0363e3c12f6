#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/study.h"

namespace fettle::app {

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
