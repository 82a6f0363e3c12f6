#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/session/session.h"
#include "engine/session/session_lock.h"
#include "engine/session/tables.h"

namespace fettle::engine {

/// A connection for reading. Never waits: while another program writes it reads the last commit. On a
/// read-only disk a log that a crash left is read from copies in the temporary folder.
class ReadingConnection {
 public:
  [[nodiscard]] static Result<ReadingConnection> open(const std::string& path);
  [[nodiscard]] Database& database() const noexcept { return *database_; }

 private:
  // Destroyed from the last to the first: the connection before the lock that permits its cleanup, and before
  // the copies.
  struct Copies;
  std::shared_ptr<Copies> copies_;
  std::optional<SessionLock> lock_;
  std::unique_ptr<Database> database_;
};

/// Content of the tables at one commit.
struct SessionIndex {
  HeadRow head;
  Grid grid;
  OriginalRow original;
  std::vector<StepRow> steps;
  std::vector<TilePlace> places;  ///< by position, then step
  std::vector<EdgeLines> lines;   ///< of each state
  std::vector<FieldForm> forms;   ///< over each state
};
[[nodiscard]] Result<SessionIndex> readIndex(SessionTables& tables);

/// The session of an open connection, within a transaction that the caller began; contract: openSession.
/// `tables.database().shownPath()` is the session's path.
[[nodiscard]] Result<Session> readSession(SessionTables& tables, const SessionOpenOptions& options,
                                          ScanImport* import_scan, JobControl& job);

/// The step that led to state `number`, given that state: its `before` shares all other tiles with it.
[[nodiscard]] Result<Step> readStep(SessionTables& tables, const SessionIndex& index, std::int64_t number,
                                    const Version& after, const Version& original, JobControl& job);

}  // namespace fettle::engine
