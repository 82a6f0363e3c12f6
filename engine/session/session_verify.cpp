#include <filesystem>
#include <new>

#include "engine/session/session_reader.h"
#include "engine/session/session_rows.h"
#include "engine/session/stored_tiles.h"

namespace fettle::engine {

Result<SessionSize> verifySession(const std::string& path, JobControl& job) try {
  const Result<ReadingConnection> connection = ReadingConnection::open(path);
  if (!connection) return tl::unexpected(connection.error());
  Database& database = connection->database();
  database.stopWith(&job);
  SessionTables tables(database);
  if (Status status = database.execute("BEGIN"); !status) return tl::unexpected(status.error());
  const Result<SessionIndex> index = readIndex(tables);
  if (!index) return tl::unexpected(index.error());
  const Result<std::string> pages = database.text("PRAGMA integrity_check(1)");
  if (!pages) return tl::unexpected(pages.error());
  if (*pages != "ok") return damaged(*pages, path);
  if (auto notes = tables.readNotes(index->head); !notes) return tl::unexpected(notes.error());
  if (auto journal = tables.readJournal(index->head); !journal) return tl::unexpected(journal.error());
  std::vector<Tile> tiles(index->places.empty() ? 0 : 256);
  SessionSize size;
  size.tiles = static_cast<std::int64_t>(index->places.size());
  job.begin("checking the session", index->places.size());
  for (std::size_t begin = 0; begin < index->places.size(); begin += tiles.size()) {
    const auto some =
        std::span(index->places).subspan(begin, std::min(tiles.size(), index->places.size() - begin));
    if (Status status = loadTiles(
            tables, index->grid, some, [&](std::size_t i) { return &tiles[i]; }, job);
        !status)
      return tl::unexpected(status.error());
  }
  const Result<std::int64_t> bytes = database.integer("SELECT total(length(data)) FROM tile");
  if (!bytes) return tl::unexpected(bytes.error());
  size.tile_bytes = static_cast<std::uint64_t>(*bytes);
  std::error_code ignored;
  size.file_bytes = std::filesystem::file_size(path, ignored);
  return size;
} catch (const std::bad_alloc&) {
  return failure("memory for the session could not be allocated", path);
}

}  // namespace fettle::engine
