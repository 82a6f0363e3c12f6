#pragma once

#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/measure/fit.h"

namespace fettle::engine {

/// A shape that was tried, or why not.
struct TriedShape {
  ShapeKind kind = ShapeKind::kPlane;
  double rms_mm = 0.0;  ///< NaN: refused
  std::string refused;
};
struct ChosenShape {
  ShapeFit fit;
  std::vector<TriedShape> tried;
};
/// The shape, of some kinds, that describes the samples best. A shape is taken in place of a simpler one that it contains
/// (plane, then sphere or cylinder, cylinder, then cone, cone or sphere, then torus) only where it lowers the rms by a tenth,
/// and of those that are left the one with the least Bayesian information (G. Schwarz, Estimating the dimension of a model,
/// 1978), the samples counted as ShapeFit::correlation says. Chosen by at most some 260,000 of the samples, fitted to all.
[[nodiscard]] Result<ChosenShape> fitBestShape(const Version& field, const FitRegion& region,
                                               const std::vector<ShapeKind>& kinds, const FitOptions& options,
                                               JobControl& job);

}  // namespace fettle::engine
