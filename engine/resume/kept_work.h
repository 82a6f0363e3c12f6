#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "engine/base/stopwatch.h"
#include "engine/filter/filter_work.h"
#include "engine/resume/kept_rounds.h"
#include "engine/resume/work_file.h"
#include "engine/resume/work_identity.h"

namespace fettle::engine {

/// How work is kept.
struct KeepOptions {
  std::string path;  ///< of the file
  /// Between two times that it is written, or as much more as keeps writing to a twentieth of the time; 0: each block
  /// at once, whatever that takes.
  double every_seconds = 15.0;
  /// Called when the file could not be written, on a thread of the keeper's own; the work goes on, and it is tried
  /// again.
  std::function<void(const Error&)> on_trouble;
};

/// Keeps the finished blocks of one applyFilter in a file, so that the same filter of the same field continues after it
/// was cut off, with the same bits.
///
/// A thread of its own writes what was finished, every KeepOptions::every_seconds. Between passes the whole state is written where that keeps to the same share, else the next pass is not kept
/// and begins again after a cut. What is lost is the time between two writes, and at most one pass beyond. Rounds are kept beside it, as seldom.
///
/// Threading: as FilterWork; the rest on the thread of applyFilter.
class KeptWork final : public FilterWork {
 public:
  /// Errors (kInput): the file is of another identity, no file of kept work, in use, or cannot be written.
  [[nodiscard]] static Result<std::unique_ptr<KeptWork>> open(KeepOptions options,
                                                              const WorkIdentity& identity,
                                                              const Version& input);
  /// Writes what is finished and leaves the file, for another time.
  ~KeptWork() override;
  KeptWork& operator=(KeptWork&&) = delete;

  /// Where the rounds of a robust filter are kept, beside the file of the other kept work.
  [[nodiscard]] static std::string roundsOf(const std::string& path) { return path + ".rounds"; }

  /// Rounds of its pass that were there, where the filter has rounds.
  [[nodiscard]] int roundsAtStart() const noexcept { return rounds_at_start_; }
  /// Share of the whole work that the file held when it was opened, 0 .. 1.
  [[nodiscard]] double shareAtStart(int passes) const noexcept;
  /// Bytes of the file that were damaged and are worked out again.
  [[nodiscard]] std::uint64_t damagedBytes() const noexcept { return damaged_; }
  /// Time that was spent on writing the file [s], and the most bytes that it had.
  [[nodiscard]] double secondsWriting() const;
  [[nodiscard]] std::uint64_t mostBytes() const;

  /// Writes what is finished now; any thread. Errors as WorkFile::append.
  [[nodiscard]] Status keep();
  /// The result is safe elsewhere: removes the file.
  void finish();

  [[nodiscard]] Result<State> begin(const Version& input) override;
  [[nodiscard]] Status beginPass(const State& before) override;
  [[nodiscard]] std::optional<Rounds> roundsBefore() override;
  [[nodiscard]] bool wantsRounds() override;
  void roundDone(const Rounds& rounds) override;
  [[nodiscard]] bool isDone(const TileRect& block) override;
  void done(const TileRect& block, std::vector<NewTile>& made, std::size_t first) override;
  void addMade(std::vector<NewTile>& made) override;

 private:
  KeptWork(KeepOptions options, const WorkIdentity& identity, const Version& input);
  [[nodiscard]] Status read();
  [[nodiscard]] TileRef restored(std::int32_t column, std::int32_t row, const float* samples) const;
  [[nodiscard]] Status writePending();  // with writing_ held
  // Time to the next write, of which the last took so long [s].
  [[nodiscard]] double pauseAfter(double seconds) const noexcept;
  void writeRegularly();
  void report(const Error& error);
  [[nodiscard]] bool wasDone(std::int32_t column, std::int32_t row) const noexcept {
    return done_before_[static_cast<std::size_t>(row) * static_cast<std::size_t>(tile_columns_) +
                        static_cast<std::size_t>(column)];
  }

  KeepOptions options_;
  std::string identity_;
  Version input_;
  std::int32_t tile_columns_ = 0, tile_rows_ = 0;
  std::uint64_t damaged_ = 0;

  State start_;                    // that the file held
  DoneBlocks taken_;               // and of the pass after it
  std::vector<bool> done_before_;  // by tile; only written between passes
  bool first_pass_ = true, keeps_this_pass_ = false;
  KeptRounds rounds_;
  int pass_ = 0;  // that has begun, from 0
  int rounds_at_start_ = 0;
  double last_rounds_seconds_ = 0.0;
  Stopwatch since_rounds_;
  double last_state_seconds_ = 0.0;
  Stopwatch since_state_;

  std::mutex writing_;  // over file_; taken before mutex_
  WorkFile file_;

  mutable std::mutex mutex_;  // over all below
  std::condition_variable wake_;
  DoneBlocks pending_;
  bool troubled_ = false, ended_ = false;
  double seconds_ = 0.0, last_seconds_ = 0.0;  // of all writes, of the last part
  std::uint64_t most_bytes_ = 0;

  std::thread writer_;
};

}  // namespace fettle::engine
