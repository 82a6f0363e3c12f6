#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/align.h"
#include "engine/nominal/nominal_mesh.h"

namespace fettle::engine {

/// alignFields() of a part, which stays, and a nominal, which is moved: from its own coordinates (NominalMesh::corner())
/// to the part's field coordinates. First by the nominal as it lies, seen from above at the part's spacing (at most 2^22
/// samples); then, up to four times, by the nominal in the place found, at the part's own samples, so that neither
/// the raster nor bilinear patches between its samples are in the result: until a motion more is a tenth of its standard
/// error. Standard errors, refusals, costs and threads: as alignFields; heights of the nominal as nominalHeights.
[[nodiscard]] Result<Alignment> alignNominal(const Version& part, const NominalMesh& nominal,
                                             const AlignOptions& options, JobControl& job);

}  // namespace fettle::engine
