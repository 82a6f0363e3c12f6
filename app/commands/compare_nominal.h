#pragma once

#include <string>

#include "app/commands/align_option.h"
#include "app/commands/command.h"
#include "app/commands/nominal_option.h"
#include "app/work/scan_reading.h"
#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

/// How a part is compared with a nominal mesh.
struct InspectArguments {
  NominalArguments nominal;
  std::string distance = "vertical";  ///< or "shortest"
  std::string tolerance;              ///< a height; empty: none
};

/// --nominal-unit, --distance, --tolerance.
void addInspectOptions(Command command, InspectArguments& arguments);

/// The option among these that is given although B is no mesh; empty: none.
[[nodiscard]] std::string optionOfNominal(const InspectArguments& arguments);

/// The report of fettle compare where B is a mesh: how the part deviates from it, above 0 where the part has more.
/// `align`: null where it is measured in the place that the files state. Writes `deviation`, empty: nothing.
[[nodiscard]] engine::Result<Report> compareNominal(const std::string& part, const std::string& nominal,
                                                    const InspectArguments& arguments,
                                                    const AlignArguments* align, const ScanOptions& reading,
                                                    const std::string& deviation, const std::string& to,
                                                    engine::JobControl& job);

}  // namespace fettle::app
