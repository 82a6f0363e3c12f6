#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/reference/command_table.h"

namespace fettle::app {

/// The problem of "-" for a parameter that takes no stream; else empty. For Parameter::problem, of kinds that may be one.
[[nodiscard]] std::string streamProblem(const std::string& typed);

/// What is checked of each value of a parameter as it is typed: range, words, that a file or folder is not
/// "-", and its own check. A check returns the problem, or an empty text.
[[nodiscard]] std::vector<std::function<std::string(const std::string&)>> problemsOf(
    const Parameter& parameter);

}  // namespace fettle::app
