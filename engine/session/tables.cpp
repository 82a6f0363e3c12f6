#include "engine/session/tables.h"

#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "engine/session/form_codec.h"
#include "engine/session/line_codec.h"
#include "engine/session/packed_bytes.h"

namespace fettle::engine {

namespace {

// Small columns come before long ones: the beginning of a row lies in the tree's own pages, its end may lie
// in overflow pages.
constexpr const char* kSchema = R"(
CREATE TABLE head(id INTEGER PRIMARY KEY CHECK(id=1), state INTEGER NOT NULL, last_state INTEGER NOT NULL,
  next_tile INTEGER NOT NULL, journal INTEGER NOT NULL, notes INTEGER NOT NULL, checksum INTEGER NOT NULL) STRICT;
CREATE TABLE grid(id INTEGER PRIMARY KEY CHECK(id=1), width INTEGER NOT NULL, height INTEGER NOT NULL,
  spacing_x REAL NOT NULL, spacing_y REAL NOT NULL, origin_x REAL NOT NULL, origin_y REAL NOT NULL,
  lateral_unit TEXT NOT NULL, lateral_mm REAL NOT NULL, height_unit TEXT NOT NULL, height_mm REAL NOT NULL,
  crs_wkt TEXT NOT NULL, height_per_count REAL NOT NULL, checksum INTEGER NOT NULL) STRICT;
CREATE TABLE original(id INTEGER PRIMARY KEY CHECK(id=1), storage TEXT NOT NULL, path TEXT NOT NULL,
  relative_path TEXT NOT NULL, format TEXT NOT NULL, bytes INTEGER NOT NULL, xxh64 INTEGER NOT NULL,
  content_hash INTEGER NOT NULL, no_data REAL, spacing_x REAL, spacing_y REAL, z_scale REAL, unit TEXT,
  unit_mm REAL, cell_size REAL, cell_rule INTEGER NOT NULL, checksum INTEGER NOT NULL) STRICT;
CREATE TABLE step(number INTEGER PRIMARY KEY, name TEXT NOT NULL, kind TEXT NOT NULL, time_ms INTEGER NOT NULL,
  sign INTEGER NOT NULL, rect_column INTEGER NOT NULL, rect_row INTEGER NOT NULL, rect_columns INTEGER NOT NULL,
  rect_rows INTEGER NOT NULL, first_tile INTEGER NOT NULL, tiles INTEGER NOT NULL,
  checksum INTEGER NOT NULL) STRICT;
CREATE TABLE tile(id INTEGER PRIMARY KEY, step INTEGER NOT NULL, position INTEGER NOT NULL,
  checksum INTEGER NOT NULL, data BLOB NOT NULL) STRICT;
CREATE INDEX tile_place ON tile(position, step);
CREATE TABLE journal(id INTEGER PRIMARY KEY, state INTEGER NOT NULL, time_ms INTEGER NOT NULL,
  checksum INTEGER NOT NULL, action TEXT NOT NULL, data BLOB NOT NULL) STRICT;
CREATE TABLE note(key TEXT PRIMARY KEY, checksum INTEGER NOT NULL, text TEXT NOT NULL) STRICT;
)";
constexpr const char* kLinesSchema = R"(
CREATE TABLE lines(step INTEGER PRIMARY KEY, checksum INTEGER NOT NULL, data BLOB NOT NULL) STRICT;
PRAGMA user_version=2;
)";
constexpr const char* kFormsSchema = R"(
CREATE TABLE forms(step INTEGER PRIMARY KEY, checksum INTEGER NOT NULL, data BLOB NOT NULL) STRICT;
PRAGMA user_version=3;
)";

// The tables are those of before: the numbers of a shape stand where those of a polynomial did.
constexpr const char* kShapesSchema = "PRAGMA user_version=4;";

constexpr std::int64_t kLinesFormat = 2, kFormsFormat = 3, kShapesFormat = 4;

