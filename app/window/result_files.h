#pragma once

#include <span>
#include <string>
#include <string_view>

#include "app/window/parts.h"
#include "app/work/outputs.h"

/// The files of what was measured, which are written by a dialog of their own each: one table for the actions that ask for them,
/// the dialog, and the writing. Threading: main.
namespace fettle::app {

/// One of the formats of such a file, named by its ending.
struct ResultFormat {
  std::string_view ending;  ///< ".csv"
  std::string_view text;
  OutputKind kind;  ///< of the ending, for the checks of its place
};

struct ResultFile {
  Question::Kind kind;
  const char* what;     ///< "sections"
  const char* usual;    ///< what the suggested name ends with: "_sections.csv"
  const char* content;  ///< what is in it, below the path
  std::span<const ResultFormat> formats;
  ResultWriting::Reads reads;
  /// What is to be written now, or why nothing can be.
  engine::Result<ResultWriting::Work> (*work)(Parts& parts);
};

/// Null: the question is another one.
[[nodiscard]] const ResultFile* resultFileOf(Question::Kind kind);

/// The format that the ending of a path names; null: none of the file's.
[[nodiscard]] const ResultFormat* formatOf(const ResultFile& file, const std::string& path);

/// Shows the dialog of a file, or the message why it cannot be written now.
void askForResult(Question::Kind kind, Parts& parts);
/// Writes to the confirmed path of `question`, whose ending names a format, after a question where a file would be replaced; refused paths are a message.
void confirmResult(Question question, Parts& parts);
/// Writes, and replaces what is there.
void writeResult(Question::Kind kind, const std::string& path, Parts& parts);

}  // namespace fettle::app
