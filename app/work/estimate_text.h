#pragma once

#include <string>

#include "app/report.h"
#include "app/work/read_units.h"

namespace fettle::app {

/// A number of a report to 6 digits; "-" where there is none.
[[nodiscard]] std::string shownNumber(const Report& value);

/// A value to two digits of its standard error, at least 2 and at most 12; without an error to 6 digits.
[[nodiscard]] std::string shownTo(double value, double error);

/// "12.3 +- 0.2 um": the figure KEY_UNIT of a report beside KEY_error_UNIT, read in the unit `as`.
[[nodiscard]] std::string shownEstimate(const Report& report, const std::string& key, const std::string& unit,
                                        const ReadAs& as);

}  // namespace fettle::app
