#pragma once

#include <string>

#include "app/commands/batch.h"
#include "app/commands/recipe_file.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/io/export.h"
#include "engine/io/import.h"

namespace fettle::app {

/// What is known of how a scan came about, and what a command adds to it: from this `fettle recipe` makes the recipe of the
/// session that the command writes.
class KnownSteps {
 public:
  /// Of a scan as it was read. A session on which the window worked is opened once more with its journal, where a session
  /// is to be written; of one from standard input or memory only what commands noted is known, and that the rest is
  /// missing, and where history or journal cannot be read, this. Errors: cancelled.
  [[nodiscard]] static engine::Result<KnownSteps> of(const engine::Imported& imported, const BatchTask& task,
                                                     engine::JobControl& job);

  /// A step that leaves what a session begins with as it is.
  void did(const RecipeStep& step);
  /// One that was also done to what a session begins with.
  void didToBoth(const RecipeStep& step);
  /// One with whose result a session begins.
  void beganWith(const RecipeStep& step);
  /// One that cannot be repeated on another scan, and why.
  void leftOut(const std::string& why);
  /// A level of field and original by a form that was fitted to the field.
  void levelledBoth(const RecipeLevel& step);

  /// As the notes of a session.
  void note(engine::ExportOptions& writing) const;

 private:
  Recipe begin_;            // what made the scan with which a session begins
  Recipe whole_;            // all that led to the field
  bool worked_on_ = false;  // whether the field is another than that scan
};

}  // namespace fettle::app
