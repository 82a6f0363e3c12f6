#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/io/files/input_file.h"
#include "engine/io/mesh/mesh_sampling.h"

namespace fettle::engine {

struct StlMesh {
  TriangleMesh mesh;
  /// Of a binary file: how many triangles more than its header counts would be in its bytes. They were not read.
  std::uint64_t not_counted = 0;
};

/// Reads an STL, binary or text, whatever its units. Memory: 84 bytes per triangle, which are checked against the size of
/// the file first. Corners that are not finite are NaN. Errors (kInput): cut short, a corner without three numbers;
/// kCancelled. Throws std::bad_alloc. Thread: any; a long job.
[[nodiscard]] Result<StlMesh> readStlMesh(const InputFile& file, JobControl& job);

}  // namespace fettle::engine
