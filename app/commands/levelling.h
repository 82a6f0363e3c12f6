#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/form_option.h"
#include "app/report.h"
#include "app/work/work_estimate.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/field/version.h"
#include "engine/io/import.h"
#include "engine/measure/form_fit.h"
#include "engine/measure/line_offsets.h"

namespace fettle::app {

/// What is taken from each line of a line scanner before a form is fitted.
struct LineArguments {
  std::string rows;             ///< a word of lineWords(); empty: lines stay
  std::string scan_axis = "x";  ///< along which its lines are: x, rows, or y, columns
  /// LineOptions::form_degree; kNoForm: none stays.
  int keep_form = kNoForm;

  static constexpr int kNoForm = -1;
};

/// "median", "mean", "poly1" to "poly3", "difference", "matching".
[[nodiscard]] std::vector<Word> lineWords();

/// What the arguments mean, as typed and checked by their rows; the samples that count are those of the form.
[[nodiscard]] engine::LineOptions lineOptionsOf(const LineArguments& lines, const FormArguments& form);

/// What `fettle level` and the step "level" of a recipe take out of a field: offsets of lines, and the form of what is left.
struct Levelling {
  std::optional<engine::LineOffsets> lines;
  engine::FittedForm fit;

  /// A field of the same size without both, rounded to float once. Errors: as engine::lowered.
  [[nodiscard]] engine::Result<engine::Version> takenFrom(const engine::Version& field,
                                                          engine::JobControl& job) const;
};

/// Finds them by the samples of `counted` that count. `scan` is its path. Errors: as engine::findLineOffsets and formOf,
/// naming the scan.
[[nodiscard]] engine::Result<Levelling> levellingOf(const engine::Version& counted, const std::string& scan,
                                                    const engine::Imported& imported,
                                                    const LineArguments& lines, const FormArguments& form,
                                                    engine::JobControl& job);

/// Says so where lines lie further apart than before: parts of the surface were moved, not lines. Errors: kCancelled.
[[nodiscard]] engine::Status warnOfMovedLines(const Levelling& levelling, const engine::Version& counted,
                                              const std::string& scan, const LineArguments& lines,
                                              engine::JobControl& job);

/// How often a level is taken out of fields of one size: of the scan, or of what its changes are limited from as well.
enum class Lowered : std::uint8_t { kOnce = 1, kTwice = 2 };

/// The work for an estimate, by the samples of `counted` that count, a field of `field`'s size. Both live as long as what is returned.
[[nodiscard]] PlannedOnPieces plannedLevel(const engine::Version& field, const engine::Version& counted,
                                           const LineArguments& lines, const FormArguments& form,
                                           Lowered lowered);

/// As keys of a report: of lines rows, scan_axis, rows_rms, rows_empty, and where form across them stays keep_form, rows_form_rms; then those of addForm.
void addLevelling(Report& report, const LineArguments& lines, const FormArguments& form,
                  const Levelling& levelling, const engine::Grid& grid);

}  // namespace fettle::app
