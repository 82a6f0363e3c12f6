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

}  // namespace fettle::app
