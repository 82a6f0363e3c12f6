#pragma once

#include <string>
#include <vector>

namespace fettle::tests {

/// An interactive shell in a terminal of its own: `shell` is what starts it. `setup` is given to it as lines; one of these must
/// bind Ctrl-X Ctrl-X to what prints the line under edit between '<' and '>'; neither may be in `setup`, which the terminal
/// shows. Each of `typed` is typed and completed with Tab; the blank after that
/// removes what zsh adds in case that a list goes on.
/// Returns the lines after that; an empty text for one that does not come within 20 s. Thread: any.
[[nodiscard]] std::vector<std::string> completedInTerminal(const std::vector<std::string>& shell,
                                                           const std::vector<std::string>& setup,
                                                           const std::vector<std::string>& typed);

}  // namespace fettle::tests
