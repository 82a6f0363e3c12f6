#pragma once

#include <span>
#include <string>
#include <string_view>

#include "engine/io/export.h"
#include "engine/io/files/input_file.h"
#include "engine/io/import.h"
#include "engine/io/preview.h"

namespace fettle::engine {

/// One format: a row of the table in formats.cpp. To add one, write these functions and add the row.
struct Format {
  FormatInfo info;

  /// Whether a file with these first bytes (up to kHeadBytes) and this extension (lower case, with the dot)
  /// is of this format. Rows are asked in order; a format with a signature ignores the extension. Null for
  /// formats that are only written.
  bool (*recognises)(std::string_view head, std::string_view extension) = nullptr;

  /// Reads the file; options were checked (finite, positive). May throw std::bad_alloc. Contract:
  /// importField.
  Result<Imported> (*read)(const InputFile& file, const ImportOptions& options, JobControl& job) = nullptr;

  /// Writes the file whole or not at all (AtomicFile). May throw std::bad_alloc. Contract: exportField.
  Result<Exported> (*write)(const Version& field, const std::string& path, const ExportOptions& options,
                            JobControl& job) = nullptr;

  static constexpr std::size_t kHeadBytes = 4096;
};

[[nodiscard]] std::span<const Format> formatTable();

// The readers, writers and recognisers of the table, one source file a format.

[[nodiscard]] bool looksLikeTiff(std::string_view head, std::string_view extension);
[[nodiscard]] Result<Imported> readTiff(const InputFile&, const ImportOptions&, JobControl&);
[[nodiscard]] Result<std::optional<Preview>> previewTiff(const InputFile&, const ImportOptions&, std::int64_t,
                                                         JobControl&);
[[nodiscard]] Result<Exported> writeTiff(const Version&, const std::string&, const ExportOptions&,
                                         JobControl&);

[[nodiscard]] bool looksLikePng(std::string_view head, std::string_view extension);
[[nodiscard]] Result<Imported> readPng(const InputFile&, const ImportOptions&, JobControl&);
[[nodiscard]] Result<Exported> writePng(const Version&, const std::string&, const ExportOptions&,
                                        JobControl&);

[[nodiscard]] bool looksLikeAsciiGrid(std::string_view head, std::string_view extension);
[[nodiscard]] Result<Imported> readAsciiGrid(const InputFile&, const ImportOptions&, JobControl&);
[[nodiscard]] Result<Exported> writeAsciiGrid(const Version&, const std::string&, const ExportOptions&,
                                              JobControl&);

[[nodiscard]] bool looksLikePly(std::string_view head, std::string_view extension);
[[nodiscard]] Result<Imported> readPly(const InputFile&, const ImportOptions&, JobControl&);
[[nodiscard]] Result<Exported> writePly(const Version&, const std::string&, const ExportOptions&,
                                        JobControl&);

[[nodiscard]] bool looksLikeXyz(std::string_view head, std::string_view extension);
[[nodiscard]] Result<Imported> readXyz(const InputFile&, const ImportOptions&, JobControl&);
[[nodiscard]] Result<Exported> writeXyz(const Version&, const std::string&, const ExportOptions&,
                                        JobControl&);

[[nodiscard]] bool looksLikePcd(std::string_view head, std::string_view extension);
[[nodiscard]] Result<Imported> readPcd(const InputFile&, const ImportOptions&, JobControl&);

[[nodiscard]] bool looksLikeLas(std::string_view head, std::string_view extension);
[[nodiscard]] Result<Imported> readLas(const InputFile&, const ImportOptions&, JobControl&);

[[nodiscard]] bool looksLikeSur(std::string_view head, std::string_view extension);
[[nodiscard]] Result<Imported> readSur(const InputFile&, const ImportOptions&, JobControl&);

[[nodiscard]] bool looksLikeStl(std::string_view head, std::string_view extension);
[[nodiscard]] Result<Imported> readStl(const InputFile&, const ImportOptions&, JobControl&);
[[nodiscard]] Result<Exported> writeStl(const Version&, const std::string&, const ExportOptions&,
                                        JobControl&);

[[nodiscard]] bool looksLikeX3p(std::string_view head, std::string_view extension);
[[nodiscard]] Result<Imported> readX3p(const InputFile&, const ImportOptions&, JobControl&);
[[nodiscard]] Result<Exported> writeX3p(const Version&, const std::string&, const ExportOptions&,
                                        JobControl&);

[[nodiscard]] bool looksLikeExr(std::string_view head, std::string_view extension);
[[nodiscard]] Result<Imported> readExr(const InputFile&, const ImportOptions&, JobControl&);
[[nodiscard]] Result<Exported> writeExr(const Version&, const std::string&, const ExportOptions&,
                                        JobControl&);

// In engine/session.
[[nodiscard]] bool looksLikeSession(std::string_view head, std::string_view extension);
[[nodiscard]] Result<Imported> readSession(const InputFile&, const ImportOptions&, JobControl&);
[[nodiscard]] Result<Exported> writeSession(const Version&, const std::string&, const ExportOptions&,
                                            JobControl&);

}  // namespace fettle::engine