StepTime timeOf(std::int64_t ms) {
  return StepTime(std::chrono::milliseconds(ms));
}
std::int64_t msOf(StepTime time) {
  return time.time_since_epoch().count();
}

// Of a row's values in their order.
template <class... Values>
std::int64_t checksumOfRow(const Values&... values) {
  RowChecksum row;
  const auto add = [&row](const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_integral_v<Value>)
      row.integer(value);
    else if constexpr (std::is_floating_point_v<Value>)
      row.real(value);
    else
      row.text(value);
  };
  (add(values), ...);
  return row.value();
}

// Bytes that are no text.
struct Blob {
  std::string_view bytes;
};

template <class Value>
void bindOne(Statement& statement, int place, const Value& value) {
  if constexpr (std::is_integral_v<Value>)
    statement.bind(place, value);
  else if constexpr (std::is_floating_point_v<Value>)
    statement.bindReal(place, value);
  else if constexpr (std::is_same_v<Value, Blob>)
    statement.bindBlob(place, value.bytes);
  else
    statement.bindText(place, value);
}

std::int64_t checksumOf(const HeadRow& h) {
  return checksumOfRow(h.state, h.last_state, h.next_tile, h.journal, h.notes);
}

std::int64_t checksumOf(const Grid& g) {
  return checksumOfRow(g.width, g.height, g.spacing_x, g.spacing_y, g.origin_x, g.origin_y,
                       g.lateral_unit.name, g.lateral_unit.mm, g.height_unit.name, g.height_unit.mm,
                       g.crs_wkt, g.height_per_count);
}

std::int64_t checksumOf(const StepRow& s) {
  return checksumOfRow(s.number, s.info.name, stepKindName(s.info.kind), msOf(s.info.time), s.sign,
                       s.info.rect.column, s.info.rect.row, s.info.rect.columns, s.info.rect.rows,
                       s.first_tile, s.tiles);
}

std::int64_t checksumOf(const TilePlace& place, std::string_view data) {
  return checksumOfRow(place.id, place.step, place.position, data);
}

std::int64_t checksumOf(std::int64_t id, const JournalEntry& entry, std::string_view packed) {
  return checksumOfRow(id, entry.state, msOf(entry.time), entry.action, packed);
}

}  // namespace

Result<Statement*> SessionTables::cached(const char* sql) {
  for (const auto& [text, statement] : statements_)
    if (text == sql) {
      statement->reset();
      return statement.get();
    }
  Result<Statement> prepared = database_->prepare(sql);
  if (!prepared) return tl::unexpected(prepared.error());
  statements_.emplace_back(sql, std::make_unique<Statement>(std::move(*prepared)));
  return statements_.back().second.get();
}

template <class... Values>
Status SessionTables::run(const char* sql, const Values&... values) {
  const Result<Statement*> s = cached(sql);
  if (!s) return tl::unexpected(s.error());
  int place = 0;
  (bindOne(**s, ++place, values), ...);
  return (*s)->run();
}

Status SessionTables::create() {
  return database_->execute(
      fmt::format("{} PRAGMA application_id={}; PRAGMA user_version=1;", kSchema, kSessionApplicationId));
}

Status SessionTables::recognise() {
  const Result<std::int64_t> application = database_->integer("PRAGMA application_id");
  if (!application) return tl::unexpected(application.error());
  const std::string& path = database_->shownPath();
  if (*application != kSessionApplicationId)
    return inputError("the file is a database, but not a Fettle session", path, "name a session or a scan");
  const Result<std::int64_t> format = database_->integer("PRAGMA user_version");
  if (!format) return tl::unexpected(format.error());
  if (*format > kSessionFormat)
    return inputError(fmt::format("the session was written by a newer Fettle (format {}, supported up to {})",
                                  *format, kSessionFormat),
                      path, "update Fettle, or export the field with the program that wrote it");
  if (*format < 1) return damaged(fmt::format("format {} does not exist", *format), path);
  return {};
}

