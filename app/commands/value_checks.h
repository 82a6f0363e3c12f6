#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/reference/command_table.h"

namespace fettle::app {

/// What is checked of each value of a parameter as it is typed: range, words, that a file or folder is not
/// "-", and its own check. A check returns the problem, or an empty text.
[[nodiscard]] std::vector<std::function<std::string(const std::string&)>> problemsOf(
    const Parameter& parameter);

}  // namespace fettle::app
