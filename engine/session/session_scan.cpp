#include "engine/session/session_scan.h"

#include <algorithm>
#include <filesystem>

#include "engine/session/session_reader.h"
#include "engine/session/session_writer.h"

namespace fettle::engine {

namespace fs = std::filesystem;

std::vector<std::string> scanPlaces(const OriginalRow& row, const std::string& session_path) {
  const fs::path folder = fs::path(session_path).parent_path();
  std::vector<std::string> places{row.scan.path};
  if (!row.relative_path.empty()) places.push_back((folder / row.relative_path).string());
  places.push_back((folder / fs::path(row.scan.path).filename()).string());
  return places;
}

Result<SessionFacts> sessionFacts(const std::string& session_path) {
  const Result<ReadingConnection> connection = ReadingConnection::open(session_path);
  if (!connection) return tl::unexpected(connection.error());
  SessionTables tables(connection->database());
  if (Status status = connection->database().execute("BEGIN"); !status) return tl::unexpected(status.error());
  if (Status status = tables.recognise(); !status) return tl::unexpected(status.error());
  const Result<HeadRow> head = tables.readHead();
  if (!head) return tl::unexpected(head.error());
  const Result<OriginalRow> original = tables.readOriginal();
  if (!original) return tl::unexpected(original.error());
  SessionFacts facts;
  facts.storage = original->storage;
  if (facts.storage == OriginalStorage::kReferenced) facts.scan_places = scanPlaces(*original, session_path);
  facts.scan = original->file;
  facts.steps = head->last_state;
  facts.journal_entries = head->journal;
  return facts;
}

bool needsFile(const SessionFacts& session, const std::string& path) {
  const bool looked_for = std::ranges::any_of(session.scan_places, [&](const std::string& place) {
    std::error_code none;
    return fs::equivalent(place, path, none);
  });
  if (!looked_for) return false;
  const Result<FileChecksum> sum = fileChecksum(path);
  return sum && *sum == session.scan;
}

Status embedScan(const std::string& session_path, ScanImport* import_scan, JobControl& job) {
  SessionOpenOptions reading;
  reading.history_bytes = 0;
  reading.journal = JournalReading::kLeave;
  const Result<ResumedSession> session = SessionWriter::open(session_path, reading, {}, import_scan, job);
  if (!session) return tl::unexpected(session.error());
  if (Status status = session->writer->saveAs(session_path, OriginalStorage::kEmbedded, job); !status)
    return status;
  return session->writer->close(job);
}

}  // namespace fettle::engine