Status SessionTables::writeHead(const HeadRow& head) {
  return run("INSERT OR REPLACE INTO head VALUES(1,?,?,?,?,?,?)", head.state, head.last_state, head.next_tile,
             head.journal, head.notes, checksumOf(head));
}

Result<HeadRow> SessionTables::readHead() {
  const std::string& path = database_->shownPath();
  const Result<Statement*> s = cached("SELECT state,last_state,next_tile,journal,notes,checksum FROM head");
  if (!s) return tl::unexpected(s.error());
  const Result<bool> row = (*s)->step();
  if (!row) return tl::unexpected(row.error());
  if (!*row) return damaged("it has no head", path);
  const HeadRow head{(*s)->integer(0), (*s)->integer(1), (*s)->integer(2), (*s)->integer(3),
                     (*s)->integer(4)};
  const bool right = (*s)->integer(5) == checksumOf(head);
  (*s)->reset();
  if (!right || head.state < 0 || head.state > head.last_state || head.journal < 0)
    return damaged("its head does not fit its checksum", path);
  return head;
}

Status SessionTables::writeGrid(const Grid& g) {
  return run("INSERT INTO grid VALUES(1,?,?,?,?,?,?,?,?,?,?,?,?,?)", g.width, g.height, g.spacing_x,
             g.spacing_y, g.origin_x, g.origin_y, g.lateral_unit.name, g.lateral_unit.mm, g.height_unit.name,
             g.height_unit.mm, g.crs_wkt, g.height_per_count, checksumOf(g));
}

Result<Grid> SessionTables::readGrid() {
  const std::string& path = database_->shownPath();
  const Result<Statement*> s = cached(
      "SELECT width,height,spacing_x,spacing_y,origin_x,origin_y,lateral_unit,lateral_mm,height_unit,"
      "height_mm,crs_wkt,height_per_count,checksum FROM grid");
  if (!s) return tl::unexpected(s.error());
  Statement& q = **s;
  const Result<bool> row = q.step();
  if (!row) return tl::unexpected(row.error());
  if (!*row) return damaged("it has no grid", path);
  Grid g;
  const std::int64_t width = q.integer(0);
  const std::int64_t height = q.integer(1);
  if (width < 1 || height < 1 || width > Grid::kMaxSide || height > Grid::kMaxSide)
    return damaged(fmt::format("a field of {} x {} samples is not valid", width, height), path);
  g.width = static_cast<std::int32_t>(width);
  g.height = static_cast<std::int32_t>(height);
  g.spacing_x = q.real(2);
  g.spacing_y = q.real(3);
  g.origin_x = q.real(4);
  g.origin_y = q.real(5);
  g.lateral_unit = {std::string(q.bytes(6)), q.real(7)};
  g.height_unit = {std::string(q.bytes(8)), q.real(9)};
  g.crs_wkt = q.bytes(10);
  g.height_per_count = q.real(11);
  const bool right = q.integer(12) == checksumOf(g);
  q.reset();
  if (!right) return damaged("its grid does not fit its checksum", path);
  return g;
}

Status SessionTables::insertStep(const StepRow& r) {
  return run("INSERT INTO step VALUES(?,?,?,?,?,?,?,?,?,?,?,?)", r.number, r.info.name,
             stepKindName(r.info.kind), msOf(r.info.time), r.sign, r.info.rect.column, r.info.rect.row,
             r.info.rect.columns, r.info.rect.rows, r.first_tile, r.tiles, checksumOf(r));
}

