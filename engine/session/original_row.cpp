// The row that describes the scan of a session.

#include "engine/session/tables.h"

namespace fettle::engine {

namespace {

// Writing and the checksum use the same pass over the columns, so that they cannot differ.
void eachColumn(const OriginalRow& r, auto&& text, auto&& integer, auto&& real) {
  const ImportOptions& import = r.scan.import;
  text(r.storage == OriginalStorage::kEmbedded ? std::string("embedded") : std::string("referenced"));
  text(r.scan.path);
  text(r.relative_path);
  text(r.scan.format);
  integer(static_cast<std::int64_t>(r.file.bytes));
  integer(static_cast<std::int64_t>(r.file.xxh64));
  integer(static_cast<std::int64_t>(r.content_hash));
  real(import.no_data);
  real(import.spacing ? std::optional(import.spacing->first) : std::nullopt);
  real(import.spacing ? std::optional(import.spacing->second) : std::nullopt);
  real(import.z_scale);
  text(import.unit ? std::optional(import.unit->name) : std::nullopt);
  real(import.unit ? std::optional(import.unit->mm) : std::nullopt);
  real(import.cell_size);
  integer(static_cast<std::int64_t>(import.cell_rule));
}

std::int64_t checksumOf(const OriginalRow& row) {
  RowChecksum sum;
  eachColumn(
      row, [&](const std::optional<std::string>& v) { v ? sum.text(*v) : sum.null(); },
      [&](std::int64_t v) { sum.integer(v); },
      [&](const std::optional<double>& v) { v ? sum.real(*v) : sum.null(); });
  return sum.value();
}

// NaN needs no entry: it is always a hole; and SQLite does not store NaN.
OriginalRow storable(OriginalRow row) {
  if (row.scan.import.no_data && !(*row.scan.import.no_data == *row.scan.import.no_data))
    row.scan.import.no_data.reset();
  return row;
}

}  // namespace

Status SessionTables::writeOriginal(const OriginalRow& given) {
  const OriginalRow row = storable(given);
  const Result<Statement*> s =
      cached("INSERT OR REPLACE INTO original VALUES(1,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  if (!s) return tl::unexpected(s.error());
  int place = 1;
  std::vector<std::string> texts;
  texts.reserve(16);  // bound texts must not move
  eachColumn(
      row,
      [&](const std::optional<std::string>& v) {
        if (v)
          (*s)->bindText(place++, texts.emplace_back(*v));
        else
          (*s)->bindNull(place++);
      },
      [&](std::int64_t v) { (*s)->bind(place++, v); },
      [&](const std::optional<double>& v) {
        if (v)
          (*s)->bindReal(place++, *v);
        else
          (*s)->bindNull(place++);
      });
  (*s)->bind(place, checksumOf(row));
  return (*s)->run();
}

Result<OriginalRow> SessionTables::readOriginal() {
  const std::string& path = database_->shownPath();
  const Result<Statement*> s = cached(
      "SELECT storage,path,relative_path,format,bytes,xxh64,content_hash,no_data,spacing_x,spacing_y,z_scale,"
      "unit,unit_mm,cell_size,cell_rule,checksum FROM original");
  if (!s) return tl::unexpected(s.error());
  Statement& q = **s;
  const Result<bool> found = q.step();
  if (!found) return tl::unexpected(found.error());
  if (!*found) return damaged("it does not record its scan", path);
  const auto real = [&](int column) {
    return q.isNull(column) ? std::nullopt : std::optional(q.real(column));
  };
  OriginalRow row;
  row.storage = q.bytes(0) == "embedded" ? OriginalStorage::kEmbedded : OriginalStorage::kReferenced;
  row.scan.path = q.bytes(1);
  row.relative_path = q.bytes(2);
  row.scan.format = q.bytes(3);
  row.file = {static_cast<std::uint64_t>(q.integer(4)), static_cast<std::uint64_t>(q.integer(5))};
  row.content_hash = static_cast<std::uint64_t>(q.integer(6));
  ImportOptions& import = row.scan.import;
  import.no_data = real(7);
  if (real(8) && real(9)) import.spacing = {q.real(8), q.real(9)};
  import.z_scale = real(10);
  if (!q.isNull(11) && real(12)) import.unit = LengthUnit{std::string(q.bytes(11)), q.real(12)};
  import.cell_size = real(13);
  const std::int64_t rule = q.integer(14);
  if (rule >= 0 && rule <= static_cast<std::int64_t>(CellRule::kHighest))
    import.cell_rule = static_cast<CellRule>(rule);
  const bool right = q.integer(15) == checksumOf(row);
  q.reset();
  if (!right) return damaged("its record of the scan does not fit its checksum", path);
  return row;
}

}  // namespace fettle::engine
