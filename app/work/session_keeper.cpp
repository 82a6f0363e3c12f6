#include "app/work/session_keeper.h"

#include "engine/field/seen_field.h"

namespace fettle::app {
namespace {

using engine::OriginalStorage;
using namespace std::chrono_literals;

constexpr auto kTryAgain = 5s;
constexpr auto kRecheckInterval = 1s;

}  // namespace

SessionKeeper::SessionKeeper(Document& document)
    : original_scan_(document.scan),
      original_(document.original),
      start_(document.history),
      notes_(document.notes),
      writer_(std::move(document.writer)) {
  if (!isSessionPath(document.path)) recovery_path_ = recoveryPath(document.path);
  named_ = writer_ != nullptr && !document.recovered;
  if (!document.needs_scan) scan_ = Scan::kEmbedded;
}

SessionKeeper::~SessionKeeper() {
  static_cast<void>(close(Afterwards::kKeep));
}

void SessionKeeper::commit(std::int64_t number, engine::Step step,
                           std::vector<engine::JournalEntry> journal) {
  enqueue({Waiting::Kind::kCommit, number, std::move(step), std::move(journal), {}, {}});
}

void SessionKeeper::moveTo(std::int64_t number, std::vector<engine::JournalEntry> journal) {
  enqueue({Waiting::Kind::kMove, number, {}, std::move(journal), {}, {}});
}

void SessionKeeper::note(std::vector<engine::JournalEntry> journal) {
  enqueue({Waiting::Kind::kJournal, 0, {}, std::move(journal), {}, {}});
}

void SessionKeeper::setNote(const std::string& key, const std::string& text) {
  if (auto known = notes_.find(key); known != notes_.end() && known->second == text) return;
  notes_[key] = text;
  // A file that is created later starts with the notes of that time.
  if (writer_)
    writer_->setNote(key, text);
  else if (making_.busy())
    waiting_.push_back({Waiting::Kind::kNote, 0, {}, {}, key, text});
}

void SessionKeeper::enqueue(Waiting&& what) {
  if (closed_) return;
  if (writer_) {
    passToWriter(std::move(what));
    return;
  }
  const bool step = what.kind == Waiting::Kind::kCommit;
  waiting_.push_back(std::move(what));
  // The session is created with the first step.
  if (step && !making_.busy() && !failed_) {
    if (recovery_path_.empty())
      failed_ = engine::Error{engine::ErrorKind::kFailed, "there is no folder for unsaved work", "",
                              "save the session under a name"};
    else
      make({recovery_path_, OriginalStorage::kReferenced, false});
  }
}

void SessionKeeper::passToWriter(Waiting&& what) {
  switch (what.kind) {
    case Waiting::Kind::kCommit:
      writer_->commit(what.number, std::move(what.step), std::move(what.journal));
      break;
    case Waiting::Kind::kMove:
      writer_->moveTo(what.number, std::move(what.journal));
      break;
    case Waiting::Kind::kJournal:
      for (engine::JournalEntry& entry : what.journal) writer_->addJournal(std::move(entry));
      break;
    case Waiting::Kind::kNote:
      writer_->setNote(what.key, what.text);
      break;
  }
}

void SessionKeeper::make(const Place& place) {
  making_place_ = place;
  tried_ = std::chrono::steady_clock::now();
  engine::Session session;
  session.scan = original_scan_;
  session.storage = storageFor(place.storage);
  session.original = original_;
  session.history = start_;
  session.notes = notes_;
  making_.start([session = std::move(session), path = place.path](engine::JobControl& job) {
    return engine::SessionWriter::create(session, path, {}, job);
  });
}

void SessionKeeper::made(engine::Result<Writer> result) {
  if (!result) {
    failed_ = result.error();
    if (making_place_.named) saved_ = tl::unexpected(result.error());
    return;
  }
  failed_.reset();
  writer_ = *std::move(result);
  for (Waiting& what : std::exchange(waiting_, {})) passToWriter(std::move(what));
  if (!making_place_.named) return;
  named_ = true;
  saved_ = engine::Status{};
  if (!recovery_path_.empty()) removeSession(recovery_path_);
}

void SessionKeeper::move(const Place& place) {
  moving_place_ = place;
  const std::string left = named_ ? std::string() : writer_->path();
  saving_.start([writer = writer_.get(), place, left](engine::JobControl& job) -> engine::Result<bool> {
    if (auto moved = writer->saveAs(place.path, place.storage, job); !moved)
      return tl::unexpected(moved.error());
    if (!left.empty() && left != place.path) removeSession(left);
    return true;
  });
}

void SessionKeeper::saveAs(const std::string& path, OriginalStorage storage) {
  if (closed_ || (saving_.busy() && scan_ != Scan::kBeingPut)) return;
  const Place place{path, storageFor(storage), true};
  saved_.reset();
  if (making_.busy() || scan_ == Scan::kBeingPut)
    requested_ = place;
  else if (writer_)
    move(place);
  else
    make(place);
}

// A scan without its own file (it came from a session) can only be embedded.
OriginalStorage SessionKeeper::storageFor(OriginalStorage storage) const {
  return original_scan_.path.empty() || scan_ != Scan::kReferenced ? OriginalStorage::kEmbedded : storage;
}

bool SessionKeeper::scanReplaced() const {
  return scan_ == Scan::kReferenced && original_scan_.read &&
         engine::fileStamp(original_scan_.path) != original_scan_.read;
}

void SessionKeeper::keepScan() {
  scan_requested_ = true;
  scan_kept_.reset();
  if (scan_ == Scan::kReferenced) scan_ = Scan::kRequested;
  embedScan();
}

// As far as possible now; poll() continues it.
void SessionKeeper::embedScan() {
  if (scan_ == Scan::kRequested && !making_.busy() && !saving_.busy() && !requested_) {
    if (writer_) {
      scan_ = Scan::kBeingPut;
      saving_.start([writer = writer_.get()](engine::JobControl& job) -> engine::Result<bool> {
        if (auto done = writer->saveAs(writer->path(), OriginalStorage::kEmbedded, job); !done)
          return tl::unexpected(done.error());
        return true;
      });
    } else {
      scan_ = Scan::kEmbedded;
    }
  }
  if (scan_ == Scan::kEmbedded && std::exchange(scan_requested_, false)) scan_kept_ = engine::Status{};
}

std::optional<engine::Status> SessionKeeper::saved() {
  return std::exchange(saved_, std::nullopt);
}

void SessionKeeper::readOlder(const engine::History& history) {
  if (!writer_ || closed_) return;
  reading_.start([writer = writer_.get(), history,
                  scan = FormOriginals(original_).scan()](engine::JobControl& job) -> engine::Result<Older> {
    auto step = writer->loadOlder(history, job);
    if (!step) return tl::unexpected(step.error());
    auto before = engine::seenNear(step->before, step->after, job);
    if (!before) return tl::unexpected(before.error());
    step->before = *std::move(before);
    auto original = FormOriginals::make(scan, step->before, job);
    if (!original) return tl::unexpected(original.error());
    return Older{*std::move(step), *std::move(original)};
  });
}

void SessionKeeper::poll() {
  if (closed_) return;
  if (auto done = making_.take()) made(std::move(*done));
  if (auto done = saving_.take()) {
    if (scan_ == Scan::kBeingPut) {
      scan_ = *done ? Scan::kEmbedded : Scan::kReferenced;
      if (!*done) checked_at_ = std::chrono::steady_clock::now() + kTryAgain;
      if (!*done && std::exchange(scan_requested_, false)) scan_kept_ = tl::unexpected(done->error());
    } else if (*done) {
      named_ = true;
      saved_ = engine::Status{};
    } else {
      saved_ = tl::unexpected(done->error());
    }
  }
  if (requested_ && !making_.busy() && !saving_.busy()) {
    const Place place = *std::exchange(requested_, std::nullopt);
    saveAs(place.path, place.storage);
  }
  const auto now = std::chrono::steady_clock::now();
  if (now - checked_at_ >= kRecheckInterval) {
    checked_at_ = now;
    if (scanReplaced()) scan_ = Scan::kRequested;
  }
  embedScan();
  if (now - tried_ < kTryAgain) return;
  if (writer_ && writer_->status().error) {
    tried_ = now;
    writer_->retry();
  } else if (!writer_ && failed_ && !making_.busy() && !recovery_path_.empty()) {
    make({recovery_path_, OriginalStorage::kReferenced, false});
  }
}

std::string SessionKeeper::path() const {
  return writer_ ? writer_->path() : std::string();
}

engine::SessionStatus SessionKeeper::status() const {
  return writer_ ? writer_->status() : engine::SessionStatus{};
}

std::size_t SessionKeeper::waiting() const {
  return waiting_.size() + (making_.busy() ? 1 : 0) + (writer_ ? writer_->status().waiting : 0);
}

std::optional<engine::Error> SessionKeeper::error() const {
  return writer_ ? writer_->status().error : failed_;
}

engine::Status SessionKeeper::close(Afterwards afterwards) {
  if (std::exchange(closed_, true)) return {};
  const bool discard = afterwards == Afterwards::kDiscard && !named_;
  if (discard) {
    making_.cancel();
    saving_.cancel();
  }
  reading_.cancel();
  static_cast<void>(reading_.wait());
  static_cast<void>(saving_.wait());
  if (auto done = making_.wait()) made(std::move(*done));
  if (discard) {
    const std::string path = writer_ ? writer_->path() : std::string();
    writer_.reset();
    if (!path.empty()) removeSession(path);
    return {};
  }
  if (!writer_) return waiting_.empty() || !failed_ ? engine::Status{} : tl::unexpected(*failed_);
  engine::JobControl job;
  // An error here changes nothing; the steps are still written.
  if (scan_ == Scan::kRequested || scanReplaced())
    static_cast<void>(writer_->saveAs(writer_->path(), OriginalStorage::kEmbedded, job));
  engine::Status status = writer_->close(job);
  writer_.reset();
  return status;
}

}  // namespace fettle::app