Result<std::vector<StepRow>> SessionTables::readSteps(const HeadRow& head) {
  const std::string& path = database_->shownPath();
  const Result<Statement*> s = cached(
      "SELECT number,name,kind,time_ms,sign,rect_column,rect_row,rect_columns,rect_rows,first_tile,tiles,"
      "checksum FROM step ORDER BY number");
  if (!s) return tl::unexpected(s.error());
  Statement& q = **s;
  std::vector<StepRow> steps;
  for (;;) {
    const Result<bool> row = q.step();
    if (!row) return tl::unexpected(row.error());
    if (!*row) break;
    StepRow r;
    r.number = q.integer(0);
    r.info.name = q.bytes(1);
    const std::optional<StepKind> kind = stepKindFromName(q.bytes(2));
    r.info.kind = kind.value_or(StepKind::kStroke);
    r.info.time = timeOf(q.integer(3));
    r.sign = q.integer(4);
    r.info.rect = {static_cast<std::int32_t>(q.integer(5)), static_cast<std::int32_t>(q.integer(6)),
                   static_cast<std::int32_t>(q.integer(7)), static_cast<std::int32_t>(q.integer(8))};
    r.first_tile = q.integer(9);
    r.tiles = q.integer(10);
    if (!kind || q.integer(11) != checksumOf(r) || r.number != static_cast<std::int64_t>(steps.size()))
      return damaged(fmt::format("step {} does not fit its checksum", steps.size()), path);
    steps.push_back(std::move(r));
  }
  q.reset();
  if (static_cast<std::int64_t>(steps.size()) != head.last_state + 1)
    return damaged(fmt::format("{} of {} steps are there", steps.size(), head.last_state + 1), path);
  return steps;
}

Status SessionTables::truncateSteps(std::int64_t number) {
  for (const auto& [format, sql] : {std::pair(kLinesFormat, "DELETE FROM lines WHERE step>?"),
                                    {kFormsFormat, "DELETE FROM forms WHERE step>?"}}) {
    const Result<bool> there = hasTablesOf(format);
    if (!there) return tl::unexpected(there.error());
    if (!*there) break;
    if (Status status = run(sql, number); !status) return status;
  }
  // Tiles lie in the order of their steps, so theirs are the last ids: a range of the table, no search. Only
  // those of a scan that was embedded later lie among them or after them.
  if (Status status =
          run("DELETE FROM tile WHERE id>=(SELECT min(first_tile) FROM step WHERE number>?1) AND step>?1",
              number);
      !status)
    return status;
  return run("DELETE FROM step WHERE number>?", number);
}

Status SessionTables::insertTile(const TilePlace& place, std::string_view data) {
  return run("INSERT INTO tile VALUES(?,?,?,?,?)", place.id, place.step, place.position,
             checksumOf(place, data), Blob{data});
}

Result<std::vector<TilePlace>> SessionTables::readPlaces(const std::vector<StepRow>& steps) {
  const std::string& path = database_->shownPath();
  const Result<Statement*> s =
      cached("SELECT position,step,id FROM tile INDEXED BY tile_place ORDER BY position,step");
  if (!s) return tl::unexpected(s.error());
  std::vector<std::int64_t> counts(steps.size());
  std::vector<TilePlace> places;
  for (;;) {
    const Result<bool> row = (*s)->step();
    if (!row) return tl::unexpected(row.error());
    if (!*row) break;
    const TilePlace p{(*s)->integer(0), (*s)->integer(1), (*s)->integer(2)};
    const bool known = p.step >= 0 && p.step < static_cast<std::int64_t>(steps.size());
    if (!known || p.id < steps[static_cast<std::size_t>(p.step)].first_tile || p.position < 0 ||
        p.id >= steps[static_cast<std::size_t>(p.step)].first_tile +
                    steps[static_cast<std::size_t>(p.step)].tiles ||
        (!places.empty() && places.back().position == p.position && places.back().step == p.step))
      return damaged(fmt::format("tile {} has no valid position", p.id), path);
    ++counts[static_cast<std::size_t>(p.step)];
    places.push_back(p);
  }
  (*s)->reset();
  for (std::size_t k = 0; k < steps.size(); ++k)
    if (counts[k] != steps[k].tiles)
      return damaged(fmt::format("{} of the {} tiles of step {} are there", counts[k], steps[k].tiles, k),
                     path);
  return places;
}

