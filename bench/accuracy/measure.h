#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/study.h"

namespace fettle::bench {

/// Mean, 99th percentile (nearest rank) and largest of errors >= 0; all 0 without errors.
void summarise(std::vector<double> errors, AccuracyRow& row);

/// Median and largest of repeated times.
void spread(std::vector<double> costs, AccuracyRow& row);

/// The row of a subject and method that an answer quotes: the first with both names. Asserts that there is
/// one.
[[nodiscard]] const AccuracyRow& rowOf(const Study& study, const std::string& subject,
                                       const std::string& method);

}  // namespace fettle::bench
