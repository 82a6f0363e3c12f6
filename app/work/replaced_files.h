#pragma once

#include <string>
#include <vector>

namespace fettle::app {

/// Existing files that are about to be overwritten, for the question before that.
struct ReplacedFiles {
  std::vector<std::string> texts;  ///< a sentence about each, for the user; empty: no such file
  bool scan = false;               ///< the open scan is among them
};

/// `outputs`: the paths that will be written, empty ones apart. `scan`: the file of the open scan; may be
/// empty. A session among the outputs is opened to read its size: some milliseconds.
[[nodiscard]] ReplacedFiles replacedFiles(const std::vector<std::string>& outputs, const std::string& scan);

}  // namespace fettle::app