Status SessionTables::readTile(const TilePlace& place, std::string& data) {
  const std::string& path = database_->shownPath();
  const Result<Statement*> s = cached("SELECT step,position,checksum,data FROM tile WHERE id=?");
  if (!s) return tl::unexpected(s.error());
  (*s)->bind(1, place.id);
  const Result<bool> row = (*s)->step();
  if (!row) return tl::unexpected(row.error());
  if (!*row) return damaged(fmt::format("tile {} is missing", place.id), path);
  data = (*s)->bytes(3);
  const bool right = (*s)->integer(0) == place.step && (*s)->integer(1) == place.position &&
                     (*s)->integer(2) == checksumOf(place, data);
  (*s)->reset();
  if (!right) return damaged(fmt::format("tile {} does not fit its checksum", place.id), path);
  return {};
}

Result<bool> SessionTables::hasTablesOf(std::int64_t format) {
  const Result<std::int64_t> is = database_->integer("PRAGMA user_version");
  if (!is) return tl::unexpected(is.error());
  return *is >= format;
}

Status SessionTables::makeTablesOf(std::int64_t format) {
  for (const auto& [of, schema] : {std::pair(kLinesFormat, kLinesSchema),
                                   {kFormsFormat, kFormsSchema},
                                   {kShapesFormat, kShapesSchema}}) {
    if (of > format) break;
    const Result<bool> there = hasTablesOf(of);
    if (!there) return tl::unexpected(there.error());
    if (*there) continue;
    if (Status status = database_->execute(schema); !status) return status;
  }
  return {};
}

template <class Value, class Unpack>
Result<std::vector<Value>> SessionTables::readOfStates(const char* sql, const char* what, StepKind kind,
                                                       const std::vector<StepRow>& steps,
                                                       const Unpack& unpack) {
  const std::string& path = database_->shownPath();
  std::vector<Value> values(steps.size());
  std::size_t next = 0;  // state whose value is not known yet
  const auto fillTo = [&](std::size_t end) {
    for (; next < end; ++next) values[next] = next == 0 ? Value() : values[next - 1];
  };
  if (sql != nullptr) {
    const Result<Statement*> s = cached(sql);
    if (!s) return tl::unexpected(s.error());
    for (;;) {
      const Result<bool> row = (*s)->step();
      if (!row) return tl::unexpected(row.error());
      if (!*row) break;
      const std::int64_t step = (*s)->integer(0);
      const std::string_view data = (*s)->bytes(2);
      std::string packed;
      if (step < 0 || step >= static_cast<std::int64_t>(steps.size()) ||
          (*s)->integer(1) != checksumOfRow(step, data) || !unpackBytes(data, packed))
        return damaged(fmt::format("the {} of step {} does not fit its checksum", what, step), path);
      std::optional<Value> unpacked = unpack(packed);
      if (!unpacked) return damaged(fmt::format("the {} of step {} cannot be read", what, step), path);
      fillTo(static_cast<std::size_t>(step));
      values[next++] = *std::move(unpacked);
    }
    (*s)->reset();
  }
  fillTo(values.size());
  for (std::size_t k = 1; k < steps.size(); ++k)
    if (steps[k].info.kind == kind && values[k] == values[k - 1])
      return damaged(fmt::format("the {} of step {} is missing", what, k), path);
  return values;
}

Status SessionTables::insertLines(std::int64_t step, std::string_view packed) {
  if (Status status = makeTablesOf(kLinesFormat); !status) return status;
  const std::string data = packBytes(packed);
  return run("INSERT INTO lines VALUES(?,?,?)", step, checksumOfRow(step, data), Blob{data});
}

Result<std::vector<EdgeLines>> SessionTables::readLines(const std::vector<StepRow>& steps) {
  const Result<bool> there = hasTablesOf(kLinesFormat);
  if (!there) return tl::unexpected(there.error());
  return readOfStates<EdgeLines>(*there ? "SELECT step,checksum,data FROM lines ORDER BY step" : nullptr,
                                 "set of lines", StepKind::kLines, steps, unpackLines);
}

