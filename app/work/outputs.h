#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/io/format.h"

namespace fettle::app {

/// The extension with its dot, lower case; empty without one.
[[nodiscard]] std::string extensionOf(const std::string& path);

/// An extension as typed, "tif" or ".TIF", with its dot and in lower case.
[[nodiscard]] std::string withDot(const std::string& extension);

/// What a command writes, for the checks that need no scan.
enum class OutputKind {
  kField,    ///< extension of a format that can be written
  kMarks,    ///< .png, .tif, .tiff
  kPicture,  ///< .png
  kText,     ///< any
};
struct Output {
  std::string path;  ///< empty = not asked for
  OutputKind kind = OutputKind::kText;
  /// What "-" would be written as: an extension, empty where the user has not said one; nothing where the
  /// output cannot be standard output.
  std::optional<std::string> stream{};
  bool makes_folder = false;  ///< whoever writes it makes its folder when it is not there
};

/// The extensions of all formats that can be read (&engine::FormatInfo::reads) or written.
[[nodiscard]] std::vector<std::string> extensionsOf(bool engine::FormatInfo::*able);

/// Refuses, before anything is read or computed, what would fail or destroy something at the end: an
/// extension nobody writes, a folder that is not there or not writable, a target that is a folder or no
/// regular file, two outputs in one place, an output in the place of an input; standard output without a
/// format, for two outputs, or binary on a terminal.
[[nodiscard]] engine::Status checkPlaces(const std::vector<Output>& outputs,
                                         const std::vector<std::string>& inputs);

}  // namespace fettle::app
