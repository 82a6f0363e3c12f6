#pragma once

#include <string>
#include <vector>

#include "app/reference/command_table.h"
#include "app/report.h"
#include "engine/field/grid.h"
#include "engine/measure/areal.h"

namespace fettle::app {

// The parameters of `fettle measure` as one table: their groups, keys, names and units, from which the report, the text
// and the CSV are made.

/// "height", "spatial", "hybrid", "functional", "feature", each with what it has.
[[nodiscard]] std::vector<Word> arealGroups();

/// Adds the parameters of these groups and of height (empty: of all) to a report: a key each, null for one that is not stated, and
/// `not_stated` with the reasons. Heights in the height unit of the grid; lengths, densities and curvatures in its
/// lateral unit; ratios as shares of 1.
void addAreal(Report& report, const engine::ArealParameters& measured, const std::vector<std::string>& groups,
              const engine::Grid& grid);

/// One line each under the heading of its group, in units that read at ease where the scan's are metric, else in the
/// scan's. `report` has what addAreal adds.
void printAreal(const Report& report);

/// A parameter of several reports side by side.
struct ArealLine {
  std::string group, name, unit, text;
  std::vector<std::string> values;  ///< one for each report: a figure, or the reason why none is stated
};
/// The parameters that the reports of addAreal have, in the units in which those of the first read at ease.
[[nodiscard]] std::vector<ArealLine> arealLines(const std::vector<Report>& reports);

/// Rows "scan,group,parameter,value,unit,remark" of a report of addAreal, in the scan's units, ratios in per cent;
/// without the heading kArealHeading.
[[nodiscard]] std::string arealRows(const std::string& scan, const Report& report);
inline constexpr const char* kArealHeading = "scan,group,parameter,value,unit,remark\n";

}  // namespace fettle::app
