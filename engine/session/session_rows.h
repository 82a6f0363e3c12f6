#pragma once

#include <string>
#include <vector>

#include "engine/field/seen_field.h"
#include "engine/session/stored_tiles.h"
#include "engine/session/tables.h"

namespace fettle::engine {

// The actions on a session as changes of rows. Each must be called in a transaction; `head` is updated too,
// and corresponds to the file again once the transaction is committed.

/// A step of fields that are seen under forms as it is stored: of the samples, sharing all tiles in which they do not
/// differ. `states` has the state before it, as long as steps come in their order. Errors: as StoredStates::of().
[[nodiscard]] Result<Step> storedStep(StoredStates& states, const Step& step, JobControl& job);

/// Inserts step `number` (with the tiles, the edge lines and the form in which its versions differ) after the current state and makes it
/// current.
[[nodiscard]] Status putStep(SessionTables& tables, std::int64_t number, const Step& step, HeadRow& head,
                             std::uint64_t& bytes, JobControl& job);
[[nodiscard]] Status putJournal(SessionTables& tables, std::vector<JournalEntry> journal, std::int64_t state,
                                HeadRow& head);
[[nodiscard]] Status putNote(SessionTables& tables, const std::string& key, const std::string& text,
                             HeadRow& head);

/// The row about the scan; reads the scan's file. `session_path` may not exist yet. The row's storage is
/// kEmbedded where the scan could not be found again (OriginalStorage::kReferenced).
[[nodiscard]] Result<OriginalRow> describeOriginal(const OriginalScan& scan, OriginalStorage storage,
                                                   const Version& original, const std::string& session_path);

/// The path with all links followed, as far as it exists: the name from which those of lock and log are
/// derived.
[[nodiscard]] std::string realPath(const std::string& path);

/// Prepares the replacement of a session at `path`: checkpoints its log, so that it is not applied to the new
/// file. The caller holds the lock.
[[nodiscard]] Status settleOldSession(const std::string& path, const std::string& shown);

/// Pragmas for a file under a temporary name: no additional files and no flushing, since it is flushed as a
/// whole before it is renamed. Its journal is in memory and nearly empty: new pages have no previous content.
[[nodiscard]] Status beginBuilding(Database& database);

}  // namespace fettle::engine
