#pragma once

#include <string>

#include "app/reference/command_table.h"

namespace fettle::app {

/// What stands at the foot of every page: "fettle 0.1.0".
struct ManVersion {
  std::string program;
  std::string date = {};  ///< "2026-11-25"; empty: none
};

/// "fettle-bench-haptic": the name of a command's page, in section 1.
[[nodiscard]] std::string manName(const CommandTable& command);

/// A command's manual page, in the man macros of roff (man(7)). `root` is the program, for references to its
/// other pages.
[[nodiscard]] std::string manPage(const CommandTable& command, const CommandTable& root,
                                  const ManVersion& version);

}  // namespace fettle::app
