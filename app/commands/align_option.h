#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/work/work_estimate.h"
#include "engine/base/error.h"
#include "engine/field/version.h"
#include "engine/measure/align.h"
#include "engine/nominal/nominal_mesh.h"

namespace fettle::app {

/// How a scan B is moved onto a scan A.
struct AlignArguments {
  std::string moves = "all";       ///< a word of alignWords()
  std::optional<double> rotation;  ///< most that the search tries [degrees]
  std::string region = "all";
  std::string marks;  ///< a picture of marks of A instead of its own; empty: none
};

/// "all", "in-plane", "shift", "level".
[[nodiscard]] std::vector<Word> alignWords();

/// What one of them allows.
[[nodiscard]] const engine::AlignMoves& movesOf(const std::string& word);

/// --rotation, --region, --marks.
void addAlignOptions(Command command, AlignArguments& arguments);

/// Refuses options that have no effect together.
[[nodiscard]] engine::Status checkAlign(const AlignArguments& arguments);

/// engine::alignFields() of what the arguments mean; errors name the scans.
[[nodiscard]] engine::Result<engine::Alignment> alignmentOf(
    const engine::Version& a, const engine::Version& b, const std::string& path_a, const std::string& path_b,
    const AlignArguments& arguments, engine::JobControl& job);

/// engine::alignNominal() in the same way.
[[nodiscard]] engine::Result<engine::Alignment> alignmentOf(
    const engine::Version& a, const engine::NominalMesh& b, const std::string& path_a,
    const std::string& path_b, const AlignArguments& arguments, engine::JobControl& job);

/// What alignFields() takes for each height to which it reduces a scan [bytes]; measured on scans of 1200 and 2500 samples a side.
inline constexpr double kAligningMemory = 145.0;

/// The search for it, for an estimate: its time is that of the 2^20 heights at most to which both scans are reduced. What is given
/// lives as long as what is returned.
[[nodiscard]] PlannedOnPieces plannedAlignment(const engine::Version& a, const engine::Version& b,
                                               const AlignArguments& arguments);
/// Of a nominal mesh.
[[nodiscard]] PlannedOnPieces plannedAlignment(const engine::Version& a, const engine::NominalMesh& b,
                                               const AlignArguments& arguments);

/// The alignment as keys of a report (docs/commands.md); errors of what was not free are null.
[[nodiscard]] Report alignReport(const AlignArguments& arguments, const engine::Alignment& alignment);

/// Its lines: "shift x    0.123 +- 0.002 mm".
void printAlignment(const Report& report);

/// A table of the same: figure, value, standard_error, unit; then the matrix.
[[nodiscard]] std::string alignCsv(const Report& report);

}  // namespace fettle::app
