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

// A session file, NAME.fettle: a scan, everything done to it, and the user's position in it. docs/formats.md
// describes the file; this header reads a session or writes a whole one, session_writer.h updates it during
// work.

/// How a session stores its original scan.
enum class OriginalStorage : std::uint8_t {
  kEmbedded,  ///< every tile is in the session: it needs no other file
  /// Path, size and checksum; opening imports the scan again and refuses one that changed. A scan that could
  /// not be found again is embedded: its file is no longer the one that was read (OriginalScan::read), or it
  /// was imported with options that the session has no column for (a depth camera).
  kReferenced,
};

/// Origin of the scan of a session.
struct OriginalScan {
  std::string path;  ///< of the scan's file; made absolute when written. Empty for a scan that never had one
  ImportOptions import;  ///< options with which it was imported
  std::string format;    ///< Imported::format
  /// The file's stamp when it was read. Empty: the file at `path` is used.
  std::optional<FileStamp> read;
};

/// One action of the user, for replay: undo and redo included, in their order.
struct JournalEntry {
  std::string action;  ///< one JSON object without line breaks; not interpreted by the session
  std::string data;    ///< larger data, such as the ticks of a stroke; any bytes, stored compressed
  StepTime time{};
  std::int64_t state =
      0;  ///< number of the state the field was in afterwards (History); filled in by the writer

  friend bool operator==(const JournalEntry&, const JournalEntry&) = default;
};

/// Small texts by name: "camera", "scene" (TOML) and others of the program.
using SessionNotes = std::map<std::string, std::string>;
/// The note of the steps that made the scan with which the session begins, as a recipe (docs/formats.md).
inline constexpr const char* kRecipeNote = "recipe";
/// The note of all steps, those of kRecipeNote first, that led to what a command wrote after that scan: to the step of the
/// name kByCommands, a form and an inversion after it. No entry of the journal is of these.
inline constexpr const char* kStepsNote = "steps";
inline constexpr const char* kByCommands = "By commands";
/// Of the window's sections (app/work/kept_sections.h).
inline constexpr const char* kSectionsNote = "sections";

/// A session in memory.
struct Session {
  OriginalScan scan;
  OriginalStorage storage = OriginalStorage::kEmbedded;
  Version original;  ///< the scan as imported, upright: deviation and --max-change refer to it
  History history;   ///< states held; state 0 is `original`
  SessionNotes notes;
  std::vector<JournalEntry> journal;
};

/// What reads the scan that a session refers to: importField of engine/formats.
using ScanImport = Result<Imported>(const std::string& path, const ImportOptions& options, JobControl& job);

/// Whether a session's journal is read: its ticks may take more memory than the field.
enum class JournalReading : std::uint8_t { kRead, kLeave };

struct SessionOpenOptions {
  /// Undo and redo steps are loaded, those nearest to the current state first, until their tiles use this
  /// much [bytes]; at least one in each direction. The others stay in the file (SessionWriter::loadOlder).
  std::size_t history_bytes = std::size_t{512} << 20;
  /// Path of a referenced scan now. Empty: its old path, else the same path relative to the session, else the
  /// session's folder.
  std::string scan_path;
  /// With kLeave Session::journal stays empty. The file keeps it, and SessionWriter::saveAs too.
  JournalReading journal = JournalReading::kRead;
};

/// Size of a session on disk.
struct SessionSize {
  std::uint64_t file_bytes = 0;
  std::int64_t tiles = 0;
  std::uint64_t tile_bytes = 0;  ///< compressed
};

/// Reads a session, also while another program works on it: the last committed state. Every row and tile read
/// is checked against its checksum; heights, holes and marks are bit-identical, tiles that undo and redo
/// states share are shared again in memory. After a crash the file is recovered first (its log is
/// checkpointed).
///
/// Errors, kInput: no such file, not a session, a newer format, damage (a flipped bit in anything that is
/// read, a file cut short), a referenced scan that is missing or not the same. kFailed: out of memory.
/// kCancelled. Time: reading and unpacking the tiles; thread: any; a long job.
[[nodiscard]] Result<Session> openSession(const std::string& path, const SessionOpenOptions& options,
                                          ScanImport* import_scan, JobControl& job);

/// Writes a session whole or not at all, replacing a file at `path` (atomic_file.h). Of what is seen under a form the
/// samples are stored (restored(), seen_field.h). States 0 ..
/// history.first(), which the history no longer holds, become one step "Earlier steps". The journal's `state`
/// numbers are kept as they are.
/// Errors: the path cannot be written, a full disk, another program working on the session at `path`, a scan
/// to be referenced that cannot be read. Thread: any; a long job.
[[nodiscard]] Result<SessionSize> saveSession(const Session& session, const std::string& path,
                                              JobControl& job);

/// Reads every page, row and tile, including steps that openSession does not read, and reports the first
/// error. Thread: any; a long job.
[[nodiscard]] Result<SessionSize> verifySession(const std::string& path, JobControl& job);

}  // namespace fettle::engine
