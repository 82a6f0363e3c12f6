#pragma once

#include <map>
#include <string>
#include <variant>
#include <vector>

#include <pybind11/pybind11.h>

#include "python/scan.h"

namespace fettle::python {

/// What a command reads from memory: a scan (or the marks of one), or edge lines, by the name that stands in its arguments.
using Given = std::map<std::string, std::variant<Scan, std::vector<LineRow>>>;

/// Runs a command as `fettle` does with these arguments, the command's name first. Names "<...>" in them are places in memory:
/// those of `given` hold what the command reads, those of `made` get what it writes. `help` is the remedy of an
/// error of usage.
///
/// Returns its report as JSON text, a dict from the names of `made` to what was written (a Scan, a list of LineRow,
/// or a picture, an array of bytes: height x width x 4, R G B A, top row first), and the warnings. What a command writes keeps
/// the original of `source`, the name of one of `given`, where the command states none.
///
/// Errors: fettle.InputError, fettle.Error, KeyboardInterrupt and what `progress` raises (waiting.h). Thread: any of
/// Python's, holds the GIL and gives it back while the command runs; several at once.
[[nodiscard]] pybind11::tuple callCommand(const std::vector<std::string>& arguments, const Given& given,
                                          const std::vector<std::string>& made, const std::string& source,
                                          const std::string& help, const pybind11::object& progress);

/// The table of the commands that callCommand runs, as JSON text (`fettle reference`: parameters.json).
[[nodiscard]] std::string commandTables();

}  // namespace fettle::python
