#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/session/session_scan.h"

namespace fettle::app {

/// Refuses when a session with a journal stands at `path`, or a file that is called a session and cannot be
/// read: what a person did by hand would be lost with it. Error: kInput, naming --force. Thread: any.
[[nodiscard]] engine::Status refuseToLoseWork(const std::string& path);

/// Keeps sessions whole while files are replaced: a session that refers to a scan instead of holding it could
/// not be opened again once another file stood in the scan's place, so it is given the scan before.
///
/// Looked at are the sessions that can be found: the scan's recovery, those in the folder of the file, and
/// those opened last. They are read once for all calls: make a guard for each command.
///
/// Threading: one thread at a time.
class ScanGuard {
 public:
  /// To be called before a file at `path` is replaced; does nothing where there is none. Says on stderr what
  /// it did. Errors (kInput): a session of that scan cannot take it in, because another program works on it,
  /// its folder is read-only or the disk is full; kCancelled. A long job when the scan is large.
  [[nodiscard]] engine::Status spare(const std::string& path, engine::JobControl& job);

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

}  // namespace fettle::app
