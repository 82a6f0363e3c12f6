#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/field/line_cuts.h"
#include "engine/field/reader.h"
#include "engine/fill/holes.h"

namespace fettle::engine {

/// The surface that is put into a hole: of all through its rim the one with the least
enum class FillMethod : std::uint8_t {
  kMembrane,  ///< sum of squared slopes: a soap film (Laplace). Between the lowest and the highest sample of the rim
  kCurvature,  ///< sum of squared curvatures: a thin plate (biharmonic; Briggs 1974). Goes on with the slopes of the rim
};

/// One hole's surface.
struct HoleSurface {
  std::vector<float> heights;  ///< in the order of the runs; NaN where no rim reaches
  /// The rim does not determine the curvature's surface, as that of one sample: of all that fit the flattest.
  bool undetermined = false;
};

/// Works out the surface of one hole. `runs`: of the hole. `walls`: links that it does not reach over, or null;
/// `spacing_x`, `spacing_y`: of the samples, in one unit.
///
/// Membrane: sum over links of (z_a - z_b)^2 / h^2, h the spacing along the link. Curvature: sum of z_xx^2 + 2 z_xy^2 + z_yy^2
/// over the second differences of three samples of a row, of a column, and of the four of a cell. A sum holds terms of
/// samples of the hole and of samples with heights up to two samples away, and none with a sample of another hole, one
/// outside the field, or a link that is cut: there the surface ends freely (natural boundary). At marked samples and those
/// a line passes it may bend: no term says that slopes agree there.
///
/// The equations are solved in double by a Cholesky decomposition with an ordering of minimum degree (Eigen; Amestoy,
/// Davis, Duff 1996), heights about a height of the rim, with a step of refinement. Membrane: exact to a few ulp of
/// double times the number of samples. Throws std::bad_alloc. Thread: any; the same bits on each.
[[nodiscard]] HoleSurface surfaceOfHole(const FieldReader& field, std::span<const HoleRun> runs,
                                        const LineCuts* walls, FillMethod method, double spacing_x,
                                        double spacing_y);

}  // namespace fettle::engine
