#include "engine/session/session_writer.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <new>
#include <thread>

#include "engine/base/thread_priority.h"
#include "engine/field/seen_field.h"
#include "engine/session/session_file.h"
#include "engine/session/session_reader.h"
#include "engine/session/session_save.h"

namespace fettle::engine {

constexpr auto kPollInterval = std::chrono::milliseconds(20);  // of a waiting call, for a cancel

/// Two locks, always taken in this order: `file_lock_` for the file, held while it is written or used
/// otherwise; `queue_lock_` for all data of the main thread's calls, held for a few instructions at a time.
class SessionWriter::Impl {
 public:
  Impl(std::unique_ptr<SessionFile> file, Version original, const SessionWriterOptions& options)
      : file_(std::move(file)), original_(std::move(original)), options_(options), path_(file_->path()) {
    status_.committed_state = file_->head().state;
    planned_state_ = file_->head().state;
    planned_last_ = file_->head().last_state;
    thread_ = std::thread([this] {
      takeNormalPriority();
      run();
    });
  }

  ~Impl() { finish(); }

  void enqueue(std::unique_ptr<SessionAction> action) {
    {
      const std::scoped_lock lock(queue_lock_);
      if (action->kind == SessionAction::Kind::kStep) {
        assert(action->number == planned_state_ + 1);
        planned_state_ = planned_last_ = action->number;
      } else if (action->kind == SessionAction::Kind::kMove) {
        assert(action->number >= 0 && action->number <= planned_last_);
        planned_state_ = action->number;
      } else if (action->kind == SessionAction::Kind::kNote && replaceNote(*action)) {
        return;
      }
      queue_.push_back(std::move(action));
      ++enqueued_;
      try_again_ = true;
    }
    wake_worker_.notify_one();
  }

  void retry() {
    {
      const std::scoped_lock lock(queue_lock_);
      try_again_ = true;
    }
    wake_worker_.notify_one();
  }

  SessionStatus status() const {
    const std::scoped_lock lock(queue_lock_);
    SessionStatus status = status_;
    status.waiting = static_cast<std::size_t>(enqueued_ - status_.committed);
    status.tiles_done = progress_.done();
    status.tiles_total = progress_.total();
    return status;
  }

  std::string path() const {
    const std::scoped_lock lock(queue_lock_);
    return path_;
  }

  Status flush(JobControl& job) {
    std::unique_lock lock(queue_lock_);
    const std::uint64_t until = enqueued_;
    // A running attempt may have failed before the cause was removed: only a later one counts.
    const std::uint64_t begun = tries_;
    if (status_.committed < until) {
      try_again_ = true;
      wake_worker_.notify_one();
    }
    while (status_.committed < until) {
      if (status_.error && failed_try_ > begun) return tl::unexpected(*status_.error);
      if (job.cancelled()) return cancelled();
      wake_waiters_.wait_for(lock, kPollInterval);
    }
    return {};
  }

  Status saveAs(const std::string& path, OriginalStorage storage, JobControl& job) {
    const std::scoped_lock file_lock(file_lock_);
    std::error_code ignored;
    if (std::filesystem::equivalent(path, file_->path(), ignored)) {
      if (storage == OriginalStorage::kEmbedded)
        if (Status status = file_->embed(original_, job); !status) return status;
      return writeAllWaiting(job);
    }
    Result<SessionLock> lock = lockSession(realPath(path), path);
    if (!lock) return tl::unexpected(lock.error());
    // Only this thread removes from the front, and only under file_lock_: the actions do not move.
    std::vector<const SessionAction*> waiting;
    {
      const std::scoped_lock queue_lock(queue_lock_);
      for (const auto& action : queue_) waiting.push_back(action.get());
      fixed_ = waiting.size();
    }
    Status copied = file_->copyTo(path, waiting, storage, original_, job);
    if (copied) {
      auto file = SessionFile::open(path, std::move(*lock), options_.durability);
      if (file)
        std::swap(file_, *file);  // the old one is destroyed at the end of the scope
      else
        copied = tl::unexpected(file.error());
    }
    std::vector<std::unique_ptr<SessionAction>> done;
    {
      const std::scoped_lock queue_lock(queue_lock_);
      fixed_ = 0;
      if (copied) {
        for (std::size_t i = 0; i < waiting.size(); ++i) {
          done.push_back(std::move(queue_.front()));
          queue_.pop_front();
        }
        status_.committed += waiting.size();
        status_.committed_state = file_->head().state;
        status_.error.reset();
        path_ = path;
        try_again_ = true;
      }
    }
    wake_worker_.notify_one();
    wake_waiters_.notify_all();
    return copied;
  }

