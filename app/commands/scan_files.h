#pragma once

#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/work/scan_reading.h"
#include "engine/field/edge_line.h"
#include "engine/field/version.h"
#include "engine/io/export.h"
#include "engine/io/import.h"
#include "engine/session/session.h"

namespace fettle::app {

// A path may be the name of a place in memory (app/work/memory_places.h) wherever these read or write.

/// Imports a scan, "-" from standard input; warnings of the importer go to stderr, each line naming the file.
[[nodiscard]] engine::Result<engine::Imported> loadScan(const std::string& path, const ScanOptions& options,
                                                        engine::JobControl& job);

/// loadScan() for commands about the samples themselves: field and original without any form over them, with a warning
/// where one lay over a session.
[[nodiscard]] engine::Result<engine::Imported> loadSamples(const std::string& path,
                                                           const ScanOptions& options,
                                                           engine::JobControl& job);

/// Field and original of what was loaded without any form over them; nothing is done where none lies over them.
[[nodiscard]] engine::Status takeSamples(engine::Imported& imported, engine::JobControl& job);

/// A field with the marks of a picture; without a picture, empty, the field itself. "-" is standard input, read once
/// for all scans of a command.
[[nodiscard]] engine::Result<engine::Version> withMarks(const engine::Version& field,
                                                        const std::string& picture, engine::JobControl& job);

/// The edge lines of a file. "-" as of withMarks; its format is recognised by its content.
[[nodiscard]] engine::Result<std::vector<engine::EdgeLine>> readLines(const std::string& file,
                                                                      const engine::Version& field,
                                                                      engine::JobControl& job);

/// A field with the edge lines of a file, numbered from 0, instead of its own; without a file, empty, the field itself.
[[nodiscard]] engine::Result<engine::Version> withLines(const engine::Version& field, const std::string& file,
                                                        engine::JobControl& job);

/// openSession() of a session that may be "-".
[[nodiscard]] engine::Result<engine::Session> loadSession(const std::string& path,
                                                          const engine::SessionOpenOptions& options,
                                                          engine::JobControl& job);

/// Writes the marks of a field as engine::exportMarks(), to "-" in the format of the extension `to`, to a place in memory
/// the field with them.
[[nodiscard]] engine::Status saveMarks(const engine::Version& field, const std::string& path,
                                       engine::JobControl& job, const std::string& to = ".png");

/// Writes lines as engine::exportLines(), to "-" as CSV.
[[nodiscard]] engine::Status saveLines(const std::vector<engine::EdgeLine>& lines, const engine::Grid& grid,
                                       const std::string& path, engine::JobControl& job);

/// What marks and lines are written as to "-", where nothing else is given.
inline constexpr const char* kMarksStream = ".png";
inline constexpr const char* kLinesStream = ".csv";

/// The hash of a field's samples and marks as reports print it; of a field seen under a form that of the samples stored.
/// Throws std::bad_alloc.
[[nodiscard]] std::string hashOf(const engine::Version& field);

/// Writes a field, to "-" in the format of the extension `to`; warnings about what the format could not store
/// go to stderr. With `writing.original` a session begins with that.
[[nodiscard]] engine::Status saveField(const engine::Version& field, const std::string& path,
                                       engine::JobControl& job, const engine::ExportOptions& writing = {},
                                       const std::string& to = {});

/// --to EXT for a command whose OUT may be "-".
void addStreamFormat(Command command, std::string& to);

}  // namespace fettle::app
