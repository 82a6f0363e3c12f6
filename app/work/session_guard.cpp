#include "app/work/session_guard.h"

#include <filesystem>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/work/open_document.h"
#include "app/work/recent_files.h"
#include "engine/formats/formats.h"

namespace fettle::app {

namespace {

namespace fs = std::filesystem;

// Sessions that refer to a scan; others, and other files, need no protection.
std::optional<engine::SessionFacts> referring(const std::string& path) {
  auto facts = engine::sessionFacts(path);
  if (!facts || facts->storage == engine::OriginalStorage::kEmbedded) return std::nullopt;
  return *std::move(facts);
}

}  // namespace

engine::Status refuseToLoseWork(const std::string& path) {
  std::error_code error;
  const auto bytes = fs::file_size(path, error);
  if (error || bytes == 0) return {};
  const auto facts = engine::sessionFacts(path);
  if (!facts)
    return engine::inputError(
        fmt::format("the existing file cannot be read as a session: {}", facts.error().what), path,
        "name another file, or replace it with --force");
  if (facts->journal_entries == 0) return {};
  return engine::inputError(
      fmt::format("the session there has a journal of {} entries and {} step{}, which would be lost",
                  facts->journal_entries, facts->steps, facts->steps == 1 ? "" : "s"),
      path, "name another file, or replace it with --force");
}

std::vector<ScanGuard::Known>& ScanGuard::sessionsIn(const std::string& folder) {
  const auto [place, fresh] = folders_.try_emplace(folder);
  if (!fresh) return place->second;
  std::error_code error;
  for (fs::directory_iterator it(folder.empty() ? "." : folder, error), end; !error && it != end;
       it.increment(error))
    if (const std::string path = it->path().string(); isSessionPath(path))
      if (auto facts = referring(path)) place->second.push_back({path, *std::move(facts)});
  return place->second;
}

std::vector<ScanGuard::Known>& ScanGuard::recentSessions() {
  if (!recent_) {
    recent_.emplace();
    const RecentFiles files(recentFile());
    for (const std::string& path : files.paths())
      if (isSessionPath(path))
        if (auto facts = referring(path)) recent_->push_back({path, *std::move(facts)});
  }
  return *recent_;
}

engine::Status ScanGuard::embed(Known& session, const std::string& scan, engine::JobControl& job) {
  if (!engine::needsFile(session.facts, scan)) return {};
  if (auto done = engine::embedScan(session.path, engine::importField, job); !done) {
    if (done.error().kind == engine::ErrorKind::kCancelled) return done;
    return engine::inputError(fmt::format("it is the scan of the session {}, which cannot take it in: {}",
                                          session.path, done.error().what),
                              scan, "close that session, or name another file");
  }
  session.facts = {};
  warn(fmt::format("{}: is the scan of the session {}, which holds it itself from now on", scan,
                   session.path));
  return {};
}

engine::Status ScanGuard::protectSessions(const std::string& path, engine::JobControl& job) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return {};
  const std::string recovery = recoveryPath(path);
  if (auto facts = referring(recovery)) {
    Known session{recovery, *std::move(facts)};
    if (auto status = embed(session, path, job); !status) return status;
  }
  for (std::vector<Known>* sessions : {&sessionsIn(fs::path(path).parent_path().string()), &recentSessions()})
    for (Known& session : *sessions)
      if (auto status = embed(session, path, job); !status) return status;
  return {};
}

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
