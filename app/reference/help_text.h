#pragma once

#include <string>

#include "app/reference/command_table.h"

namespace fettle::app {

/// `text` broken at blanks into lines of at most `width` characters, all but the first indented by `indent`
/// blanks; line ends in it stay. A word that is longer than a line stays whole.
[[nodiscard]] std::string wrapped(const std::string& text, std::size_t width, std::size_t indent);

/// What `fettle COMMAND --help` prints: lines of 100 characters at most.
[[nodiscard]] std::string helpText(const CommandTable& command);

}  // namespace fettle::app
