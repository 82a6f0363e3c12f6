#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/io/files/input_file.h"
#include "engine/io/mesh/mesh_sampling.h"

namespace fettle::engine {

/// The 80 bytes before the triangles of a binary STL, in which the format says nothing: the unit of the numbers, and where
/// their zero lies in the world [unit], as far as both fit.
[[nodiscard]] std::string stlHeader(const LengthUnit& unit, const glm::dvec2& zero);

/// What such a header states; of another program's, nothing but a unit named as "units mm".
struct StlHeader {
  std::optional<LengthUnit> unit;
  glm::dvec2 zero{0.0};  ///< to be added to x and y [unit of the file]
};
[[nodiscard]] StlHeader stlHeaderOf(std::string_view bytes);

struct StlMesh {
  TriangleMesh mesh;
  StlHeader header;  ///< of a binary file
  /// Of a binary file: how many triangles more than its header counts would be in its bytes. They were not read.
  std::uint64_t not_counted = 0;
};

/// Reads an STL, binary or text, whatever its units. Memory: 84 bytes per triangle, which are checked against the size of
/// the file first. Corners that are not finite are NaN. Errors (kInput): cut short, a corner without three numbers;
/// kCancelled. Throws std::bad_alloc. Thread: any; a long job.
[[nodiscard]] Result<StlMesh> readStlMesh(const InputFile& file, JobControl& job);

}  // namespace fettle::engine
