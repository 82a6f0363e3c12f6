#include "engine/measure/align_spread.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fettle::engine {

namespace {

using Under = AlignLevel::Under;

constexpr double kNormal = 1.4826;  // of the median of absolute values

// The normalised median size.
double scaleOf(const std::vector<Under>& under) {
  return kNormal * residualAt(under, 0.5);
}

}  // namespace

double residualAt(const std::vector<Under>& under, double share) {
  std::vector<double> sizes;
  sizes.reserve(under.size());
  for (const Under& u : under)
    if (!std::isnan(u.residual)) sizes.push_back(std::abs(u.residual));
  if (sizes.empty()) return 0.0;
  const auto place =
      sizes.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sizes.size() - 1));
  std::ranges::nth_element(sizes, place);
  return *place;
}

double AlignSpread::at(const Under& u) const noexcept {
  return std::sqrt(level * level + sideways * sideways * (u.slope_x * u.slope_x + u.slope_y * u.slope_y));
}

AlignSpread spreadOf(const std::vector<Under>& under, double spacing, double least) {
  constexpr double kSteep = 3.0, kMore = 1.5;
  constexpr std::size_t kFewest = 24, kClasses = 16;
  AlignSpread spread{std::max(scaleOf(under), least), 0.0};
  // By classes of slope, each up to four times that of the class before: on a smooth part most steep places are little
  // inclined and agree, and one median over all of them would not see the edges.
  std::vector<std::vector<Under>> classes(kClasses);
  const double least_slope = kSteep * spread.level / spacing;
  for (const Under& u : under) {
    if (std::isnan(u.residual)) continue;
    const double slope = std::hypot(u.slope_x, u.slope_y);
    if (!(slope > least_slope)) continue;
    const double place = 0.5 * std::log2(slope / least_slope);
    classes[static_cast<std::size_t>(std::min(place, kClasses - 1.0))].push_back(u);
  }
  for (const std::vector<Under>& places : classes) {
    if (places.size() < kFewest) continue;
    const double size = scaleOf(places), limit = kMore * spread.level;
    if (!(size > limit)) continue;
    std::vector<double> slopes;
    slopes.reserve(places.size());
    for (const Under& u : places) slopes.push_back(std::hypot(u.slope_x, u.slope_y));
    const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
    std::ranges::nth_element(slopes, middle);
    spread.sideways = std::max(
        spread.sideways, std::min(std::sqrt(size * size - spread.level * spread.level) / *middle, spacing));
  }
  return spread;
}

}  // namespace fettle::engine
