#include "engine/measure/features.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "engine/compare/tile_sums.h"
#include "engine/measure/hills.h"

namespace fettle::engine {

namespace {

constexpr std::size_t kFivePoints = 5;

// Mean of some figures; NaN of none.
struct MeanOf {
  CompensatedSum sum;
  std::int64_t count = 0;

  void add(double value) noexcept {
    sum.add(value);
    ++count;
  }
  [[nodiscard]] double value() const noexcept {
    return count > 0 ? sum.value() / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN();
  }
};

// What is said of hills, and of dales as hills of the surface upside down.
struct SideFigures {
  std::int64_t count = 0;
  double density = 0.0;  // [1/mm^2]
  MeanOf curvature;      // [1/mm]
  MeanOf heights;        // of the highest [height_unit]
  MeanOf areas;          // of those that are not cut [mm^2]
  MeanOf volumes;        // of those that are not open [mm^3]
};

// At a peak with four neighbours [1/mm].
std::optional<double> curvatureAt(const Surface& surface, std::int32_t c, std::int32_t r) noexcept {
  if (c == 0 || r == 0 || c + 1 == surface.width || r + 1 == surface.height) return std::nullopt;
  const double middle = 2.0 * static_cast<double>(surface.at(c, r));
  const double along_x = (static_cast<double>(surface.at(c - 1, r)) - middle + surface.at(c + 1, r)) /
                         (surface.spacing_x * surface.spacing_x);
  const double along_y = (static_cast<double>(surface.at(c, r - 1)) - middle + surface.at(c, r + 1)) /
                         (surface.spacing_y * surface.spacing_y);
  if (std::isnan(along_x + along_y)) return std::nullopt;
  return -0.5 * (along_x + along_y) * surface.height_mm;
}

Result<SideFigures> measureSide(const Surface& surface, double least, JobControl& job) {
  const auto map = mapHills(surface, least, job);
  if (!map) return tl::unexpected(map.error());
  SideFigures side;
  side.count = static_cast<std::int64_t>(map->hills.size());
  side.density = static_cast<double>(side.count) /
                 (static_cast<double>(surface.samples) * surface.spacing_x * surface.spacing_y);
  for (const HillFigures& of : figuresOfHills(surface, *map)) {
    if (const auto curvature = curvatureAt(surface, of.hill.column, of.hill.row))
      side.curvature.add(*curvature);
    if (!of.cut) side.areas.add(of.area_mm2);
    if (!of.open) side.volumes.add(of.volume_mm3);
  }
  // The highest come first.
  if (map->hills.size() >= kFivePoints)
    for (std::size_t i = 0; i < kFivePoints; ++i) side.heights.add(map->hills[i].peak);
  return side;
}

void state(FeatureParameters& of, const char* parameter, double& to, double value, const std::string& why) {
  to = value;
  if (std::isnan(value)) of.not_stated.push_back({parameter, why});
}

std::string tooFew(const char* what, std::int64_t count) {
  return fmt::format("there {} {} {}{}, and five are needed", count == 1 ? "is" : "are", count, what,
                     count == 1 ? "" : "s");
}

}  // namespace

FeatureParameters withoutFeatures(const std::string& why) {
  FeatureParameters none;
  const double no_figure = std::numeric_limits<double>::quiet_NaN();
  state(none, "spd", none.spd, no_figure, why);
  state(none, "svd", none.svd, no_figure, why);
  state(none, "spc", none.spc, no_figure, why);
  state(none, "svc", none.svc, no_figure, why);
  state(none, "s5p", none.s5p, no_figure, why);
  state(none, "s5v", none.s5v, no_figure, why);
  state(none, "s10z", none.s10z, no_figure, why);
  state(none, "sha", none.sha, no_figure, why);
  state(none, "sda", none.sda, no_figure, why);
  state(none, "shv", none.shv, no_figure, why);
  state(none, "sdv", none.sdv, no_figure, why);
  return none;
}

Result<FeatureParameters> measureFeatures(const Surface& surface, double sz, double prune, JobControl& job) {
  if (surface.width < 2 || surface.height < 2)
    return withoutFeatures("fewer than 2 columns or rows of samples");
  if (!(sz > 0.0)) return withoutFeatures("the surface is flat");
  if (surface.heights.size() > kMostMapped)
    return withoutFeatures(fmt::format("more than {} samples", kMostMapped));
  const auto hills = measureSide(surface, prune * sz, job);
  if (!hills) return tl::unexpected(hills.error());
  Surface inverted = surface;
  for (float& z : inverted.heights) z = -z;
  const auto dales = measureSide(inverted, prune * sz, job);
  if (!dales) return tl::unexpected(dales.error());

  FeatureParameters of;
  of.hills = hills->count;
  of.dales = dales->count;
  of.spd = hills->density;
  of.svd = dales->density;
  of.curved = hills->curvature.count;
  state(of, "spc", of.spc, hills->curvature.value(), "every peak lies at the border or at a hole");
  state(of, "svc", of.svc, dales->curvature.value(), "every pit lies at the border or at a hole");
  const double peaks = hills->heights.value(), pits = dales->heights.value();
  state(of, "s5p", of.s5p, peaks, tooFew("hill", of.hills));
  state(of, "s5v", of.s5v, pits, tooFew("dale", of.dales));
  state(of, "s10z", of.s10z, peaks + pits,
        std::isnan(peaks) ? tooFew("hill", of.hills) : tooFew("dale", of.dales));
  state(of, "sha", of.sha, hills->areas.value(), "every hill reaches the border or a hole");
  state(of, "sda", of.sda, dales->areas.value(), "every dale reaches the border or a hole");
  state(of, "shv", of.shv, hills->volumes.value(),
        "every hill reaches the border or a hole above its saddle");
  state(of, "sdv", of.sdv, dales->volumes.value(),
        "every dale reaches the border or a hole below its saddle");
  return of;
}

}  // namespace fettle::engine
