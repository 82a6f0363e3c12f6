#include "engine/session/session_save.h"

#include <filesystem>
#include <new>

#include "engine/field/seen_field.h"
#include "engine/io/files/atomic_file.h"
#include "engine/session/form_codec.h"
#include "engine/session/line_codec.h"
#include "engine/session/session_rows.h"

namespace fettle::engine {

namespace {

// `first`: as stored.
bool isOriginal(const Version& first, const Version& original) {
  return tilesThatDiffer(original, first).empty() && original.reader().sign() == first.reader().sign() &&
         original.lines() == first.lines() && original.form() == first.form();
}

Status writeAll(SessionTables& tables, const Session& session, const OriginalRow& original, SessionSize& size,
                JobControl& job) {
  const History& history = session.history;
  HeadRow head;
  StoredStates states;
  if (history.first() == 0) {
    const Result<Version> first = states.of(history.state(0), job);
    if (!first) return tl::unexpected(first.error());
    if (!isOriginal(*first, session.original))
      return failure("state 0 of the history is not the original scan", tables.database().shownPath());
  }
  if (Status status = tables.create(); !status) return status;
  if (Status status = tables.writeGrid(session.original.grid()); !status) return status;
  if (Status status = tables.writeOriginal(original); !status) return status;

  StepRow start{0,
                {"Import", StepKind::kImport, {}, {}, 0},
                static_cast<std::int64_t>(session.original.reader().sign()),
                head.next_tile,
                0};
  if (history.last() > history.first()) start.info.time = history.info(history.first() + 1).time;
  {
    std::vector<TileToStore> tiles;
    if (original.storage == OriginalStorage::kEmbedded) tiles = allTiles(session.original);
    start.tiles = static_cast<std::int64_t>(tiles.size());
    if (Status status = tables.insertStep(start); !status) return status;
    job.begin("writing the session", tiles.size());
    if (Status status = storeTiles(tables, tiles, 0, head, size.tile_bytes, job); !status) return status;
  }
  if (session.original.lines())
    if (Status status = tables.insertLines(0, packLines(session.original.lines())); !status) return status;
  if (session.original.form())
    if (Status status = tables.insertForm(0, packForm(session.original.form())); !status) return status;

  // States that the history no longer holds become one step, with the number of the state it leads to:
  // numbers do not change.
  for (std::int64_t k = 1; k <= history.first(); ++k) {
    const Version& after = k == history.first() ? history.state(k) : session.original;
    const Step earlier{{"Earlier steps", StepKind::kImport, start.info.time, {}, 0}, session.original, after};
    const Result<Step> step = storedStep(states, earlier, job);
    if (!step) return tl::unexpected(step.error());
    if (Status status = putStep(tables, k, *step, head, size.tile_bytes, job); !status) return status;
  }
  for (std::int64_t k = history.first() + 1; k <= history.last(); ++k) {
    const Result<Step> step = storedStep(states, history.step(k), job);
    if (!step) return tl::unexpected(step.error());
    if (Status status = putStep(tables, k, *step, head, size.tile_bytes, job); !status) return status;
  }
  head.state = history.number();
  for (const JournalEntry& entry : session.journal)
    if (Status status = tables.appendJournal(++head.journal, entry); !status) return status;
  for (const auto& [key, text] : session.notes)
    if (Status status = putNote(tables, key, text, head); !status) return status;
  size.tiles = head.next_tile - 1;
  return tables.writeHead(head);
}

}  // namespace

Result<SessionLock> lockSession(const std::string& real_path, const std::string& shown) {
  Result<std::optional<SessionLock>> lock = SessionLock::take(real_path, kLockWaitMs);
  if (!lock) {
    Error error = lock.error();
    error.where = shown;
    return tl::unexpected(error);
  }
  if (!*lock) return sessionInUse(real_path, shown);
  return std::move(**lock);
}

Result<SessionSize> saveSessionLocked(const Session& given, const std::string& path, JobControl& job) try {
  Session session = given;
  auto samples = restored(given.original, job);
  if (!samples) return tl::unexpected(samples.error());
  session.original = *std::move(samples);
  const std::string real = realPath(path);
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  const Result<OriginalRow> original =
      describeOriginal(session.scan, session.storage, session.original, real);
  if (!original) return tl::unexpected(original.error());
  SessionSize size;
  {
    auto database = Database::open(file->temporaryPath(), DatabaseAccess::kCreate, path);
    if (!database) return tl::unexpected(database.error());
    if (Status status = beginBuilding(**database); !status) return tl::unexpected(status.error());
    SessionTables tables(**database);
    Result<Transaction> transaction = Transaction::begin(**database);
    if (!transaction) return tl::unexpected(transaction.error());
    if (Status status = writeAll(tables, session, *original, size, job); !status)
      return tl::unexpected(status.error());
    if (Status status = transaction->commit(); !status) return tl::unexpected(status.error());
  }
  if (job.cancelled()) return cancelled();
  if (Status status = settleOldSession(real, path); !status) return tl::unexpected(status.error());
  if (Status status = file->commit(); !status) return tl::unexpected(status.error());
  std::error_code ignored;
  size.file_bytes = std::filesystem::file_size(real, ignored);
  return size;
} catch (const std::bad_alloc&) {
  return failure("memory for writing could not be allocated", path);
}

Result<SessionSize> saveSession(const Session& session, const std::string& path, JobControl& job) {
  const Result<SessionLock> lock = lockSession(realPath(path), path);
  if (!lock) return tl::unexpected(lock.error());
  return saveSessionLocked(session, path, job);
}

}  // namespace fettle::engine
