#pragma once

#include <optional>
#include <string>
#include <utility>

#include "app/commands/command.h"
#include "app/work/scan_reading.h"
#include "engine/field/version.h"
#include "engine/io/export.h"
#include "engine/io/import.h"

namespace fettle::app {

/// --original SCAN: the reference of a limit of change, for files; a session has its own.
void addOriginalOption(Command command, std::string& original);

/// The original of `imported`: `given` (--original) read with the options `reading`, otherwise the session's
/// own original, otherwise the field itself. Grid and sign are the field's. A session given as --original
/// represents the scan that it began with. Errors (kInput): --original for a session, another size or height
/// unit; those of loadScan.
[[nodiscard]] engine::Result<engine::Version> originalOf(const engine::Imported& imported,
                                                         const std::string& given, const ScanOptions& reading,
                                                         engine::JobControl& job);

/// Whether it is a session whose samples, marks or edge lines are not those that it began with.
[[nodiscard]] bool isWorkedOn(const engine::Imported& imported);

/// Refuses --original where it would have no effect: changes are not limited, and `out` is not a session,
/// which would store it.
[[nodiscard]] engine::Status checkOriginal(const std::string& given, bool limited, const std::string& out);

/// Export options with which a session begins with `original` (engine::ExportOptions::original).
[[nodiscard]] inline engine::ExportOptions beginningWith(std::optional<engine::Version> original) {
  engine::ExportOptions options;
  options.original = std::move(original);
  return options;
}

}  // namespace fettle::app
