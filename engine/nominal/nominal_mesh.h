#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/nominal/mesh_topology.h"
#include "engine/nominal/triangle_tree.h"

namespace fettle::engine {

/// The nominal shape of a part: a mesh of triangles, anticlockwise seen from outside. Its coordinates are millimetres
/// from corner(), its least x and y, so that a mesh far from its zero loses no digit.
///
/// Cost of a million triangles: a second on one core to make, some 130 MB (240 MB while it is read and made).
/// Threading: const functions from any thread.
class NominalMesh {
 public:
  /// Of lone triangles whose coordinates are finite [mm]. Corners that are equal to the last bit are one. `where` names
  /// the mesh in errors. Errors: kInput without a triangle that has an area, or with more than 2^30; kFailed without
  /// memory; kCancelled. Thread: any; a long job on all workers of the calling arena; the same for any number of them.
  [[nodiscard]] static Result<NominalMesh> create(std::vector<TriangleCorners> triangles,
                                                  const std::string& where, JobControl& job);

  /// What is added to a coordinate of this mesh to have that of its file [mm]; z is 0.
  [[nodiscard]] const glm::dvec3& corner() const noexcept { return corner_; }
  [[nodiscard]] const Box& box() const noexcept { return tree_.nodes().front().box; }
  [[nodiscard]] const std::vector<glm::dvec3>& corners() const noexcept { return corners_; }
  /// In the order of tree().
  [[nodiscard]] const std::vector<TriangleIndices>& triangles() const noexcept { return triangles_; }
  [[nodiscard]] const TriangleTree& tree() const noexcept { return tree_; }
  [[nodiscard]] std::size_t withoutArea() const noexcept { return without_area_; }
  /// Sides that belong to one triangle or to more than two, and sides whose triangles are wound in opposite senses.
  [[nodiscard]] std::size_t openSides() const noexcept { return neighbours_.open_sides; }
  [[nodiscard]] std::size_t oddSides() const noexcept {
    return neighbours_.shared_by_many + neighbours_.turned;
  }

  /// The shortest distance from a point to the mesh, above 0 outside and below inside [mm]. Nothing where it is not
  /// below `most`. The side is that of the angle-weighted normal of the nearest face, edge or corner (J. Baerentzen
  /// and H. Aanaes, Signed distance computation using the angle weighted pseudonormal, 2005), which for a closed mesh
  /// without odd sides is the true one; beyond a border it is the side of the nearest triangle's plane.
  /// Error: some 1e-12 of the sizes of mesh and distance. Steps: log n for points near the mesh, at most n.
  [[nodiscard]] std::optional<double> distanceTo(const glm::dvec3& point, double most) const noexcept;

 private:
  NominalMesh() = default;
  void makeNormals();
  [[nodiscard]] glm::dvec3 normalAt(std::uint32_t triangle, int feature) const noexcept;

  glm::dvec3 corner_{0.0};
  std::vector<glm::dvec3> corners_, corner_normals_;
  std::vector<TriangleIndices> triangles_;
  Neighbours neighbours_;
  TriangleTree tree_;
  std::size_t without_area_ = 0;
};

}  // namespace fettle::engine
