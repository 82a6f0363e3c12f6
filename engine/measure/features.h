#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/measure/surface.h"

namespace fettle::engine {

/// A parameter without a figure, and why.
struct NotStated {
  std::string parameter;  ///< "ssk"
  std::string reason;
};

/// Feature parameters: ISO 25178-2:2021, 5.8. Of all hills and dales but where closed ones are named. Heights about the mean,
/// depths below it. NaN without a figure.
struct FeatureParameters {
  std::int64_t hills = 0, dales = 0;
  double spd = 0.0;         ///< density of peaks [1/mm^2]
  double svd = 0.0;         ///< density of pits [1/mm^2]
  double spc = 0.0;         ///< arithmetic mean peak curvature [1/mm]
  double svc = 0.0;         ///< arithmetic mean pit curvature, above 0 as that of peaks [1/mm]
  std::int64_t curved = 0;  ///< peaks of spc: those with four neighbours
  double s5p = 0.0;         ///< five-point peak height: mean of the five highest peaks [height_unit]
  double s5v = 0.0;         ///< five-point pit depth: mean of the five deepest pits [height_unit]
  double s10z = 0.0;        ///< ten-point height: s5p + s5v [height_unit]
  double sha = 0.0;         ///< mean area of hills that reach neither border nor hole [mm^2]
  double sda = 0.0;         ///< of such dales [mm^2]
  double shv = 0.0;         ///< mean volume of hills above their highest saddle, of those closed there [mm^3]
  double sdv = 0.0;         ///< of dales below their lowest saddle, of those closed there [mm^3]
  std::vector<NotStated> not_stated;
};

/// Those of the hills and dales that are at least a share of `sz` high, 0.05 as the standard presumes. Dales are the hills of the
/// surface upside down. An area is that of a sample for each sample; curvature by second differences at the peak or pit. Memory: some 44 bytes per
/// sample beside the surface. Errors and the rest: as mapHills.
[[nodiscard]] Result<FeatureParameters> measureFeatures(const Surface& surface, double sz, double prune,
                                                        JobControl& job);

/// None of them, for one reason.
[[nodiscard]] FeatureParameters withoutFeatures(const std::string& why);

}  // namespace fettle::engine
