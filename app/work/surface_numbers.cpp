#include "app/work/surface_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace fettle::app {

namespace {

constexpr int kRatioSteps = 400;

}  // namespace

std::vector<double> curveRatios() {
  std::vector<double> ratios;
  for (int i = 0; i <= kRatioSteps; ++i) ratios.push_back(static_cast<double>(i) / kRatioSteps);
  return ratios;
}

std::span<const double> curveHeights(const engine::ArealParameters& measured) {
  return std::span(measured.heights).last(kRatioSteps + 1);
}

double decayStepMm(const engine::SpatialAnalysis& analysis) {
  return std::min(analysis.correlation.spacing_x, analysis.correlation.spacing_y);
}

std::vector<DecayCurve> decayCurves(const engine::SpatialAnalysis& analysis) {
  const double step_mm = decayStepMm(analysis);
  const engine::SpatialParameters& found = analysis.parameters;
  std::vector<DecayCurve> curves;
  if (std::isnan(found.sal_direction) || std::isnan(found.slow_direction))
    curves = {{"along x", 0.0, {}}, {"along y", 90.0, {}}};
  else
    curves = {{"fastest", found.sal_direction, {}}, {"slowest", found.slow_direction, {}}};
  for (DecayCurve& curve : curves) {
    const double angle = curve.degrees * std::numbers::pi / 180.0;
    for (std::size_t i = 0;; ++i) {
      const double distance = static_cast<double>(i) * step_mm;
      const double value =
          analysis.correlation.valueAt(distance * std::cos(angle), distance * std::sin(angle));
      if (std::isnan(value)) break;
      curve.values.push_back(value);
    }
  }
  return curves;
}

SurfaceCurves curvesOf(const engine::ArealParameters& measured, const engine::Grid& grid) {
  SurfaceCurves curves;
  const std::span<const double> heights = curveHeights(measured);
  curves.heights.assign(heights.begin(), heights.end());
  if (measured.analysis == nullptr) {
    curves.no_decay =
        measured.spatial.no_sal.empty() ? "there was no memory for it" : measured.spatial.no_sal;
    return curves;
  }
  const engine::SpatialAnalysis& analysis = *measured.analysis;
  curves.decay = decayCurves(analysis);
  curves.decay_step_mm = decayStepMm(analysis);
  const double sq_mm = measured.sq * grid.height_unit.mm;
  curves.along_x = engine::profileSpectrum(analysis.correlation, engine::ProfileAxis::kX, sq_mm * sq_mm);
  curves.along_y = engine::profileSpectrum(analysis.correlation, engine::ProfileAxis::kY, sq_mm * sq_mm);
  return curves;
}

}  // namespace fettle::app
