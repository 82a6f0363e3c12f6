#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/work/background.h"
#include "app/work/form_originals.h"
#include "app/work/open_document.h"
#include "engine/session/session_writer.h"
#include "haptic/journal/session_sink.h"

namespace fettle::app {

/// Stores all work in a session file from the first step on, automatically: in the session that was opened,
/// or in the scan's recovery until the user saves under a name.
///
///   steps, undo, journal ----> [waits while the file is created, on its own thread] ----> SessionWriter
///
/// No file is created for a scan that is only viewed. The scan is embedded in a session that refers to its
/// file before the window replaces that file (keepScan), and within a second after another program has
/// replaced it.
///
/// Threading: main; only its own threads wait for the disk, except in close().
class SessionKeeper final : public haptic::SessionSink {
 public:
  /// Takes over the document's writer. A new session begins with the document's present history.
  explicit SessionKeeper(Document& document);
  /// As close(kKeep).
  ~SessionKeeper() override;
  SessionKeeper& operator=(SessionKeeper&&) = delete;

  void commit(std::int64_t number, engine::Step step, std::vector<engine::JournalEntry> journal) override;
  void moveTo(std::int64_t number, std::vector<engine::JournalEntry> journal) override;
  void note(std::vector<engine::JournalEntry> journal) override;
  /// Stores a text under a name, such as "camera".
  void setNote(const std::string& key, const std::string& text);

  /// To be called once per frame: takes over results of its threads, tries again after an error at intervals.
  void poll();

  /// Saves the session at a path chosen by the user, whole or not at all, and continues there; a recovery is
  /// removed. saved() reports the end.
  void saveAs(const std::string& path, engine::OriginalStorage storage);
  [[nodiscard]] bool saving() const noexcept { return saving_.busy() || scan_ == Scan::kRequested; }
  [[nodiscard]] WorkProgress progress() const { return saving_.progress(); }
  void cancelSaving() noexcept { saving_.cancel(); }
  /// How saveAs() ended, once.
  [[nodiscard]] std::optional<engine::Status> saved();

  /// Makes the work independent of the scan's file, which is about to be replaced: the scan is embedded in
  /// the session, also in one created later. scanKept() reports the end.
  void keepScan();
  /// How keepScan() ended, once. After an error the session refers to the file as before.
  [[nodiscard]] std::optional<engine::Status> scanKept() { return std::exchange(scan_kept_, std::nullopt); }
  /// The file of the original scan; empty where there is none.
  [[nodiscard]] const std::string& scanPath() const noexcept { return original_scan_.path; }

  /// Reads the step before the oldest of the history from the file; older() returns the result.
  void readOlder(const engine::History& history);
  [[nodiscard]] bool readingOlder() const noexcept { return reading_.busy(); }
  /// Result of readOlder(), once: for LoopClient::prepend. A state under a form as it is seen: made of all its samples,
  /// where the step after it has another form.
  struct Older {
    engine::Step step;
    engine::Version original;  ///< of the state before it
  };
  [[nodiscard]] std::optional<engine::Result<Older>> older() { return reading_.take(); }

  /// Whether the session has a path chosen by the user (opened from there, or saved as).
  [[nodiscard]] bool named() const noexcept { return named_; }
  /// Path of the session; empty before the first step.
  [[nodiscard]] std::string path() const;
  /// Number of steps and moves that are not on the disk yet; counts the file itself while it is being
  /// created.
  [[nodiscard]] std::size_t waiting() const;
  /// Why they cannot be written; they are kept in memory.
  [[nodiscard]] std::optional<engine::Error> error() const;
  [[nodiscard]] engine::SessionStatus status() const;

  enum class Afterwards : std::uint8_t {
    kKeep,     ///< the file stays: it is the user's, or to be recovered
    kDiscard,  ///< a recovery is removed
  };
  /// Writes waiting actions and closes the file. Blocks, some milliseconds per stroke; returns the error that
  /// prevented writing. Not to be used afterwards.
  engine::Status close(Afterwards afterwards);

 private:
  struct Waiting {
    enum class Kind : std::uint8_t { kCommit, kMove, kJournal, kNote };
    Kind kind;
    std::int64_t number = 0;
    engine::Step step;
    std::vector<engine::JournalEntry> journal;
    std::string key, text;
  };
  // A file that is being created, or that the session is to be saved as.
  struct Place {
    std::string path;
    engine::OriginalStorage storage = engine::OriginalStorage::kReferenced;
    bool named = false;  // by the user
  };
  using Writer = std::unique_ptr<engine::SessionWriter>;
  void enqueue(Waiting&& what);
  void passToWriter(Waiting&& what);
  void make(const Place& place);
  void made(engine::Result<Writer> result);
  void move(const Place& place);
  void embedScan();
  [[nodiscard]] bool scanReplaced() const;
  [[nodiscard]] engine::OriginalStorage storageFor(engine::OriginalStorage storage) const;

  // State of the scan in a session that refers to its file.
  enum class Scan : std::uint8_t {
    kReferenced,
    kRequested,  // to be embedded when no other job uses the session
    kBeingPut,   // by saving_
    kEmbedded,   // in the present session, and in each that will be created
  };

  engine::OriginalScan original_scan_;
  engine::Version original_;
  engine::History start_;
  engine::SessionNotes notes_;
  std::string recovery_path_;

  Writer writer_;
  std::vector<Waiting> waiting_;  // in order, until there is a writer
  bool named_ = false;
  bool closed_ = false;
  std::optional<engine::Error> failed_;  // of creating the file
  std::chrono::steady_clock::time_point tried_{};

  Place making_place_, moving_place_;
  std::optional<Place> requested_;  // requested while the file is being created
  std::optional<engine::Status> saved_;
  Scan scan_ = Scan::kReferenced;
  bool scan_requested_ = false;  // by keepScan()
  std::optional<engine::Status> scan_kept_;
  std::chrono::steady_clock::time_point checked_at_{};  // last check of the scan's file
  Background<Writer> making_;
  Background<bool> saving_;
  Background<Older> reading_;
};

}  // namespace fettle::app
