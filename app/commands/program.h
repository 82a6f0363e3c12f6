#pragma once

#include <functional>

#include "app/commands/command.h"
#include "app/commands/command_line.h"

namespace fettle::app {

/// The whole of main(): signals, command line, the chosen command, its report, the exit status.
/// `add_commands` says which commands there are.
int runProgram(int argc, char** argv, const std::function<void(Command, Chosen&)>& add_commands);

}  // namespace fettle::app
