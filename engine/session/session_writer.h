#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/session/session.h"

namespace fettle::engine {

/// What a power failure may take. Neither loses anything when only the program dies.
enum class Durability : std::uint8_t {
  kPowerFailure,  ///< every commit is flushed to the disk (synchronous=FULL): a power failure loses nothing
                  ///< committed
  kProgramDeath,  ///< commits are handed to the system (synchronous=NORMAL): a power failure takes those
                  ///< since the last checkpoint, and leaves the file whole
};

struct SessionWriterOptions {
  Durability durability = Durability::kPowerFailure;
  /// Size of the log beyond which it is worked into the file, when nothing waits to be written [bytes].
  std::size_t checkpoint_bytes = std::size_t{8} << 20;
};

/// How writing goes; a copy, to be looked at once a frame.
struct SessionStatus {
  std::size_t waiting = 0;           ///< actions that are not in the file yet, the one being written included
  std::int64_t committed_state = 0;  ///< state the file would open with
  std::uint64_t committed = 0;       ///< actions written since the writer was made
  double last_commit_s = 0.0;        ///< from the call to the end of its transaction
  double worst_commit_s = 0.0;
  std::uint64_t last_commit_bytes = 0;  ///< of tiles, compressed
  std::uint64_t tiles_done = 0;         ///< of the action being written, when it has tiles
  std::uint64_t tiles_total = 0;
  /// What keeps the writer from writing: nothing is lost, all that waits is kept in memory and in order. It
  /// tries again with every further action and with retry(); saveAs() goes elsewhere.
  std::optional<Error> error;
};

struct ResumedSession;

/// Keeps a session file up to date while the user works: a queue and a thread that writes from it, each
/// action in one transaction that holds just the tiles it changed.
///
///   main side                                  writer's thread
///   history.push(...)
///   writer.commit(number, step, journal) ----> pack changed tiles, insert rows, commit
///                                              (error: roll back, keep, report, try again)
///   history.undo(); writer.moveTo(number) ---> one row
///   writer.setNote("camera", ...) -----------> one row (a newer text replaces one that still waits)
///   writer.status() <------------------------- waiting, committed, error
///                                              idle and log long: work it into the file
///
/// After SIGKILL at any moment the file opens with all that was committed.
/// One program at a time writes to a session (a lock beside it, freed by the system when the program dies);
/// others may read.
///
/// Threading: commit, moveTo, setNote, addJournal, retry and status may be called from any one thread (the
/// main side); they allocate and take a lock that is never held over I/O or packing, so they return in
/// microseconds. Versions that were handed in are let go of on the writer's thread. flush, saveAs, loadOlder
/// and close wait for the disk: not from the main side while the user waits, but from a job of their own; one
/// at a time.
class SessionWriter {
 public:
  /// Saves the session whole (saveSession), then goes on from there.
  [[nodiscard]] static Result<std::unique_ptr<SessionWriter>> create(const Session& session,
                                                                     const std::string& path,
                                                                     const SessionWriterOptions& options,
                                                                     JobControl& job);

  /// Opens a session to go on with it. Errors as openSession, and: another program works on it, the file or
  /// its folder cannot be written to (openSession and create elsewhere then).
  [[nodiscard]] static Result<ResumedSession> open(const std::string& path,
                                                   const SessionOpenOptions& open_options,
                                                   const SessionWriterOptions& options,
                                                   ScanImport* import_scan, JobControl& job);

  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;
  /// As close(), errors ignored; does not wait for a writer that an error keeps from writing.
  ~SessionWriter();

  /// The step that led to state `number`; steps after it, if any, are gone. `number` is one more than that of
  /// the commit or moveTo before. The entries get `number` as their state.
  void commit(std::int64_t number, Step step, std::vector<JournalEntry> journal);

  /// Undo, redo: the field is in state `number` now.
  void moveTo(std::int64_t number, std::vector<JournalEntry> journal);

  /// A text that is to be found again. Without journal it replaces one of the same key that still waits.
  void setNote(std::string key, std::string text, std::vector<JournalEntry> journal = {});

  /// Something to remember that is no step.
  void addJournal(JournalEntry entry);

  /// Tries again after an error.
  void retry();

  [[nodiscard]] SessionStatus status() const;
  /// Where it writes to.
  [[nodiscard]] std::string path() const;

  /// Waits until all that was handed over so far is in the file. The writer's error when it cannot be;
  /// cancelled.
  [[nodiscard]] Status flush(JobControl& job);

  /// Puts the whole session - the file, with all that waits - at `path`, whole or not at all, and goes on
  /// there. On an error everything stays as it was. What is handed over meanwhile waits. Onto itself it is
  /// flush().
  [[nodiscard]] Status saveAs(const std::string& path, OriginalStorage storage, JobControl& job);

  /// Reads the step that led to history.first() from the file, for History::prepend. Errors: there is none
  /// (state 0 is held), damage.
  [[nodiscard]] Result<Step> loadOlder(const History& history, JobControl& job);

  /// flush, works the log in, so that the session is one ordinary file, and lets go of it. The writer is of
  /// no use afterwards.
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
