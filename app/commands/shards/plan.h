#pragma once

#include <string>
#include <vector>

#include "app/commands/command.h"

namespace fettle::app {

/// The arguments of a shard, without --shard, from those of the program that planned it: without the words of `plan` and of how its
/// report is printed.
[[nodiscard]] std::vector<std::string> shardArguments(const std::vector<std::string>& arguments);

/// The words of a shard of a plan for this `command` with these `arguments`, and its threads: without them it would take all cores, and
/// more time and memory than were foreseen.
[[nodiscard]] std::vector<std::string> shardWords(const std::string& command,
                                                  const std::vector<std::string>& arguments, int threads);

void printPlan(const Report& report);

// The commands below `fettle plan`, each in the source of the command that it plans.
void addPlanFilter(Command plan, Chosen& chosen);
void addPlanConvert(Command plan, Chosen& chosen);

}  // namespace fettle::app
