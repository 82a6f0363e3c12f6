#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/command_line.h"
#include "app/report.h"
#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

/// Runs one command within this process and returns what it reports with --json. `arguments` are those of the command
/// line, the command's name first; `add_commands` adds the commands that may be named; `help` is the remedy of an error
/// of usage. Signals, standard input and output stay as they are. A path may name a place in memory (MemoryPlaces),
/// and warnings go where the thread keeps them (KeptMessages).
///
/// Errors: those of the command; kInput for arguments that it does not take; kFailed when memory runs out. Throws
/// nothing. Thread: any, several at once; the options --store and --validate hold for the whole process.
[[nodiscard]] engine::Result<Report> callCommand(const std::vector<std::string>& arguments,
                                                 const std::function<void(Command, Chosen&)>& add_commands,
                                                 const std::string& help, engine::JobControl& job);

/// The table of those commands, as `fettle reference` writes it to parameters.json.
[[nodiscard]] Report commandTables(const std::function<void(Command, Chosen&)>& add_commands);

}  // namespace fettle::app
