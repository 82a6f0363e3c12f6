#include "engine/session/session_file.h"

#include <filesystem>

#include <fmt/format.h>

#include "engine/io/files/atomic_file.h"

namespace fettle::engine {

namespace {

Status apply(SessionTables& tables, const SessionAction& action, StoredStates& states, HeadRow& head,
             std::uint64_t& bytes, JobControl& job) {
  switch (action.kind) {
    case SessionAction::Kind::kStep: {
      const Result<Step> step = storedStep(states, action.step, job);
      if (!step) return tl::unexpected(step.error());
      if (Status status = putStep(tables, action.number, *step, head, bytes, job); !status) return status;
      break;
    }
    case SessionAction::Kind::kMove:
      assert(action.number >= 0 && action.number <= head.last_state);
      head.state = action.number;
      break;
    case SessionAction::Kind::kNote:
      if (Status status = putNote(tables, action.key, action.text, head); !status) return status;
      break;
    case SessionAction::Kind::kJournal:
      break;
  }
  if (Status status = putJournal(tables, action.journal, head.state, head); !status) return status;
  return tables.writeHead(head);
}

// Whether the file that a row refers to can be read again.
bool scanIsThere(const OriginalRow& row) {
  const Result<FileChecksum> sum = fileChecksum(row.scan.path);
  return sum && *sum == row.file;
}

// Tiles of state 0 get the next free ids: the row of step 0 records them.
Status embedTiles(SessionTables& tables, OriginalRow row, const Version& original, HeadRow& head,
                  JobControl& job) {
  const auto steps = tables.readSteps(head);
  if (!steps) return tl::unexpected(steps.error());
  StepRow start = steps->front();
  const std::vector<TileToStore> tiles = allTiles(original);
  start.first_tile = head.next_tile;
  start.tiles = static_cast<std::int64_t>(tiles.size());
  if (Status status = tables.database().execute("DELETE FROM step WHERE number=0"); !status) return status;
  if (Status status = tables.insertStep(start); !status) return status;
  std::uint64_t bytes = 0;
  job.begin("writing the session", tiles.size());
  if (Status status = storeTiles(tables, tiles, 0, head, bytes, job); !status) return status;
  row.storage = OriginalStorage::kEmbedded;
  if (Status status = tables.writeOriginal(row); !status) return status;
  return tables.writeHead(head);
}

}  // namespace

Result<std::unique_ptr<SessionFile>> SessionFile::open(const std::string& path, SessionLock lock,
                                                       Durability durability) {
  std::unique_ptr<SessionFile> file(new SessionFile(path, std::move(lock)));
  auto database = Database::open(realPath(path), DatabaseAccess::kWrite, path);
  if (!database) return tl::unexpected(database.error());
  file->database_ = std::move(*database);
  file->tables_ = std::make_unique<SessionTables>(*file->database_);
  if (Status status = file->tables_->recognise(); !status) return tl::unexpected(status.error());
  // On a file system without shared memory it keeps a rollback journal: slower, equally safe.
  if (auto mode = file->database_->text("PRAGMA journal_mode=WAL"); !mode)
    return tl::unexpected(mode.error());
  if (Status status = file->database_->execute(
          fmt::format("PRAGMA synchronous={}; PRAGMA cache_size=-8192; PRAGMA temp_store=MEMORY;",
                      durability == Durability::kPowerFailure ? "FULL" : "NORMAL"));
      !status)
    return tl::unexpected(status.error());
  const Result<HeadRow> head = file->tables_->readHead();
  if (!head) return tl::unexpected(head.error());
  file->head_ = *head;
  return file;
}

Status SessionFile::write(const SessionAction& action, std::uint64_t& bytes, JobControl& job) {
  HeadRow head = head_;
  Result<Transaction> transaction = Transaction::begin(*database_);
  if (!transaction) return tl::unexpected(transaction.error());
  if (Status status = apply(*tables_, action, states_, head, bytes, job); !status) return status;
  if (Status status = transaction->commit(); !status) return status;
  head_ = head;
  return {};
}

Status SessionFile::copyTo(const std::string& path, const std::vector<const SessionAction*>& waiting,
                           OriginalStorage storage, const Version& original, JobControl& job) {
  const std::string real = realPath(path);
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  {
    // Reads log and file; also writes what a full disk prevented in this one.
    std::string quoted;
    for (const char c : file->temporaryPath()) quoted += c == '\'' ? std::string("''") : std::string(1, c);
    job.begin("copying the session", 0);
    database_->stopWith(&job);
    Status copied = database_->execute("VACUUM INTO '" + quoted + "'");
    database_->stopWith(nullptr);
    if (!copied) {
      // A full disk is that of the new file, the old one is only read; of other errors it is not known which of the two failed.
      // The new one is the one that was asked for, the old one may be one for unsaved work that nobody has named.
      Error error = file->explained(copied.error());
      if (error.kind != ErrorKind::kCancelled && error.where != path)
        error.where = fmt::format("{} (copied from {})", path, path_);
      return tl::unexpected(std::move(error));
    }
    auto database = Database::open(file->temporaryPath(), DatabaseAccess::kWrite, path);
    if (!database) return tl::unexpected(database.error());
    if (Status status = beginBuilding(**database); !status) return status;
    SessionTables tables(**database);
    Result<Transaction> transaction = Transaction::begin(**database);
    if (!transaction) return tl::unexpected(transaction.error());
    HeadRow head = head_;
    std::uint64_t bytes = 0;
    StoredStates states;
    for (const SessionAction* action : waiting)
      if (Status status = apply(tables, *action, states, head, bytes, job); !status) return status;
    Result<OriginalRow> row = tables.readOriginal();
    if (!row) return tl::unexpected(row.error());
    if (!row->scan.path.empty()) {
      std::error_code error;
      const std::filesystem::path folder = std::filesystem::path(real).parent_path();
      row->relative_path = std::filesystem::relative(row->scan.path, folder, error).string();
    }
    if (Status status = tables.writeOriginal(*row); !status) return status;
    if (row->storage == OriginalStorage::kReferenced &&
        (storage == OriginalStorage::kEmbedded || !scanIsThere(*row)))
      if (Status status = embedTiles(tables, *row, original, head, job); !status) return status;
    if (Status status = transaction->commit(); !status) return status;
  }
  if (job.cancelled()) return cancelled();
  if (Status status = settleOldSession(real, path); !status) return status;
  return file->commit();
}

Status SessionFile::embed(const Version& original, JobControl& job) {
  HeadRow head = head_;
  Result<Transaction> transaction = Transaction::begin(*database_);
  if (!transaction) return tl::unexpected(transaction.error());
  const Result<OriginalRow> row = tables_->readOriginal();
  if (!row) return tl::unexpected(row.error());
  if (row->storage == OriginalStorage::kEmbedded) return {};
  if (Status status = embedTiles(*tables_, *row, original, head, job); !status) return status;
  if (Status status = transaction->commit(); !status) return status;
  head_ = head;
  return {};
}

void SessionFile::checkpoint(std::size_t bytes) {
  // If it fails (full disk, a reader) nothing is lost: the log contains everything and continues to grow.
  if (database_->logBytes() > bytes) (void)database_->checkpoint();
}

void SessionFile::settle() {
  tables_.reset();  // no statement may be open
  (void)database_->text("PRAGMA journal_mode=DELETE");
  database_.reset();
}

}  // namespace fettle::engine
