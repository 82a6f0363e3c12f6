#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/work/background.h"
#include "app/work/open_document.h"
#include "engine/session/session_writer.h"
#include "haptic/journal/session_sink.h"

namespace fettle::app {

/// Keeps what is done in a session file from the first step on, without the user asking: in the session that
/// was opened, or in the scan's recovery until the user saves under a name.
///
///   steps, undo, journal ----> [waits while the file is made, on a thread of its own] ----> SessionWriter
///
/// Nothing is made for a scan that is only looked at. A session that refers to the scan's file gets the scan
/// itself before the window replaces that file (keepScan), and as soon as it shows, within a second, that
/// another program has.
///
/// Threading: main; the disk is only waited for on threads of its own, close() excepted.
class SessionKeeper final : public haptic::SessionSink {
 public:
  /// Takes over the document's writer. Its history as it is now is where a new session begins.
  explicit SessionKeeper(Document& document);
  /// As close(kKeep).
  ~SessionKeeper() override;
  SessionKeeper(const SessionKeeper&) = delete;
  SessionKeeper& operator=(const SessionKeeper&) = delete;

  void commit(std::int64_t number, engine::Step step, std::vector<engine::JournalEntry> journal) override;
  void moveTo(std::int64_t number, std::vector<engine::JournalEntry> journal) override;
  void note(std::vector<engine::JournalEntry> journal) override;
  /// A text to be found again under a name, such as "camera".
  void setNote(const std::string& key, const std::string& text);

  /// Once a frame: takes in what its threads have done, tries again after an error now and then.
  void poll();

  /// Puts the session at a path of the user's, whole or not at all, and goes on there; a recovery is removed.
  /// The end shows in saved().
  void saveAs(const std::string& path, engine::OriginalStorage storage);
  [[nodiscard]] bool saving() const noexcept { return saving_.busy() || scan_ == Scan::kWanted; }
  [[nodiscard]] double progress() const noexcept { return saving_.progress(); }
  void cancelSaving() noexcept { saving_.cancel(); }
  /// How saveAs() ended, once.
  [[nodiscard]] std::optional<engine::Status> saved();

  /// Makes the work independent of the scan's file, which is about to be replaced: the session gets the scan,
  /// and one that is made later has it from the start. The end shows in scanKept().
  void keepScan();
  /// How keepScan() ended, once. After an error the session refers to the file as before.
  [[nodiscard]] std::optional<engine::Status> scanKept() { return std::exchange(scan_kept_, std::nullopt); }
  /// The file of the scan that the work began with; empty where it has none.
  [[nodiscard]] const std::string& scanPath() const noexcept { return original_scan_.path; }

  /// Reads the step before the oldest that the history holds, from the file; the end shows in older().
  void readOlder(const engine::History& history);
  [[nodiscard]] bool readingOlder() const noexcept { return reading_.busy(); }
  /// How readOlder() ended, once: for Touch::prepend.
  [[nodiscard]] std::optional<engine::Result<engine::Step>> older() { return reading_.take(); }

  /// Whether the session lies where the user wants it (opened from there, or saved as).
  [[nodiscard]] bool named() const noexcept { return named_; }
  /// Where it is written to; empty before the first step.
  [[nodiscard]] std::string path() const;
  /// Steps and moves that are not on the disk yet; the file itself while it is being made.
  [[nodiscard]] std::size_t waiting() const;
  /// Why they cannot be written; they are kept in memory.
  [[nodiscard]] std::optional<engine::Error> error() const;
  [[nodiscard]] engine::SessionStatus status() const;

  enum class Afterwards : std::uint8_t {
    kKeep,     ///< the file stays: it is the user's, or to be recovered
    kDiscard,  ///< a recovery is removed
  };
  /// Writes what waits and lets go of the file. Blocks, some milliseconds a stroke; returns the error that
  /// keeps something from being written. Of no use afterwards.
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
  // A file that is being made, or is to be moved to.
  struct Place {
    std::string path;
    engine::OriginalStorage storage = engine::OriginalStorage::kReferenced;
    bool named = false;  // by the user
  };
  using Writer = std::unique_ptr<engine::SessionWriter>;
  void hand(Waiting&& what);
  void give(Waiting&& what);
  void make(const Place& place);
  void made(engine::Result<Writer> result);
  void move(const Place& place);
  void embedScan();
  [[nodiscard]] bool scanReplaced() const;
  [[nodiscard]] engine::OriginalStorage storageFor(engine::OriginalStorage wanted) const;

  // What becomes of the scan in a session that refers to its file.
  enum class Scan : std::uint8_t {
    kReferenced,
    kWanted,    // to be put in as soon as nothing else is done with the session
    kBeingPut,  // by saving_
    kEmbedded,  // in the session there is, and in each that will be made
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
  std::optional<engine::Error> failed_;  // to make the file
  std::chrono::steady_clock::time_point tried_{};

  Place making_place_, moving_place_;
  std::optional<Place> wanted_;  // asked for while the file is being made
  std::optional<engine::Status> saved_;
  Scan scan_ = Scan::kReferenced;
  bool scan_asked_ = false;  // by keepScan()
  std::optional<engine::Status> scan_kept_;
  std::chrono::steady_clock::time_point looked_{};  // at the scan's file
  Background<Writer> making_;
  Background<bool> saving_;
  Background<engine::Step> reading_;
};

}  // namespace fettle::app
