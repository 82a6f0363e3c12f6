#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/session/session_scan.h"

namespace fettle::app {

/// Error (kInput, naming --force) when `path` is a session with a journal, or a file with a session's
/// extension that cannot be read: manual work would be lost with it. Thread: any.
[[nodiscard]] engine::Status refuseToLoseWork(const std::string& path);

/// Protects sessions while files are replaced: a session that refers to a scan instead of containing it could
/// not be opened again after another file replaced the scan, so the scan is embedded in it before.
///
/// It checks the sessions that can be found: the scan's recovery, those in the folder of the file, and those
/// opened last. They are read once for all calls: make a guard for each command.
///
/// Threading: one thread at a time.
class ScanGuard {
 public:
  /// To be called before a file at `path` is replaced; no effect where there is none. Reports on stderr what
  /// it did. Errors (kInput): the scan cannot be embedded in a session, because another program works on it,
  /// its folder is read-only or the disk is full; kCancelled. A long job when the scan is large.
  [[nodiscard]] engine::Status protectSessions(const std::string& path, engine::JobControl& job);

 private:
  struct Known {
    std::string path;
    engine::SessionFacts facts;
  };
  [[nodiscard]] std::vector<Known>& sessionsIn(const std::string& folder);
  [[nodiscard]] std::vector<Known>& recentSessions();
  [[nodiscard]] engine::Status embed(Known& session, const std::string& scan, engine::JobControl& job);

  std::map<std::string, std::vector<Known>> folders_;
  std::optional<std::vector<Known>> recent_;
};

/// Existing files that are about to be overwritten, for the question before that.
struct ReplacedFiles {
  std::vector<std::string> texts;  ///< a sentence about each, for the user; empty: no such file
  bool scan = false;               ///< the open scan is among them
};

/// `outputs`: the paths that will be written, empty ones apart. `scan`: the file of the open scan; may be
/// empty. A session among the outputs is opened to read its size: some milliseconds.
[[nodiscard]] ReplacedFiles replacedFiles(const std::vector<std::string>& outputs, const std::string& scan);

}  // namespace fettle::app
