#pragma once

#include <optional>
#include <string>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/nominal/nominal_mesh.h"

namespace fettle::engine {

struct NominalFile {
  NominalMesh mesh;
  LengthUnit unit;  ///< of the file's numbers
};

/// Reads the nominal of a part from an STL or the faces of a PLY, whose numbers are in `unit`; without it in that which an STL's header
/// states, else in millimetres. An STL that Fettle wrote lies where its field lay. Stricter than the import as a field: a
/// triangle that is missing or damaged would be a deviation of the part. Errors (kInput): as readStlMesh and readPlyMesh; fewer triangles
/// counted in the header than the file holds; a corner that is not finite or over 1e15 mm away; as NominalMesh::create.
/// kFailed without memory; kCancelled. Memory: some 240 bytes per triangle while it is read. Thread: any; a long job.
[[nodiscard]] Result<NominalFile> readNominal(const std::string& path, const std::optional<LengthUnit>& unit,
                                              JobControl& job);

}  // namespace fettle::engine
