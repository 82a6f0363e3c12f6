#include "app/work/replaced_files.h"

#include <filesystem>

#include <fmt/format.h>

#include "app/work/open_document.h"
#include "engine/session/session_scan.h"

namespace fettle::app {

ReplacedFiles replacedFiles(const std::vector<std::string>& outputs, const std::string& scan) {
  namespace fs = std::filesystem;
  ReplacedFiles replaced;
  for (const std::string& output : outputs) {
    std::error_code error;
    if (output.empty() || !fs::exists(output, error)) continue;
    const std::string name = fs::path(output).filename().string();
    if (!scan.empty() && fs::equivalent(output, scan, error)) {
      replaced.scan = true;
      replaced.texts.push_back(
          fmt::format("{} is the scan that is worked on. Undo and the session keep it; the file will hold "
                      "the field as it is now.",
                      name));
      continue;
    }
    const auto session =
        isSessionPath(output) ? engine::sessionFacts(output) : engine::Result<engine::SessionFacts>();
    if (isSessionPath(output) && session && session->steps > 0)
      replaced.texts.push_back(fmt::format("{} is a session: its {} step{} and its journal will be gone.",
                                           name, session->steps, session->steps == 1 ? "" : "s"));
    else
      replaced.texts.push_back(fmt::format("{} is there already.", name));
  }
  return replaced;
}

}  // namespace fettle::app
