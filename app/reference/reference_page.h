#pragma once

#include <string>

#include "app/reference/command_table.h"
#include "app/report.h"

namespace fettle::app {

/// Every command with its parameters as a page in Markdown: a heading for each command, a table for each group
/// of parameters.
[[nodiscard]] std::string referencePage(const CommandTable& root);

/// The tables of a program as one object: what other programs make their own interfaces of. `schema` is 1;
/// later versions only add keys.
[[nodiscard]] Report tableReport(const CommandTable& root);

}  // namespace fettle::app
