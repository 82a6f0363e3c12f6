#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/session/checksum.h"
#include "engine/session/session.h"

namespace fettle::engine {

struct OriginalRow;

/// Where a session searches for a scan that it refers to, in this order: the scan's path, the same path
/// relative to the session, the session's folder.
[[nodiscard]] std::vector<std::string> scanPlaces(const OriginalRow& row, const std::string& session_path);

/// Facts from a session's first rows: no step and no tile is read.
struct SessionFacts {
  OriginalStorage storage = OriginalStorage::kEmbedded;
  std::vector<std::string> scan_places;  ///< of a referenced scan: as scanPlaces(); else empty
  FileChecksum scan;                     ///< of the scan's file
  std::int64_t steps = 0;                ///< up to the furthest redo
  std::int64_t journal_entries = 0;
};
/// Time: a few milliseconds. Errors: as openSession. Thread: any.
[[nodiscard]] Result<SessionFacts> sessionFacts(const std::string& session_path);

/// Whether a session could no longer be opened, or only through another copy of its scan, if the file at
/// `path` were replaced. Reads that file when it lies at one of scanPlaces(). Thread: any.
[[nodiscard]] bool needsFile(const SessionFacts& session, const std::string& path);

/// Embeds the scan that a session refers to, so that it needs no other file. No effect if it is embedded
/// already. Errors: as SessionWriter::open, and a full disk; the session is then unchanged. Thread: any; a
/// long job.
[[nodiscard]] Status embedScan(const std::string& session_path, ScanImport* import_scan, JobControl& job);

}  // namespace fettle::engine
