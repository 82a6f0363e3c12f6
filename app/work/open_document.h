#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/work/form_originals.h"
#include "app/work/scan_reading.h"
#include "engine/session/session_writer.h"

namespace fettle::app {

/// Folder for work that was not saved when the program ended: $XDG_STATE_HOME/fettle, else
/// ~/.local/state/fettle; created if necessary. Empty when it cannot be created: then nothing is recovered.
[[nodiscard]] std::string recoveryFolder();

/// Where unsaved work on a scan is kept: a session in that folder, named after the scan and a checksum of its
/// path. Empty without such a folder.
[[nodiscard]] std::string recoveryPath(const std::string& scan);

/// Whether a path is that of a session (by its extension).
[[nodiscard]] bool isSessionPath(const std::string& path);

/// Removes a session file with its SQLite and lock files.
void removeSession(const std::string& path);

/// A scan or session, read and ready for work.
struct Document {
  std::string path;            ///< as requested: a scan or NAME.fettle
  engine::OriginalScan scan;   ///< the original scan
  bool needs_scan = true;      ///< a session of it may refer to the scan's file; else it holds the scan
  engine::Version original;    ///< upright, as stored
  engine::History history;     ///< upright, as seen: without the forms over its states
  FormOriginals originals;     ///< under these forms
  engine::Version first;       ///< the original as it is seen
  engine::SessionNotes notes;  ///< of a session
  std::vector<std::string> warnings;
  /// Writes to the session the document came from; null for a scan, and for a session that can only be read.
  std::unique_ptr<engine::SessionWriter> writer;
  std::vector<engine::LoneValue> lone_values;  ///< Imported::lone_values, of a scan
  bool recovered = false;                      ///< the session is the scan's recovery
};

/// Handling of unsaved work on a scan.
enum class Recovery : std::uint8_t {
  kTake,   ///< continue with it
  kLeave,  ///< start from the scan; it stays until a step of the new work replaces it
};

/// Reads a scan (any importer) or session. A session that cannot be written to - another program works on it,
/// its folder is read-only - is read alone, with a warning. What lies under a form is as it is seen. History beyond `history_bytes` stays on disk.
/// Errors: those of importField and openSession. Thread: any; a long job.
[[nodiscard]] engine::Result<Document> openDocument(const std::string& path, const ScanOptions& reading,
                                                    Recovery recovery, std::size_t history_bytes,
                                                    engine::JobControl& job);

}  // namespace fettle::app
