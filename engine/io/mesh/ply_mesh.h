#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/io/files/input_file.h"
#include "engine/io/mesh/mesh_sampling.h"

namespace fettle::engine {

/// Whether a file is a PLY, by its first bytes.
[[nodiscard]] bool isPly(const InputFile& file);

/// Reads the triangles of a PLY; a polygon is divided into a fan. Errors (kInput): as the import of a PLY as a field; one without faces;
/// kCancelled. Throws std::bad_alloc. Thread: any; a long job.
[[nodiscard]] Result<TriangleMesh> readPlyMesh(const InputFile& file, JobControl& job);

}  // namespace fettle::engine
