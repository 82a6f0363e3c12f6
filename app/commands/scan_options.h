#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/work/outputs.h"
#include "app/work/scan_reading.h"
#include "engine/field/version.h"
#include "engine/io/export.h"
#include "engine/io/import.h"
#include "render/config.h"

namespace fettle::app {

/// The options of ScanOptions.
void addScanOptions(Command command, ScanOptions& options);

/// --store FOLDER: every field of this process lies there (engine/field/tile_store.h). Part of
/// addScanOptions.
void addStoreOption(Command command);

/// Imports a scan, "-" from standard input; what the importer warns of goes to stderr, each line naming the
/// file.
[[nodiscard]] engine::Result<engine::Imported> loadScan(const std::string& path, const ScanOptions& options,
                                                        engine::JobControl& job);

/// --original SCAN: what a limit of change is measured against, for files; a session has its own.
void addOriginalOption(Command command, std::string& original);

/// What the work on `imported` began with: `given` (--original) read as `reading` says, else the session's
/// own original, else the field itself. Grid and way up are the field's. A session given as --original stands
/// for the scan that it began with. Errors (kInput): --original for a session, another size or height unit;
/// those of loadScan.
[[nodiscard]] engine::Result<engine::Version> originalOf(const engine::Imported& imported,
                                                         const std::string& given, const ScanOptions& reading,
                                                         engine::JobControl& job);

/// Refuses --original where nothing would look at it: changes are not limited, and `out` is no session, which
/// would keep it.
[[nodiscard]] engine::Status checkOriginal(const std::string& given, bool limited, const std::string& out);

/// Export options with which a session begins with `original` (engine::ExportOptions::original).
[[nodiscard]] inline engine::ExportOptions beginningWith(std::optional<engine::Version> original) {
  engine::ExportOptions options;
  options.original = std::move(original);
  return options;
}

/// Writes a field, to "-" in the format of the extension `to`; what the format could not keep goes to stderr.
/// With `writing.original` a session begins with that.
[[nodiscard]] engine::Status saveField(const engine::Version& field, const std::string& path,
                                       engine::JobControl& job, const engine::ExportOptions& writing = {},
                                       const std::string& to = {});

/// --to EXT for a command whose OUT may be "-".
void addStreamFormat(Command command, std::string& to);

/// A length as the user types it, in height units of the field: "0.5" is in the field's own height unit,
/// "0.5mm", "20um" in the unit that is named. Errors: not a number, unknown unit, negative, not finite.
[[nodiscard]] engine::Result<double> parseHeight(const std::string& text, const engine::Grid& grid,
                                                 const std::string& option);

/// Sides that a size may have, both ends included.
struct SideRange {
  int smallest;
  int largest;
};
inline constexpr SideRange kFieldSides{1, engine::Grid::kMaxSide};
inline constexpr SideRange kWindowSides{render::kSmallestPicture, render::kLargestPiece};
inline constexpr SideRange kPictureSides{render::kSmallestPicture, render::kLargestPicture};

/// "WIDTHxHEIGHT", both within `sides`. Errors name the option.
[[nodiscard]] engine::Result<std::pair<int, int>> parseSize(const std::string& text,
                                                            const std::string& option, SideRange sides);

/// What is wrong with a seed as typed; empty when nothing is. For Option::check.
[[nodiscard]] std::string seedProblem(const std::string& text);

/// What an output may take the place of.
enum class Replacing {
  kNoWork,   ///< any file but a session that has a journal
  kAnything  ///< --force
};
void addForceOption(Command command, Replacing& replacing);

/// checkPlaces() for a command, which asks nobody: also refuses to replace a session that has a journal,
/// unless `replacing` allows it. Where an output replaces the scan of another session, that session gets the
/// scan first, with a warning (ScanGuard).
[[nodiscard]] engine::Status checkOutputs(const std::vector<Output>& outputs,
                                          const std::vector<std::string>& inputs, Replacing replacing,
                                          engine::JobControl& job);

}  // namespace fettle::app
