#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/work/scan_reading.h"

namespace fettle::app {

/// A field of the page on which a file's reading is chosen ("Read as ..."), beside the option of the command line that
/// says the same: what the engine says of options is said of fields in the window.
struct ReadingField {
  std::string_view option;  ///< "--unit"
  std::string_view name;    ///< "unit"
  bool meaning = false;  ///< it says what the file's numbers mean: a warning that names it tells of a guess
  std::string_view tip;  ///< for the window
};

/// In the order of the page.
[[nodiscard]] std::span<const ReadingField> readingFields();
[[nodiscard]] const ReadingField& readingField(std::string_view option);

/// A warning or an error of the engine with the names of fields in place of options: "give --no-data 0" becomes
/// "set "no data" to 0". Text without options stays as it is.
[[nodiscard]] std::string inFieldWords(std::string_view text);

/// Whether a warning says that something about the numbers of a file was guessed: a unit, a spacing, a value for holes.
[[nodiscard]] bool isGuess(std::string_view warning);
/// Whether what an option says was assumed for want of a word in the file; a doubt about what it says is none.
[[nodiscard]] bool isAssumed(const std::vector<std::string>& warnings, std::string_view option);
[[nodiscard]] bool anyGuess(const std::vector<std::string>& warnings);

/// "unit mm, no data 0": what was said of a file, by the names of the fields; empty where nothing was.
[[nodiscard]] std::string readingText(const ScanOptions& reading);

/// Which fields can apply to a file of a format (FormatInfo::name).
struct FieldsThatApply {
  bool spacing = true;  ///< samples in rows and columns
  bool cells = false;   ///< points that lie as they like
  bool camera = false;  ///< counts of a picture, which may be distances
};
/// `counts`: the samples are whole numbers.
[[nodiscard]] FieldsThatApply fieldsThatApply(std::string_view format, bool counts);
/// To a file before it is read: those of each format that has its extension.
[[nodiscard]] FieldsThatApply fieldsOfName(const std::string& path);

/// Where unit and spacing of a reading come from: "from the file: spacing" and "as you say: unit mm, no data 0"; a text is
/// empty where there is nothing of its kind. What was guessed stands in neither.
struct ReadingSources {
  std::string file, person;
};
[[nodiscard]] ReadingSources readingSources(const ScanOptions& reading,
                                            const std::vector<std::string>& warnings,
                                            const FieldsThatApply& apply);

}  // namespace fettle::app
