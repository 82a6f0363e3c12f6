#pragma once

#include <string>
#include <vector>

namespace fettle::tests {

/// The rows of a table in a document of the source tree ("docs/formats.md"), without its head: of the first
/// line that begins with `head`, as "| format | in |". Each row has the head's number of cells (another number
/// fails the test), without blanks around them. Empty where there is no such table.
[[nodiscard]] std::vector<std::vector<std::string>> markdownTable(const std::string& document,
                                                                  const std::string& head);

}  // namespace fettle::tests
