#pragma once

#include <string>

#include "app/commands/command.h"
#include "app/work/scan_reading.h"
#include "engine/field/version.h"
#include "engine/io/export.h"
#include "engine/io/import.h"

namespace fettle::app {

/// Imports a scan, "-" from standard input; warnings of the importer go to stderr, each line naming the file.
[[nodiscard]] engine::Result<engine::Imported> loadScan(const std::string& path, const ScanOptions& options,
                                                        engine::JobControl& job);

/// A field with the marks of a picture; without a picture, empty, the field itself.
[[nodiscard]] engine::Result<engine::Version> withMarks(const engine::Version& field,
                                                        const std::string& picture);

/// A field with the edge lines of a file, numbered from 0, instead of its own; without a file, empty, the field itself.
[[nodiscard]] engine::Result<engine::Version> withLines(const engine::Version& field,
                                                        const std::string& file);

/// The hash of a field's samples and marks as reports print it.
[[nodiscard]] std::string hashOf(const engine::Version& field);

/// Writes a field, to "-" in the format of the extension `to`; warnings about what the format could not store
/// go to stderr. With `writing.original` a session begins with that.
[[nodiscard]] engine::Status saveField(const engine::Version& field, const std::string& path,
                                       engine::JobControl& job, const engine::ExportOptions& writing = {},
                                       const std::string& to = {});

/// --to EXT for a command whose OUT may be "-".
void addStreamFormat(Command command, std::string& to);

}  // namespace fettle::app
