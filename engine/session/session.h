#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/history/history.h"
#include "engine/io/import.h"
#include "engine/session/checksum.h"

namespace fettle::engine {

// A session file, NAME.fettle: a scan, everything done to it, and where the user was. docs/formats.md
// describes the file; this header is for who reads one or writes one whole, session_writer.h for who goes on
// working.

/// How a session holds the scan it began with.
enum class OriginalStorage : std::uint8_t {
  kEmbedded,  ///< every tile is in the session: it needs no other file
  /// Path, size and checksum; opening imports the scan again and refuses one that changed. A scan that could
  /// not be found again is embedded after all: its file is no longer the one that was read
  /// (OriginalScan::read), or it was imported in a way that the session has no column for (a depth camera).
  kReferenced,
};

/// Where the scan of a session came from.
struct OriginalScan {
  std::string path;  ///< of the scan's file; made absolute when written. Empty for a scan that never had one
  ImportOptions import;  ///< what the user said when it was imported
  std::string format;    ///< Imported::format
  /// The file as it was when it was read. Nothing: what lies at `path` is taken for it.
  std::optional<FileStamp> read;
};

/// One thing the user did, as it is to be repeated: undo and redo too, in the order they were done.
struct JournalEntry {
  std::string action;  ///< one JSON object without line breaks; the session does not look into it
  std::string data;  ///< what is too long for that, such as the ticks of a stroke; any bytes, kept compressed
  StepTime time{};
  std::int64_t state =
      0;  ///< number of the state the field was in afterwards (History); filled in by the writer

  friend bool operator==(const JournalEntry&, const JournalEntry&) = default;
};

/// Small texts by name: "camera", "scene" (TOML), whatever the program wants to find again.
using SessionNotes = std::map<std::string, std::string>;

/// A session as it is in memory.
struct Session {
  OriginalScan scan;
  OriginalStorage storage = OriginalStorage::kEmbedded;
  Version original;  ///< the scan as imported, the right way up: deviation and --max-change refer to it
  History history;   ///< states held; state 0 is `original`
  SessionNotes notes;
  std::vector<JournalEntry> journal;
};

/// What reads the scan that a session refers to: importField of engine/formats.
using ScanImport = Result<Imported>(const std::string& path, const ImportOptions& options, JobControl& job);

/// Whether a session's journal is read: its ticks may take more memory than the field.
enum class JournalReading : std::uint8_t { kRead, kLeave };

struct SessionOpenOptions {
  /// Undo and redo steps are loaded, those nearest to the current state first, until their tiles take this
  /// much [bytes]; at least one each way. The others stay in the file (SessionWriter::loadOlder).
  std::size_t history_bytes = std::size_t{512} << 20;
  /// Where a referenced scan lies now. Empty: where it was, else at the same place relative to the session,
  /// else beside the session.
  std::string scan_path;
  /// With kLeave Session::journal stays empty. The file keeps it, and SessionWriter::saveAs too.
  JournalReading journal = JournalReading::kRead;
};

/// What a session takes on disk.
struct SessionSize {
  std::uint64_t file_bytes = 0;
  std::int64_t tiles = 0;
  std::uint64_t tile_bytes = 0;  ///< compressed
};

/// Reads a session, also while another program works on it: the last committed state. Every row and tile read
/// is checked against its checksum; heights, holes and marks come back bit for bit, what undo and redo states
/// share is shared again in memory. After a crash the file is brought in order on the way (its log is worked
/// in).
///
/// Errors, kInput: no such file, not a session, a newer format, damage (a flipped bit in anything that is
/// read, a file cut short), a referenced scan that is missing or not the same. kFailed: out of memory.
/// kCancelled. Time: that of reading and unpacking the tiles; thread: any; a long job.
[[nodiscard]] Result<Session> openSession(const std::string& path, const SessionOpenOptions& options,
                                          ScanImport* import_scan, JobControl& job);

/// Writes a session whole or not at all, in place of what stood at `path` (atomic_file.h). States 0 ..
/// history.first(), which the history no longer holds, become one step "Earlier steps". The journal's `state`
/// numbers are kept as they are.
/// Errors: the path cannot be written, a full disk, another program working on the session at `path`, a scan
/// to be referenced that cannot be read. Thread: any; a long job.
[[nodiscard]] Result<SessionSize> saveSession(const Session& session, const std::string& path,
                                              JobControl& job);

/// Reads every page, row and tile, those of steps that openSession leaves alone too, and says what is wrong
/// first. Thread: any; a long job.
[[nodiscard]] Result<SessionSize> verifySession(const std::string& path, JobControl& job);

}  // namespace fettle::engine
