#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "app/command.h"

namespace fettle::app {

/// The whole of main(): signals, command line, the chosen command, its report, the exit status.
/// `add_commands` says which commands there are.
int runProgram(int argc, char** argv, const std::function<void(CLI::App&, Chosen&)>& add_commands);

}  // namespace fettle::app
