#pragma once

#include <string>
#include <vector>

namespace fettle::app {

/// Files that are there already where something is about to be written, for the question before they go.
struct ReplacedFiles {
  std::vector<std::string> texts;  ///< a sentence on each, for a person; empty: there is none
  bool scan = false;               ///< the scan that is worked on is among them
};

/// `outputs`: the paths that will be written, empty ones apart. `scan`: the file of the scan that is worked
/// on; may be empty. A session among the outputs is opened for what it holds: some milliseconds.
[[nodiscard]] ReplacedFiles replacedFiles(const std::vector<std::string>& outputs, const std::string& scan);

}  // namespace fettle::app