  Result<Step> loadOlder(const History& history, JobControl& job) {
    const std::int64_t number = history.first();
    if (number == 0) return failure("there is no older step", path());
    if (Status status = flush(job); !status) return tl::unexpected(status.error());
    const auto stored = restored(history.state(number), job);
    if (!stored) return tl::unexpected(stored.error());
    const std::scoped_lock file_lock(file_lock_);
    const Result<SessionIndex> index = readIndex(file_->tables());
    if (!index) return tl::unexpected(index.error());
    auto step = readStep(file_->tables(), *index, number, *stored, original_, job);
    if (step) step->after = history.state(number);
    return step;
  }

  Status close(JobControl& job) {
    if (Status status = flush(job); !status) return status;
    finish();
    return {};
  }

 private:
  // A waiting text is replaced by a newer one of its key, unless it is being written.
  bool replaceNote(const SessionAction& action) {
    if (!action.journal.empty()) return false;
    for (std::size_t i = queue_.size(); i-- > fixed_;)
      if (queue_[i]->kind == SessionAction::Kind::kNote && queue_[i]->key == action.key) {
        queue_[i]->text = action.text;
        try_again_ = true;
        wake_worker_.notify_one();
        return true;
      }
    return false;
  }

  // Writes the first of the queue. The caller holds file_lock_.
  Status writeNext() {
    const SessionAction* action = nullptr;
    std::uint64_t own_try = 0;
    {
      const std::scoped_lock lock(queue_lock_);
      if (queue_.empty()) return {};
      own_try = ++tries_;
      action = queue_.front().get();
      fixed_ = 1;
      try_again_ = false;
    }
    std::uint64_t bytes = 0;
    Status written;
    try {
      written = file_->write(*action, bytes, progress_);
    } catch (const std::bad_alloc&) {
      written = failure("memory for writing could not be allocated", file_->path());
    }
    std::unique_ptr<SessionAction> done;  // its versions are freed after the lock is released
    {
      const std::scoped_lock lock(queue_lock_);
      fixed_ = 0;
      if (written) {
        done = std::move(queue_.front());
        queue_.pop_front();
        ++status_.committed;
        status_.committed_state = file_->head().state;
        status_.last_commit_s = done->since_enqueued.seconds();
        status_.worst_commit_s = std::max(status_.worst_commit_s, status_.last_commit_s);
        status_.last_commit_bytes = bytes;
        status_.error.reset();
      } else {
        status_.error = written.error();
        failed_try_ = own_try;
      }
    }
    wake_waiters_.notify_all();
    return written;
  }

  Status writeAllWaiting(JobControl& job) {
    for (;;) {
      {
        const std::scoped_lock lock(queue_lock_);
        if (queue_.empty()) return {};
      }
      if (job.cancelled()) return cancelled();
      if (Status status = writeNext(); !status) return status;
    }
  }

  void run() {
    for (;;) {
      {
        std::unique_lock lock(queue_lock_);
        // After an error only a new action or retry() starts another attempt.
        wake_worker_.wait(lock, [&] { return stop_ || (!queue_.empty() && (!status_.error || try_again_)); });
        if (queue_.empty() || (stop_ && status_.error)) return;
      }
      const std::scoped_lock file_lock(file_lock_);
      if (writeNext()) {
        bool idle = false;
        {
          const std::scoped_lock lock(queue_lock_);
          idle = queue_.empty();
        }
        if (idle) file_->checkpoint(options_.checkpoint_bytes);
      }
    }
  }

  void finish() {
    if (!thread_.joinable()) return;
    {
      const std::scoped_lock lock(queue_lock_);
      stop_ = true;
    }
    wake_worker_.notify_one();
    thread_.join();
    file_->settle();
    file_.reset();
  }

  std::mutex file_lock_;
  std::unique_ptr<SessionFile> file_;  // guarded by file_lock_
  const Version original_;
  const SessionWriterOptions options_;
  JobControl progress_;

