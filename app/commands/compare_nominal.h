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

/// `fettle compare` where B is a mesh.
struct NominalComparison {
  const std::string &part, &nominal;  ///< paths
  const InspectArguments& inspect;
  const RegionArguments& counted;  ///< of the part
  const AlignArguments* align;     ///< null: it is measured in the place that the files state
  const ScanOptions& reading;
  const std::string& deviation;  ///< to write, empty: nothing; to "-" in the format `to`
  const std::string& to;
  bool estimate;
};

/// Its report: how the part deviates from the mesh, above 0 where the part has more; or an estimate alone.
[[nodiscard]] engine::Result<Report> compareNominal(const NominalComparison& comparison,
                                                    engine::JobControl& job);

}  // namespace fettle::app