Status SessionTables::insertForm(std::int64_t step, std::string_view packed) {
  if (Status status = makeTablesOf(isPackedShape(packed) ? kShapesFormat : kFormsFormat); !status)
    return status;
  const std::string data = packBytes(packed);
  return run("INSERT INTO forms VALUES(?,?,?)", step, checksumOfRow(step, data), Blob{data});
}

Result<std::vector<FieldForm>> SessionTables::readForms(const std::vector<StepRow>& steps, const Grid& grid) {
  const Result<bool> there = hasTablesOf(kFormsFormat);
  if (!there) return tl::unexpected(there.error());
  return readOfStates<FieldForm>(*there ? "SELECT step,checksum,data FROM forms ORDER BY step" : nullptr,
                                 "form", StepKind::kForm, steps,
                                 [&](std::string_view packed) { return unpackForm(packed, grid); });
}

Status SessionTables::appendJournal(std::int64_t id, const JournalEntry& entry) {
  const std::string packed = packBytes(entry.data);
  return run("INSERT INTO journal VALUES(?,?,?,?,?,?)", id, entry.state, msOf(entry.time),
             checksumOf(id, entry, packed), entry.action, Blob{packed});
}

Result<std::vector<JournalEntry>> SessionTables::readJournal(const HeadRow& head) {
  const std::string& path = database_->shownPath();
  const Result<Statement*> s =
      cached("SELECT id,state,time_ms,checksum,action,data FROM journal ORDER BY id");
  if (!s) return tl::unexpected(s.error());
  std::vector<JournalEntry> journal;
  for (;;) {
    const Result<bool> row = (*s)->step();
    if (!row) return tl::unexpected(row.error());
    if (!*row) break;
    JournalEntry entry{std::string((*s)->bytes(4)), {}, timeOf((*s)->integer(2)), (*s)->integer(1)};
    const auto id = static_cast<std::int64_t>(journal.size()) + 1;
    if ((*s)->integer(0) != id || (*s)->integer(3) != checksumOf(id, entry, (*s)->bytes(5)) ||
        !unpackBytes((*s)->bytes(5), entry.data))
      return damaged(fmt::format("entry {} of its journal does not fit its checksum", id), path);
    journal.push_back(std::move(entry));
  }
  (*s)->reset();
  if (static_cast<std::int64_t>(journal.size()) != head.journal)
    return damaged(fmt::format("{} of {} entries of its journal are there", journal.size(), head.journal),
                   path);
  return journal;
}

Status SessionTables::writeNote(const std::string& key, const std::string& text, bool& is_new) {
  const Result<Statement*> find = cached("SELECT 1 FROM note WHERE key=?");
  if (!find) return tl::unexpected(find.error());
  (*find)->bindText(1, key);
  const Result<bool> row = (*find)->step();
  if (!row) return tl::unexpected(row.error());
  is_new = !*row;
  (*find)->reset();
  return run("INSERT OR REPLACE INTO note VALUES(?,?,?)", key, checksumOfRow(key, text), text);
}

Result<SessionNotes> SessionTables::readNotes(const HeadRow& head) {
  const std::string& path = database_->shownPath();
  const Result<Statement*> s = cached("SELECT key,checksum,text FROM note");
  if (!s) return tl::unexpected(s.error());
  SessionNotes notes;
  for (;;) {
    const Result<bool> row = (*s)->step();
    if (!row) return tl::unexpected(row.error());
    if (!*row) break;
    std::string key((*s)->bytes(0));
    std::string text((*s)->bytes(2));
    if ((*s)->integer(1) != checksumOfRow(key, text))
      return damaged("a note does not fit its checksum", path);
    notes.emplace(std::move(key), std::move(text));
  }
  (*s)->reset();
  if (static_cast<std::int64_t>(notes.size()) != head.notes)
    return damaged(fmt::format("{} of {} notes are there", notes.size(), head.notes), path);
  return notes;
}

}  // namespace fettle::engine
