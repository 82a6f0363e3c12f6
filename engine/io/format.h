#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "engine/field/row_span.h"
#include "engine/io/export.h"
#include "engine/io/files/input_file.h"
#include "engine/io/import.h"

namespace fettle::engine {

/// Whether a file with these first bytes (up to Format::kHeadBytes) and this extension (lower case, with the
/// dot) is of a format. One with a signature ignores the extension.
using FormatRecogniser = bool(std::string_view head, std::string_view extension);

/// Reads the file; options were checked (finite, positive). May throw std::bad_alloc. Contract: importField.
using FormatReader = Result<Imported>(const InputFile& file, const ImportOptions& options, JobControl& job);

/// May throw std::bad_alloc. Contract: importPreview.
using FormatPreviewer = Result<std::optional<Preview>>(const InputFile& file, const ImportOptions& options,
                                                       std::int64_t max_samples, JobControl& job);

/// Reads some rows as a field of their own, and of the file little more than these; `rows` is not empty and lies in the field.
/// May throw std::bad_alloc. Contract: importRows.
using FormatRowsReader = Result<Imported>(const InputFile& file, const ImportOptions& options, RowSpan rows,
                                          JobControl& job);

/// What the header says: the grid that a full import has. Contract: importGrid.
using FormatGridReader = Result<Grid>(const InputFile& file, const ImportOptions& options);

/// Writes the file completely or not at all (AtomicFile). May throw std::bad_alloc. Contract: exportField.
using FormatWriter = Result<Exported>(const Version& field, const std::string& path,
                                      const ExportOptions& options, JobControl& job);

/// One format. Its importer's source ends with it.
struct Format {
  FormatInfo info;
  FormatRecogniser* recognises = nullptr;  ///< null for formats that are only written
  FormatReader* read = nullptr;
  FormatWriter* write = nullptr;
  FormatPreviewer* preview = nullptr;  ///< null where a preview would cost as much as the full import
  FormatGridReader* grid = nullptr;    ///< null where only a full import tells it, and `read_rows` with it
  FormatRowsReader* read_rows = nullptr;
  bool picture = false;        ///< samples may be distances: ImportOptions::depth_camera
  bool mesh = false;           ///< ExportOptions::mesh and max_error
  bool tiff = false;           ///< ExportOptions::cloud_optimised and tiff_compression
  bool ascii = false;          ///< ExportOptions::ascii
  bool units_certain = false;  ///< units are certain: they were determined at an earlier import

  static constexpr std::size_t kHeadBytes = 4096;
};

/// The writers, each in the source of its name: *_export.cpp; points_export.cpp and mesh_export.cpp.
FormatWriter writeTiff, writePng, writePly, writePlyMesh, writeX3p, writeSdf, writeExr, writeStl,
    writeAsciiGrid, writeXyz;

/// All formats, for engine/formats to list. Constants from the start: no order of initialisation.
extern const Format kTiffFormat, kPngFormat, kPlyFormat, kPcdFormat, kLasFormat, kSurFormat, kX3pFormat,
    kSdfFormat, kExrFormat, kStlFormat, kAsciiGridFormat, kFettleFormat, kMatrixFormat, kXyzFormat;

}  // namespace fettle::engine
