#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/rigid_motion.h"
#include "engine/nominal/nominal_mesh.h"

namespace fettle::engine {

/// A moved nominal as seen from above, along z: its topmost surface. Some 50 bytes per triangle, the mesh itself apart,
/// which it refers to and which outlives it. Threading: const functions from any thread.
class NominalSurface {
 public:
  /// `slack`: a place farther than this beside a triangle is not over it [mm]: what rounding makes of places on a border.
  /// Throws std::bad_alloc.
  NominalSurface(const NominalMesh& mesh, const RigidMotion& motion, double slack);

  struct Top {
    double z = std::numeric_limits<double>::quiet_NaN();  ///< [mm]; NaN: no triangle there
    bool up = true;                                       ///< whether its triangle is seen from its outside
  };
  /// The highest of the surfaces over a place. Sides belong to both of their triangles: no place falls between two.
  /// Vertical triangles have no place of their own; their upper side is that of another. Error: some 1e-15 of the
  /// coordinates, times the slope of the triangle. Steps: log n where surfaces do not lie over each other, at most n.
  [[nodiscard]] Top topAt(double x, double y) const noexcept;

 private:
  const NominalMesh& mesh_;
  double slack_;
  std::vector<glm::dvec3> corners_;
  std::vector<TriangleTree::Node> nodes_;
};

/// The slack for samples of a grid: 1e-9 of its spacing, and what the grid's position in the world leaves of a length.
[[nodiscard]] double slackOn(const Grid& grid) noexcept;
/// The same over a mesh: half of the seventh digit of its file's coordinates besides, which STL has at most, in float as in
/// text, up to a hundredth of the spacing. Without it a scan's own border lies beside the mesh that was made of it.
[[nodiscard]] double slackOn(const Grid& grid, const NominalMesh& mesh) noexcept;

/// Heights of the surface at the samples of a grid, in its height unit, rounded to float once; a hole where there is none.
/// No marks. Some microsecond per sample on one core over a million triangles. Errors: kFailed without memory; kCancelled.
/// Thread: any; a long job on all workers of the calling arena; bit-identical for any number of them.
[[nodiscard]] Result<Version> nominalHeights(const NominalSurface& surface, const Grid& grid,
                                             JobControl& job);

}  // namespace fettle::engine
