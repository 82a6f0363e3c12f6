#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/io/points/gridding.h"

namespace fettle::engine {

/// A mesh as stored in a file. Corners that are not finite are kept as NaN (PointCloud::organized); their
/// triangles are left out.
struct TriangleMesh {
  PointCloud corners;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into corners
};

/// Makes a field of a mesh: at each sample the highest of the surfaces above it, as seen by a laser from
/// above; a hole where there is none. Samples lie on the raster that the file states (PointCloud::raster) or
/// on which the corners lie, otherwise on cells of ImportOptions::cell_size, otherwise of a size that gives
/// as many samples as there are corners (with a warning).
/// Errors (kInput): no triangle with finite corners, an index past the corners, a grid past memory, more than
/// 200 triangles over each sample in the mean (each layer of a part counts twice).
[[nodiscard]] Result<Imported> sampleMesh(TriangleMesh&& mesh, const ImportOptions& options,
                                          std::string format, const std::string& path, JobControl& job);

}  // namespace fettle::engine
