#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/session/session.h"

namespace fettle::engine {

/// What a power failure may lose. Neither loses anything when only the program ends.
enum class Durability : std::uint8_t {
  kPowerFailure,  ///< every commit is flushed to the disk (synchronous=FULL): a power failure loses nothing
                  ///< committed
  kProgramDeath,  ///< commits are written without flushing (synchronous=NORMAL): a power failure loses those
                  ///< since the last checkpoint; the file remains valid
};

struct SessionWriterOptions {
  Durability durability = Durability::kPowerFailure;
  /// Size of the log above which it is checkpointed, when nothing waits to be written [bytes].
  std::size_t checkpoint_bytes = std::size_t{8} << 20;
};

/// State of the writer; a copy, to be read once per frame.
struct SessionStatus {
  std::size_t waiting = 0;           ///< actions that are not in the file yet, the one being written included
  std::int64_t committed_state = 0;  ///< state with which the file would open
  std::uint64_t committed = 0;       ///< actions written since the writer was made
  double last_commit_s = 0.0;        ///< from the call to the end of its transaction
  double worst_commit_s = 0.0;
  std::uint64_t last_commit_bytes = 0;  ///< of tiles, compressed
  std::uint64_t tiles_done = 0;         ///< of the action being written, when it has tiles
  std::uint64_t tiles_total = 0;
  /// The error that prevents writing: nothing is lost, waiting actions are kept in memory and in order. The
  /// writer tries again with every further action and with retry(); saveAs() writes to another path.
  std::optional<Error> error;
};

struct ResumedSession;

/// Updates a session file while the user works: a queue and a thread that writes from it, each action in one
/// transaction with only the tiles it changed.
///
///   main side                                  writer's thread
///   history.push(...)
///   writer.commit(number, step, journal) ----> pack changed tiles, insert rows, commit
///                                              (error: roll back, keep, report, try again)
///   history.undo(); writer.moveTo(number) ---> one row
///   writer.setNote("camera", ...) -----------> one row (a newer text replaces one that still waits)
///   writer.status() <------------------------- waiting, committed, error
///                                              idle and log long: checkpoint it
///
/// The versions of a history, of steps and of the original may be such as are seen under a form: what is stored is
/// restored() (seen_field.h), worked out on the writer's thread, in time proportional to the tiles of a step.
///
/// After SIGKILL at any moment the file opens with all that was committed.
/// One program at a time writes to a session (SessionLock, released by the system when the program ends);
/// others may read.
///
/// Threading: commit, moveTo, setNote, addJournal, retry and status may be called from any one thread (the
/// main side); they allocate and take a lock that is never held over I/O or packing, so they return in
/// microseconds. Versions passed in are released on the writer's thread. flush, saveAs, loadOlder and close
/// wait for the disk: call them from a job, not from the main thread while the user waits; one at a time.
class SessionWriter {
 public:
  /// Saves the session whole (saveSession), then continues from it.
  [[nodiscard]] static Result<std::unique_ptr<SessionWriter>> create(const Session& session,
                                                                     const std::string& path,
                                                                     const SessionWriterOptions& options,
                                                                     JobControl& job);

  /// Opens a session to continue it. Errors as openSession, and: another program works on it, the file or its
  /// folder cannot be written to (openSession and create elsewhere then).
  [[nodiscard]] static Result<ResumedSession> open(const std::string& path,
                                                   const SessionOpenOptions& open_options,
                                                   const SessionWriterOptions& options,
                                                   ScanImport* import_scan, JobControl& job);

  SessionWriter& operator=(SessionWriter&&) = delete;
  /// As close(), errors ignored; does not wait for a writer that cannot write because of an error.
  ~SessionWriter();

  /// The step that led to state `number`; steps after it, if any, are discarded. `number` is one more than
  /// that of the commit or moveTo before. The entries get `number` as their state.
  void commit(std::int64_t number, Step step, std::vector<JournalEntry> journal);

  /// Undo, redo: the field is in state `number` now.
  void moveTo(std::int64_t number, std::vector<JournalEntry> journal);

  /// Stores a text. Without journal it replaces a waiting one of the same key.
  void setNote(std::string key, std::string text, std::vector<JournalEntry> journal = {});

  /// An entry that is not a step.
  void addJournal(JournalEntry entry);

  /// Tries again after an error.
  void retry();

  [[nodiscard]] SessionStatus status() const;
  /// Path of the file.
  [[nodiscard]] std::string path() const;

  /// Waits until all actions passed so far are in the file. Errors: the writer's error if they cannot be
  /// written; cancelled.
  [[nodiscard]] Status flush(JobControl& job);

  /// Saves the session - the file, with all waiting actions - at `path`, whole or not at all, and continues
  /// there. On an error nothing changes. Actions passed meanwhile wait. With its own path it is flush().
  [[nodiscard]] Status saveAs(const std::string& path, OriginalStorage storage, JobControl& job);

  /// Reads the step that led to history.first() from the file, for History::prepend; `before` is as stored, with its form
  /// over it. Errors: there is none (state 0 is held), damage.
  [[nodiscard]] Result<Step> loadOlder(const History& history, JobControl& job);

  /// flush(), then checkpoints the log, so that the session is one ordinary file, and closes it. The writer
  /// cannot be used afterwards.
  [[nodiscard]] Status close(JobControl& job);

 private:
  class Impl;
  explicit SessionWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

struct ResumedSession {
  Session session;
  std::unique_ptr<SessionWriter> writer;
};

}  // namespace fettle::engine
