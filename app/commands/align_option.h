#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/region_option.h"
#include "engine/base/error.h"
#include "engine/field/version.h"
#include "engine/io/import.h"
#include "engine/measure/align.h"
#include "engine/nominal/nominal_mesh.h"

namespace fettle::app {

/// How a scan B is moved onto a scan A.
struct AlignArguments : RegionArguments {  // samples of A that count
  std::string moves = "all";               ///< a word of alignWords()
  std::optional<double> rotation;          ///< most that the search tries [degrees]
};

/// "all", "in-plane", "shift", "level".
[[nodiscard]] std::vector<Word> alignWords();

/// What one of them allows.
[[nodiscard]] const engine::AlignMoves& movesOf(const std::string& word);

/// What the arguments mean to the engine, in a field of countedOf().
[[nodiscard]] engine::AlignOptions alignOptionsOf(const AlignArguments& arguments);

/// --rotation, and the options of the region under the names that it has.
void addAlignOptions(Command command, AlignArguments& arguments);

/// Refuses options that have no effect together.
[[nodiscard]] engine::Status checkAlign(const AlignArguments& arguments);

/// engine::alignFields() of what the arguments mean; errors name the scans. Those of countedOf.
[[nodiscard]] engine::Result<engine::Alignment> alignmentOf(
    const engine::Imported& a, const engine::Version& b, const std::string& path_a, const std::string& path_b,
    const AlignArguments& arguments, engine::JobControl& job);

/// engine::alignNominal() in the same way.
[[nodiscard]] engine::Result<engine::Alignment> alignmentOf(
    const engine::Imported& a, const engine::NominalMesh& b, const std::string& path_a,
    const std::string& path_b, const AlignArguments& arguments, engine::JobControl& job);

/// The alignment as keys of a report (docs/commands.md); errors of what was not free are null.
[[nodiscard]] Report alignReport(const AlignArguments& arguments, const engine::Alignment& alignment);

/// Its lines: "shift x    0.123 +- 0.002 mm".
void printAlignment(const Report& report);

/// A table of the same: figure, value, standard_error, unit; then the matrix.
[[nodiscard]] std::string alignCsv(const Report& report);

}  // namespace fettle::app
