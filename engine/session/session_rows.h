#pragma once

#include <string>
#include <vector>

#include "engine/session/step_tiles.h"
#include "engine/session/tables.h"

namespace fettle::engine {

// The actions on a session as changes of rows. Each must stand in a transaction; `head` is changed along, and
// is the file's again only once the transaction is committed.

/// Puts step `number` (with the tiles in which its versions differ) after the current state and goes there.
[[nodiscard]] Status putStep(SessionTables& tables, std::int64_t number, const Step& step, HeadRow& head,
                             std::uint64_t& bytes, JobControl& job);
[[nodiscard]] Status putJournal(SessionTables& tables, std::vector<JournalEntry> journal, std::int64_t state,
                                HeadRow& head);
[[nodiscard]] Status putNote(SessionTables& tables, const std::string& key, const std::string& text,
                             HeadRow& head);

/// Facts about the scan as the file keeps them; reads the scan's file. `session_path` may not exist yet. The
/// row's storage is kEmbedded where the scan could not be found again (OriginalStorage::kReferenced).
[[nodiscard]] Result<OriginalRow> describeOriginal(const OriginalScan& scan, OriginalStorage storage,
                                                   const Version& original, const std::string& session_path);

/// The path with all links followed, as far as it exists: the name that locks and logs stand beside.
[[nodiscard]] std::string realPath(const std::string& path);

/// Whether the name of a session that stands at `path` may be given to another file: works its log in, so
/// that it will not be taken for the new one's. The caller holds the lock.
[[nodiscard]] Status settleOldSession(const std::string& path, const std::string& shown);

/// Pragmas for a file under a temporary name: no file beside it and no flushing, for it is flushed whole
/// before it is named. Its journal is in memory and nearly empty: new pages have nothing to be put back to.
[[nodiscard]] Status beginBuilding(Database& database);

}  // namespace fettle::engine
