#pragma once

#include <string>

#include "app/commands/command.h"
#include "app/work/scan_reading.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/io/mesh/nominal_file.h"

namespace fettle::app {

/// A nominal mesh in the place of a scan B.
struct NominalArguments {
  std::string unit;  ///< of the mesh's numbers; empty: as its file says, else mm
};

/// --nominal-unit.
void addNominalOptions(Command command, NominalArguments& arguments);

/// Whether B is a nominal mesh: an .stl; or a .ply, which may be a scan as well, with --nominal-unit. Standard input by --from.
[[nodiscard]] bool isNominal(const std::string& path, const ScanOptions& reading,
                             const NominalArguments& arguments);

/// engine::readNominal() of B; `from`: the format of standard input. Warns of triangles without an area, of sides at which a mesh does not say what is outside, where
/// that is needed, of one whose size is another than the part's by a factor of 20, as a wrong unit makes it.
enum class Sides : bool { kNotNeeded, kNeeded };
[[nodiscard]] engine::Result<engine::NominalFile> loadNominal(const std::string& path,
                                                              const NominalArguments& arguments,
                                                              const std::string& from,
                                                              const engine::Grid& part, Sides sides,
                                                              engine::JobControl& job);

/// "nominal": triangles, unit, open_sides.
[[nodiscard]] Report nominalReport(const engine::NominalFile& nominal);

}  // namespace fettle::app
