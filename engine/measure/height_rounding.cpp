#include "engine/measure/height_rounding.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace fettle::engine {

std::string roundingDoubt(const Version& field, const ArealParameters& measured) {
  constexpr double kNoticed = 0.02;
  const HeightBounds bounds = field.reader().bounds();
  if (bounds.empty()) return {};
  const Grid& grid = field.grid();
  const float most = std::max(std::abs(bounds.min), std::abs(bounds.max));
  const double step = double{std::nextafter(most, std::numeric_limits<float>::infinity())} - double{most};
  const double variance = std::pow(step * grid.height_unit.mm, 2) / 12.0;
  const double dx = grid.spacingXMm(), dy = grid.spacingYMm();
  // Of variances: what rounding has of the mean square gradient. Of a flat field there is none, nor of one that is nothing but rounding.
  const double square = measured.sdq * measured.sdq;
  const double of_slopes =
      square > 0.0 ? variance * 4.0 / 3.0 * (1.0 / (dx * dx) + 1.0 / (dy * dy)) / square : 0.0;
  // Half the sum of both second differences; the middle sample is in both.
  const double curvature =
      0.5 * std::sqrt(variance * (6.0 / std::pow(dx, 4) + 6.0 / std::pow(dy, 4) + 8.0 / (dx * dx * dy * dy)));
  const auto shareOf = [&](double figure) { return figure > 0.0 ? curvature / figure : 0.0; };
  const double of_peaks = std::max(shareOf(measured.feature.spc), shareOf(measured.feature.svc));
  std::string what;
  if (of_slopes >= kNoticed)
    what = fmt::format("makes Sdq about {:.2g} % too large, Sdr {:.2g} %",
                       100.0 * (1.0 - std::sqrt(std::max(0.0, 1.0 - of_slopes))),
                       100.0 * std::min(1.0, of_slopes));
  if (of_peaks >= kNoticed)
    what += fmt::format("{}makes the curvature of a peak, of Spc and Svc, uncertain by {:.2g} %",
                        what.empty() ? "" : ", and ", 100.0 * of_peaks);
  if (what.empty()) return {};
  return fmt::format("heights up to {:.6g} {} are floats {:.2g} {} apart, which {}", most,
                     grid.height_unit.name, step, grid.height_unit.name, what);
}

}  // namespace fettle::engine
