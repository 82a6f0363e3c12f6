#pragma once

#include <array>
#include <cstdint>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/field/polynomial_form.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"

namespace fettle::engine {

/// Three points of a plane, and how far around each heights are averaged.
struct ThreePoints {
  std::array<glm::dvec2, 3> at_mm{};  ///< field coordinates: from the lower left sample
  double radius_mm = 0.0;             ///< 0: usualProbeRadiusMm() (around.h)

  /// The same on a field of means of `step` x `step` samples of one with this grid (engine::meansOf).
  [[nodiscard]] ThreePoints onMeans(const Grid& grid, int step) const noexcept;

  friend bool operator==(const ThreePoints&, const ThreePoints&) = default;
};

/// The plane through three means.
struct ThreePointPlane {
  struct Mean {
    glm::dvec2 at_mm{0.0};  ///< the middle of the samples, which holes move
    double height = 0.0;    ///< [height_unit]
    std::int64_t samples = 0;
  };
  PolynomialForm form;
  std::array<Mean, 3> means;
  std::int64_t samples = 0;  ///< of the three
  double rms = 0.0;          ///< of these about the plane [height_unit]
  /// Standard errors of the slopes [mm/mm]; NaN where each point has but one sample.
  double slope_x_error = 0.0, slope_y_error = 0.0;
};

/// Lays a plane through the mean heights of the region's samples around three points, each at the middle of its samples: so a plane
/// is found exactly whichever of them are holes. Signs applied.
///
/// The errors are those that the scatter of the samples about the plane gives to the three means, taken as independent from sample
/// to sample; addLineErrors() (three_point_errors.h) counts lines that are off. Of other noise that neighbours share they are too small; where discs overlap too large.
///
/// Refused (kInput): a point without a sample around it; three middles of which one lies nearer to the line through the other two
/// than a sample or a fiftieth of their distance; a radius of a thousand samples or more. Sums in double. Thread: any; time as the
/// samples around the points.
[[nodiscard]] Result<ThreePointPlane> planeThrough(const Version& field, const ThreePoints& points,
                                                   Region region);

}  // namespace fettle::engine
