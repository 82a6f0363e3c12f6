#pragma once

#include <vector>

#include "app/commands/command.h"
#include "app/work/areal_choice.h"
#include "engine/base/error.h"

namespace fettle::app {

/// Which ratios and features the parameters of a surface are of, as typed.
struct ArealArguments {
  std::vector<double> volumes;     ///< p and q [%]; empty: the usual ones
  std::vector<double> difference;  ///< of Sdc [%]; empty: none
  double prune = 5.0;              ///< [% of Sz]
};

/// --ratios, --height-between, --prune.
void addArealOptions(Command command, ArealArguments& arguments);

/// Refuses ratios that are none or not in order (kInput).
[[nodiscard]] engine::Status checkAreal(const ArealArguments& arguments);

/// What they mean, checked.
[[nodiscard]] ArealChoice choiceOf(const ArealArguments& arguments);

}  // namespace fettle::app
