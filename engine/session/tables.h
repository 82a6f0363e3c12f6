#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/field/grid.h"
#include "engine/session/checksum.h"
#include "engine/session/database.h"
#include "engine/session/session.h"

namespace fettle::engine {

// The tables of a session file, row by row; docs/formats.md describes them. Reading a row checks its checksum
// and its ranges; errors are those of Database, and damaged().

inline constexpr std::int64_t kSessionApplicationId = 0x4654544C;  // "FTTL"
/// user_version: 4 where a step has laid a shape over the field, else 3 where one has changed the form over it, else 2 where
/// one has changed edge lines, else 1, so that a program that knows no shapes, no forms, or no lines, reads the sessions
/// without them.
inline constexpr std::int64_t kSessionFormat = 4;

/// The only row that changes: the user's position, and the expected numbers of rows.
struct HeadRow {
  std::int64_t state = 0;       ///< current one
  std::int64_t last_state = 0;  ///< furthest redo
  std::int64_t next_tile = 1;   ///< ids are never reused
  std::int64_t journal = 0;     ///< rows
  std::int64_t notes = 0;       ///< rows
};

struct OriginalRow {
  OriginalScan scan;
  OriginalStorage storage = OriginalStorage::kEmbedded;
  std::string relative_path;  ///< from the session's folder; empty when there is none
  FileChecksum file;          ///< zeros when the file could not be read, or was another by then
  std::uint64_t content_hash = 0;
};

struct StepRow {
  std::int64_t number = 0;
  StepInfo info;          // bytes is not kept
  std::int64_t sign = 1;  // 1; -1: the field is inverted
  std::int64_t first_tile = 0;
  std::int64_t tiles = 0;
};

/// Where a stored tile belongs: state `step` and those after it have it at `position` (row * columns +
/// column, in tiles), until a later step replaces it.
struct TilePlace {
  std::int64_t position = 0;
  std::int64_t step = 0;
  std::int64_t id = 0;
};

class SessionTables {
 public:
  explicit SessionTables(Database& database) : database_(&database) {}

  [[nodiscard]] Database& database() const noexcept { return *database_; }

  /// Makes the tables in an empty database.
  [[nodiscard]] Status create();
  /// Error if the file is not a session or has a newer format.
  [[nodiscard]] Status recognise();

  [[nodiscard]] Status writeGrid(const Grid& grid);
  [[nodiscard]] Result<Grid> readGrid();
  [[nodiscard]] Status writeOriginal(const OriginalRow& row);
  [[nodiscard]] Result<OriginalRow> readOriginal();
  [[nodiscard]] Status writeHead(const HeadRow& head);
  [[nodiscard]] Result<HeadRow> readHead();

  [[nodiscard]] Status insertStep(const StepRow& row);
  /// Steps 0 .. head.last_state.
  [[nodiscard]] Result<std::vector<StepRow>> readSteps(const HeadRow& head);
  /// Removes the steps above `number` and their tiles.
  [[nodiscard]] Status truncateSteps(std::int64_t number);

  [[nodiscard]] Status insertTile(const TilePlace& place, std::string_view data);
  /// All tiles of the steps, ordered by position, then step; counts checked against the steps'.
  [[nodiscard]] Result<std::vector<TilePlace>> readPlaces(const std::vector<StepRow>& steps);
  /// The packed tile of a place, checked.
  [[nodiscard]] Status readTile(const TilePlace& place, std::string& data);

  /// The edge lines that a step leaves behind (packLines()), where they are not those before it.
  [[nodiscard]] Status insertLines(std::int64_t step, std::string_view packed);
  /// The edge lines of each state, by its number; states that have the same ones share them.
  [[nodiscard]] Result<std::vector<EdgeLines>> readLines(const std::vector<StepRow>& steps);

  /// The form that a step leaves behind (packForm()), where it is not the one before it.
  [[nodiscard]] Status insertForm(std::int64_t step, std::string_view packed);
  /// The form over each state of a field of this grid; states that have the same one share it.
  [[nodiscard]] Result<std::vector<FieldForm>> readForms(const std::vector<StepRow>& steps, const Grid& grid);

  [[nodiscard]] Status appendJournal(std::int64_t id, const JournalEntry& entry);
  [[nodiscard]] Result<std::vector<JournalEntry>> readJournal(const HeadRow& head);
  /// `is_new`: whether there was none of that key.
  [[nodiscard]] Status writeNote(const std::string& key, const std::string& text, bool& is_new);
  [[nodiscard]] Result<SessionNotes> readNotes(const HeadRow& head);

 private:
  // Prepared at first use and kept.
  [[nodiscard]] Result<Statement*> cached(const char* sql);
  // Runs a statement without rows with these values in its places.
  template <class... Values>
  [[nodiscard]] Status run(const char* sql, const Values&... values);
  // Whether there are the tables of a format: made when the first of their rows is stored.
  [[nodiscard]] Result<bool> hasTablesOf(std::int64_t format);
  // Makes the tables up to those of a format.
  [[nodiscard]] Status makeTablesOf(std::int64_t format);
  // What the rows of a table (step, checksum, data) say of each state, and where they are silent the state before.
  template <class Value, class Unpack>
  [[nodiscard]] Result<std::vector<Value>> readOfStates(const char* sql, const char* what, StepKind kind,
                                                        const std::vector<StepRow>& steps,
                                                        const Unpack& unpack);

  Database* database_;
  std::vector<std::pair<const char*, std::unique_ptr<Statement>>> statements_;
};

}  // namespace fettle::engine
