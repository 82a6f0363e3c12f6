#pragma once

#include <functional>

#include "app/commands/command.h"
#include "app/commands/command_line.h"

namespace fettle::app {

/// All of main(): signals, command line, the chosen command, its report, the exit status. `add_commands` adds
/// the commands.
int runProgram(int argc, char** argv, const std::function<void(Command, Chosen&)>& add_commands);

}  // namespace fettle::app
