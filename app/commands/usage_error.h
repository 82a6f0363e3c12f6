#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/commands/command_line.h"
#include "engine/base/error.h"

namespace fettle::app {

/// The error of an empty argument, where one is; only a title may be empty. `arguments` begin with the program's name.
[[nodiscard]] std::optional<engine::Error> emptyArgument(const std::vector<std::string>& arguments);

/// The error of a command line that could not be parsed: the wrong word, and a suggestion or `help`.
[[nodiscard]] engine::Error usageError(const Misread& misread, const std::string& help);

}  // namespace fettle::app
