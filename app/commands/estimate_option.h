#pragma once

#include <optional>

#include "app/commands/command.h"
#include "app/report.h"
#include "app/work/work_estimate.h"
#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

/// --estimate.
void addEstimateOption(Command command, bool& only);

/// What is known before the work.
struct Foreseen {
  std::optional<WorkEstimate> estimate;  ///< nothing where the work is too short for one
  std::optional<Report> only;            ///< with --estimate: the whole report, nothing is to be done
};

/// Estimates work before it begins (estimateWork), refuses what cannot fit (checkRoom), and of long work says one line.
/// `name`: of what the line is about. Errors as estimateWork and checkRoom.
[[nodiscard]] engine::Result<Foreseen> foresee(const PlannedWork& work, const std::string& name, bool only,
                                               engine::JobControl& job);

}  // namespace fettle::app
