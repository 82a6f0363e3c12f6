#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/io/points/gridding.h"

namespace fettle::engine {

/// A mesh as a file gives it. Corners that are not finite stay in their place as NaN (PointCloud::organized)
/// and take their triangles with them.
struct TriangleMesh {
  PointCloud corners;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into corners
};

/// Makes a field of a mesh: at each sample the highest of the surfaces above it, as a laser from above would
/// see it; a hole where there is none. Samples lie on the raster that the file states (PointCloud::raster) or
/// that the corners lie on, else on cells of ImportOptions::cell_size, else of a size that makes as many as
/// there are corners (warned about).
/// Errors (kInput): no triangle with finite corners, an index past the corners, a grid past memory,
/// triangles that lie over 200 deep on each sample in the mean (each layer of a part is two).
[[nodiscard]] Result<Imported> sampleMesh(TriangleMesh&& mesh, const ImportOptions& options,
                                          std::string format, const std::string& path, JobControl& job);

}  // namespace fettle::engine
