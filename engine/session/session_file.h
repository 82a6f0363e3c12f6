#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/base/stopwatch.h"
#include "engine/session/session_lock.h"
#include "engine/session/session_rows.h"
#include "engine/session/session_writer.h"

namespace fettle::engine {

/// One request of the main thread.
struct SessionAction {
  enum class Kind : std::uint8_t { kStep, kMove, kNote, kJournal };
  Kind kind = Kind::kJournal;
  std::int64_t number = 0;  ///< kStep, kMove: the state it leads to
  Step step;
  std::vector<JournalEntry> journal;
  std::string key;
  std::string text;
  Stopwatch since_enqueued;  ///< the action is made when it is enqueued
};

/// A session file open for writing: connection, lock and the head as last committed.
/// Threading: one thread at a time.
class SessionFile {
 public:
  /// The caller passes the lock it holds. Reads only the head.
  [[nodiscard]] static Result<std::unique_ptr<SessionFile>> open(const std::string& path, SessionLock lock,
                                                                 Durability durability);

  /// One transaction; `bytes` of packed tiles. A step's versions may be as seen under a form: the samples are stored.
  [[nodiscard]] Status write(const SessionAction& action, std::uint64_t& bytes, JobControl& job);

  /// A copy of the session, with `waiting` applied, whole or not at all at `path`, whose lock the caller
  /// holds. With kEmbedded the scan is embedded.
  [[nodiscard]] Status copyTo(const std::string& path, const std::vector<const SessionAction*>& waiting,
                              OriginalStorage storage, const Version& original, JobControl& job);

  /// Embeds the scan in this file.
  [[nodiscard]] Status embed(const Version& original, JobControl& job);

  /// Checkpoints the log when it is longer than `bytes`.
  void checkpoint(std::size_t bytes);
  /// Checkpoints the log and makes the session one ordinary file again, unless another program reads it.
  void settle();

  [[nodiscard]] const HeadRow& head() const noexcept { return head_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] SessionTables& tables() noexcept { return *tables_; }

 private:
  SessionFile(std::string path, SessionLock lock) : path_(std::move(path)), lock_(std::move(lock)) {}

  std::string path_;
  SessionLock lock_;  // released last
  std::unique_ptr<Database> database_;
  std::unique_ptr<SessionTables> tables_;
  HeadRow head_;
  StoredStates states_;  // of the steps that were written
};

}  // namespace fettle::engine
