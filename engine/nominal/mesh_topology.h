#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/base/job.h"

namespace fettle::engine {

/// Three corners, anticlockwise seen from outside [mm].
using TriangleCorners = std::array<glm::dvec3, 3>;
using TriangleIndices = std::array<std::uint32_t, 3>;

inline constexpr std::uint32_t kNoTriangle = UINT32_MAX;

/// What a list of lone triangles hides: which corners are one, and which triangles share a side.
struct MeshTopology {
  std::vector<glm::dvec3> corners;         ///< each place once
  std::vector<TriangleIndices> triangles;  ///< those that have an area, in the order given
  std::size_t without_area = 0;            ///< triangles left out
};

/// Joins the corners that are equal to the last bit; n log n steps, some 100 bytes per triangle. Throws std::bad_alloc.
/// Thread: any; on all workers of the calling arena; the same for any number of them.
[[nodiscard]] MeshTopology joinedCorners(std::vector<TriangleCorners>&& triangles);

/// For each side of each triangle (from corner k to the next) the triangle on its other side; kNoTriangle at a border,
/// and where more than two triangles share a side.
struct Neighbours {
  std::vector<TriangleIndices> of;
  std::size_t open_sides = 0;      ///< that belong to one triangle: the mesh is not closed
  std::size_t shared_by_many = 0;  ///< that belong to more than two
  std::size_t turned = 0;          ///< whose two triangles are wound in opposite senses
};

/// n log n steps, some 50 bytes per triangle while it works. Throws std::bad_alloc. Thread: as joinedCorners.
[[nodiscard]] Neighbours neighboursOf(const std::vector<TriangleIndices>& triangles);

/// The normal of a triangle, as long as twice its area.
[[nodiscard]] glm::dvec3 areaNormal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) noexcept;

}  // namespace fettle::engine