  mutable std::mutex queue_lock_;  // guards all below
  std::condition_variable wake_worker_;
  std::condition_variable wake_waiters_;
  std::deque<std::unique_ptr<SessionAction>> queue_;
  std::size_t fixed_ = 0;  // number of actions at the front that are in use and may not change
  std::uint64_t enqueued_ = 0;
  std::uint64_t tries_ = 0;         // attempts so far
  std::uint64_t failed_try_ = 0;    // the last attempt that failed
  std::int64_t planned_state_ = 0;  // after all waiting actions
  std::int64_t planned_last_ = 0;
  bool try_again_ = false;
  bool stop_ = false;
  SessionStatus status_;
  std::string path_;

  std::thread thread_;
};

SessionWriter::SessionWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SessionWriter::~SessionWriter() = default;

Result<std::unique_ptr<SessionWriter>> SessionWriter::create(const Session& session, const std::string& path,
                                                             const SessionWriterOptions& options,
                                                             JobControl& job) {
  Result<SessionLock> lock = lockSession(realPath(path), path);
  if (!lock) return tl::unexpected(lock.error());
  if (auto saved = saveSessionLocked(session, path, job); !saved) return tl::unexpected(saved.error());
  auto file = SessionFile::open(path, std::move(*lock), options.durability);
  if (!file) return tl::unexpected(file.error());
  auto original = restored(session.original, job);
  if (!original) return tl::unexpected(original.error());
  return std::unique_ptr<SessionWriter>(
      new SessionWriter(std::make_unique<Impl>(std::move(*file), *std::move(original), options)));
}

Result<ResumedSession> SessionWriter::open(const std::string& path, const SessionOpenOptions& open_options,
                                           const SessionWriterOptions& options, ScanImport* import_scan,
                                           JobControl& job) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))  // before a lock file is made
    return inputError("there is no such session", path, "check the name");
  Result<SessionLock> lock = lockSession(realPath(path), path);
  if (!lock) return tl::unexpected(lock.error());
  auto file = SessionFile::open(path, std::move(*lock), options.durability);
  if (!file) return tl::unexpected(file.error());
  Result<Session> session = readSession((*file)->tables(), open_options, import_scan, job);
  if (!session) return tl::unexpected(session.error());
  Version original = session->original;
  return ResumedSession{std::move(*session),
                        std::unique_ptr<SessionWriter>(new SessionWriter(
                            std::make_unique<Impl>(std::move(*file), std::move(original), options)))};
}

void SessionWriter::commit(std::int64_t number, Step step, std::vector<JournalEntry> journal) {
  auto action = std::make_unique<SessionAction>();
  action->kind = SessionAction::Kind::kStep;
  action->number = number;
  action->step = std::move(step);
  action->journal = std::move(journal);
  impl_->enqueue(std::move(action));
}

void SessionWriter::moveTo(std::int64_t number, std::vector<JournalEntry> journal) {
  auto action = std::make_unique<SessionAction>();
  action->kind = SessionAction::Kind::kMove;
  action->number = number;
  action->journal = std::move(journal);
  impl_->enqueue(std::move(action));
}

void SessionWriter::setNote(std::string key, std::string text, std::vector<JournalEntry> journal) {
  auto action = std::make_unique<SessionAction>();
  action->kind = SessionAction::Kind::kNote;
  action->key = std::move(key);
  action->text = std::move(text);
  action->journal = std::move(journal);
  impl_->enqueue(std::move(action));
}

void SessionWriter::addJournal(JournalEntry entry) {
  auto action = std::make_unique<SessionAction>();
  action->journal.push_back(std::move(entry));
  impl_->enqueue(std::move(action));
}

void SessionWriter::retry() {
  impl_->retry();
}

SessionStatus SessionWriter::status() const {
  return impl_->status();
}

std::string SessionWriter::path() const {
  return impl_->path();
}

Status SessionWriter::flush(JobControl& job) {
  return impl_->flush(job);
}

Status SessionWriter::saveAs(const std::string& path, OriginalStorage storage, JobControl& job) {
  return impl_->saveAs(path, storage, job);
}

Result<Step> SessionWriter::loadOlder(const History& history, JobControl& job) {
  return impl_->loadOlder(history, job);
}

Status SessionWriter::close(JobControl& job) {
  return impl_->close(job);
}

}  // namespace fettle::engine
