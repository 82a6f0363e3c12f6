#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/io/format.h"

namespace fettle::app {

/// An extension as typed, "tif" or ".TIF", with its dot and in lower case.
[[nodiscard]] std::string withDot(const std::string& extension);

/// Kind of output of a command, for the checks that need no scan.
enum class OutputKind {
  kField,    ///< extension of a format that can be written
  kMarks,    ///< .png, .tif, .tiff
  kPicture,  ///< .png
  kLines,    ///< engine::kLineExtensions
  kPage,     ///< .html, .htm, .pdf
  kPlot,     ///< .svg, .png
  kDrawing,  ///< .dxf
  kText,     ///< any but that of a format of scans; .csv and .txt are both
};
struct Output {
  std::string path;  ///< empty = not requested
  OutputKind kind = OutputKind::kText;
  /// Format for "-": an extension, empty where the user has given none; no value where the output cannot be
  /// standard output.
  std::optional<std::string> stream{};
  bool makes_folder = false;  ///< its folder is created if necessary
};

/// The extensions of all formats that can be read (&engine::FormatInfo::reads) or written.
[[nodiscard]] std::vector<std::string> extensionsOf(bool engine::FormatInfo::*able);
/// The same as they are typed after --to and --from: without their dots.
[[nodiscard]] std::vector<std::string> extensionWords(bool engine::FormatInfo::*able);

/// Errors, before anything is read or computed, for outputs that would fail or overwrite something at the
/// end: an extension without a writer, a folder that is missing or not writable, a target that is a folder or
/// not a regular file, two outputs with one path, an output that is an input; standard output without a
/// format, for two outputs, or binary on a terminal.
[[nodiscard]] engine::Status checkPlaces(const std::vector<Output>& outputs,
                                         const std::vector<std::string>& inputs);

}  // namespace fettle::app
