#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/align.h"
#include "engine/nominal/nominal_deviation.h"

namespace fettle::app {

/// How a field is compared with a nominal mesh.
struct NominalChoice {
  std::string
      unit;  ///< of the mesh's numbers, one of engine::lengthUnitNames(); empty: as its file says, else mm
  bool shortest =
      false;  ///< distances to the nearest place of the mesh, above 0 outside; else heights over its topmost surface
  double tolerance = 0.0;  ///< on both sides [height_unit]; 0: none
};

/// What a field deviates from a mesh, as `fettle compare` finds it.
struct NominalCompared {
  engine::NominalDeviation deviation;
  std::optional<engine::Alignment> alignment;  ///< none: the mesh lies as its file says
  std::vector<std::string> remarks;            ///< on the mesh, a sentence each
};

/// Whether a path is that of a mesh: an .stl.
[[nodiscard]] bool isNominalFile(const std::string& path);

/// Reads a mesh and finds what `part`, a field without a form over it, deviates from it; `how`: it is brought onto the part first. Errors:
/// as engine::readNominal, alignNominal; a mesh of which nothing lies over or under the part (kInput); kCancelled. Thread: any; a long job.
[[nodiscard]] engine::Result<NominalCompared> compareWithNominal(
    const engine::Version& part, const std::string& path, const NominalChoice& choice,
    const std::optional<engine::AlignOptions>& how, engine::JobControl& job);

}  // namespace fettle::app
