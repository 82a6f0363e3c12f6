#include "engine/session/session_rows.h"

#include <cassert>
#include <filesystem>

#include <fmt/format.h>

#include "engine/session/form_codec.h"
#include "engine/session/line_codec.h"

namespace fettle::engine {

namespace fs = std::filesystem;

Result<Step> storedStep(StoredStates& states, const Step& step, JobControl& job) {
  auto before = states.of(step.before, job);
  if (!before) return tl::unexpected(before.error());
  auto after = states.of(step.after, job);
  if (after && step.before.seenOf() != step.after.seenOf()) after = sharingEqualTiles(*after, *before);
  if (!after) return tl::unexpected(after.error());
  return Step{step.info, *std::move(before), *std::move(after)};
}

Status putStep(SessionTables& tables, std::int64_t number, const Step& step, HeadRow& head,
               std::uint64_t& bytes, JobControl& job) {
  assert(number == head.state + 1);
  if (head.last_state > head.state)
    if (Status status = tables.truncateSteps(head.state); !status) return status;
  const std::vector<TileToStore> tiles = tilesThatDiffer(step.before, step.after);
  const StepRow row{number, step.info, static_cast<std::int64_t>(step.after.reader().sign()), head.next_tile,
                    static_cast<std::int64_t>(tiles.size())};
  if (Status status = tables.insertStep(row); !status) return status;
  job.begin("writing the session", tiles.size());
  if (Status status = storeTiles(tables, tiles, number, head, bytes, job); !status) return status;
  if (step.after.lines() != step.before.lines())
    if (Status status = tables.insertLines(number, packLines(step.after.lines())); !status) return status;
  if (step.after.form() != step.before.form())
    if (Status status = tables.insertForm(number, packForm(step.after.form())); !status) return status;
  head.state = number;
  head.last_state = number;
  return {};
}

Status putJournal(SessionTables& tables, std::vector<JournalEntry> journal, std::int64_t state,
                  HeadRow& head) {
  for (JournalEntry& entry : journal) {
    entry.state = state;
    if (Status status = tables.appendJournal(++head.journal, entry); !status) return status;
  }
  return {};
}

Status putNote(SessionTables& tables, const std::string& key, const std::string& text, HeadRow& head) {
  bool is_new = false;
  if (Status status = tables.writeNote(key, text, is_new); !status) return status;
  head.notes += is_new ? 1 : 0;
  return {};
}

Result<OriginalRow> describeOriginal(const OriginalScan& scan, OriginalStorage storage,
                                     const Version& original, const std::string& session_path) {
  OriginalRow row;
  row.scan = scan;
  row.storage = storage;
  row.content_hash = contentHash(original);
  if (!scan.path.empty()) {
    std::error_code error;
    const fs::path absolute = fs::absolute(scan.path, error);
    if (!error) row.scan.path = absolute.string();
    const fs::path folder = fs::path(session_path).parent_path();
    const fs::path relative = fs::relative(absolute, folder.empty() ? "." : folder, error);
    if (!error) row.relative_path = relative.string();
    const Result<FileChecksum> sum = fileChecksum(scan.path);
    // Checked after reading: a file replaced meanwhile is detected too.
    const bool as_read = !scan.read || fileStamp(scan.path) == scan.read;
    if (!as_read || scan.import.depth_camera) row.storage = OriginalStorage::kEmbedded;
    if (sum && as_read)
      row.file = *sum;
    else if (row.storage == OriginalStorage::kReferenced)
      return tl::unexpected(sum.error());
  } else if (storage == OriginalStorage::kReferenced) {
    return inputError("the scan has no file that the session could refer to", session_path,
                      "save the session with the scan embedded");
  }
  return row;
}

std::string realPath(const std::string& path) {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(path, error);
  return error ? path : real.string();
}

Status settleOldSession(const std::string& path, const std::string& shown) {
  std::error_code error;
  const bool has_log = fs::exists(path + "-wal", error);
  if (has_log && fs::exists(path, error)) {
    auto old = Database::open(path, DatabaseAccess::kWrite, shown);
    if (!old) return tl::unexpected(old.error());
    const Result<std::int64_t> busy = (*old)->integer("PRAGMA wal_checkpoint(TRUNCATE)");
    if (!busy) return tl::unexpected(busy.error());
    if (*busy != 0)
      return inputError("another program is reading the existing session", shown,
                        "close it there, or choose another name");
  }
  // Log of a session that was deleted, or empty.
  fs::remove(path + "-wal", error);
  fs::remove(path + "-shm", error);
  return {};
}

Status beginBuilding(Database& database) {
  return database.execute(
      fmt::format("PRAGMA page_size={}; PRAGMA journal_mode=MEMORY; PRAGMA synchronous=OFF; PRAGMA "
                  "locking_mode=EXCLUSIVE; PRAGMA cache_size=-16384;",
                  kSessionPageBytes));
}

}  // namespace fettle::engine
