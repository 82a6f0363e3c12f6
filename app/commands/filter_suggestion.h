#pragma once

#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/filter_arguments.h"
#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

// `fettle filter --suggest`: filters are tried on pieces of each scan, and nothing is filtered or written. Of one scan a
// report with the candidates, the reason and the commands that run the choice; of several a report for each. Refuses the
// options that it has no use for. `arguments` are the whole command line, which a shard of a list keeps.
engine::Result<Report> suggestFilters(const FilterArguments& options,
                                      const std::vector<std::string>& arguments, engine::JobControl& job);

bool isSuggestion(const Report& report);

// Of one scan, what isSuggestion() knows: filters, places, or both.
void printSuggestion(const Report& report);

}  // namespace fettle::app
