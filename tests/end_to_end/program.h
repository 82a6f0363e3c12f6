#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace fettle::tests {

/// Runs the built fettle with these arguments.
[[nodiscard]] Outcome fettle(std::vector<std::string> arguments, const ProcessOptions& options = {});

/// The same with --json; the object it printed, which must be as its schema states (report_check.h). A failure is a failed test and an empty object.
[[nodiscard]] nlohmann::json fettleJson(std::vector<std::string> arguments);

/// Expects the outcome of what the machine could not do: exit status 1, nothing on stdout, one line
/// "fettle: error: ..." on stderr that holds `part`.
void expectFailed(const Outcome& outcome, const std::string& part);

/// Expects the outcome of bad input: exit status 2, nothing on stdout, one line "fettle: error: ..." on
/// stderr that holds `part`.
void expectRefused(const Outcome& outcome, const std::string& part);

}  // namespace fettle::tests
