#include "engine/nominal/nominal_deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>
#include <vector>

#include "engine/compare/tile_select.h"
#include "engine/compare/tile_sums.h"
#include "engine/field/builder.h"
#include "engine/nominal/nominal_surface.h"

namespace fettle::engine {

namespace {

struct DeviationSums {
  std::int64_t samples = 0, no_nominal = 0, unmeasured = 0, within = 0, above = 0, below = 0, face_down = 0;
  double min = std::numeric_limits<double>::infinity(), max = -min;
  CompensatedSum sum, square;

  void add(double d, const std::optional<double>& tolerance) noexcept {
    ++samples;
    sum.add(d);
    square.add(d * d);
    min = std::min(min, d);
    max = std::max(max, d);
    if (tolerance) ++(d > *tolerance ? above : d < -*tolerance ? below : within);
  }
  void add(const DeviationSums& other) noexcept {
    samples += other.samples;
    no_nominal += other.no_nominal;
    unmeasured += other.unmeasured;
    within += other.within;
    above += other.above;
    below += other.below;
    face_down += other.face_down;
    min = std::min(min, other.min);
    max = std::max(max, other.max);
    sum.add(other.sum);
    square.add(other.square);
  }
};

// Whether most of the surface, at 64 x 64 samples of the part, is seen from its inside.
bool seenFromInside(const NominalSurface& surface, const Grid& grid) {
  constexpr std::int32_t kPlaces = 64;
  std::int64_t up = 0, down = 0;
  for (std::int32_t j = 0; j < kPlaces; ++j)
    for (std::int32_t i = 0; i < kPlaces; ++i) {
      const double x = (i + 0.5) / kPlaces * (grid.width - 1) * grid.spacingXMm(),
                   y = (j + 0.5) / kPlaces * (grid.height - 1) * grid.spacingYMm();
      const NominalSurface::Top top = surface.topAt(x, y);
      if (!std::isnan(top.z)) ++(top.up ? up : down);
    }
  return down > up;
}

}  // namespace

Result<NominalDeviation> deviationFromNominal(const Version& part, const NominalMesh& nominal,
                                              const RigidMotion& motion, const NominalOptions& options,
                                              JobControl& job) try {
  if (options.tolerance && !(*options.tolerance >= 0.0))
    return inputError("a tolerance below 0 has no meaning", "tolerance", "give half the width of the band");
  Grid grid = part.grid();
  grid.height_per_count = 0.0;
  const NominalSurface surface(nominal, motion, slackOn(grid, nominal));
  NominalDeviation result;
  result.turned = seenFromInside(surface, grid);
  Result<FieldBuilder> builder = FieldBuilder::create(grid, "the deviation");
  if (!builder) return tl::unexpected(builder.error());
  const FieldReader from = part.reader();
  const double sx = grid.spacingXMm(), sy = grid.spacingYMm(), unit = grid.height_unit.mm;
  const double outside = result.turned ? -1.0 : 1.0;
  job.begin("measuring against the nominal", tileCount(from));
  const auto parts = forEachTile<DeviationSums>(from, job, [&](const SampleRect& rect, DeviationSums& sums) {
    float z[kTileSamples];
    from.readHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
    for (std::int32_t r = 0; r < rect.rows; ++r)
      for (std::int32_t c = 0; c < rect.columns; ++c) {
        float& here = z[r * kTileSide + c];
        const double x = (rect.column + c) * sx, y = (rect.row + r) * sy, height = double{here} * unit;
        const NominalSurface::Top top = surface.topAt(x, y);
        here = std::numeric_limits<float>::quiet_NaN();
        if (std::isnan(top.z)) {
          sums.no_nominal += std::isnan(height) ? 0 : 1;
          continue;
        }
        if (std::isnan(height)) {
          ++sums.unmeasured;
          continue;
        }
        if (top.up == result.turned) ++sums.face_down;
        double d = height - top.z;
        if (options.distance == NominalDistance::kShortest) {
          // The topmost surface is no farther than this: what is farther need not be searched.
          const double most = std::abs(d) * (1.0 + 1e-9) + 1e-9 * (1.0 + std::abs(height)) + slackOn(grid);
          const auto nearest = nominal.distanceTo(motion.movedBack({x, y, height}), most);
          d = nearest ? outside * *nearest : d;
        }
        d /= unit;
        sums.add(d, options.tolerance);
        here = static_cast<float>(d);
      }
    builder->writeHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
  });
  if (job.cancelled()) return cancelled();
  DeviationSums all;
  for (const DeviationSums& sums : parts) all.add(sums);
  result.field = std::move(*builder).build();
  result.samples = all.samples;
  result.no_nominal = all.no_nominal;
  result.unmeasured = all.unmeasured;
  result.within = all.within;
  result.above = all.above;
  result.below = all.below;
  result.face_down = all.face_down;
  if (all.samples == 0) return result;
  const auto n = static_cast<double>(all.samples);
  result.mean = all.sum.value() / n;
  result.rms = std::sqrt(all.square.value() / n);
  result.min = all.min;
  result.max = all.max;
  result.max_abs = std::max(std::abs(all.min), std::abs(all.max));
  const FieldReader deviation = result.field.reader();
  job.begin("sorting deviations", kSelectPasses * tileCount(deviation));
  // Nearest rank ceil(0.99 n), in integers.
  result.p99 = selectFromTiles(
                   deviation, job, [](std::int64_t count) { return (99 * count + 99) / 100 - 1; },
                   [&](const SampleRect& rect, auto&& take) {
                     float d[kTileSamples];
                     deviation.readHeights(rect.column, rect.row, rect.columns, rect.rows, d, kTileSide);
                     for (std::int32_t r = 0; r < rect.rows; ++r)
                       for (std::int32_t c = 0; c < rect.columns; ++c)
                         take(std::abs(double{d[r * kTileSide + c]}));
                   })
                   .value;
  if (job.cancelled()) return cancelled();
  return result;
} catch (const std::bad_alloc&) {
  return failure("memory is exhausted", "the deviation", "measure a smaller part");
}

std::optional<PlacedNominal> placedAsStored(const NominalMesh& nominal, const Grid& part) noexcept {
  const glm::dvec3 size((part.width - 1) * part.spacingXMm(), (part.height - 1) * part.spacingYMm(), 0.0);
  const glm::dvec3 world(part.origin_x * part.lateral_unit.mm, part.origin_y * part.lateral_unit.mm, 0.0);
  const double slack = slackOn(part);
  for (const NominalPlace place : {NominalPlace::kWorld, NominalPlace::kFromCorner}) {
    PlacedNominal placed;
    placed.place = place;
    placed.motion.shift = place == NominalPlace::kWorld ? nominal.corner() - world : nominal.corner();
    const glm::dvec3 low = nominal.box().low + placed.motion.shift,
                     high = nominal.box().high + placed.motion.shift;
    if (low.x <= size.x + slack && low.y <= size.y + slack && high.x >= -slack && high.y >= -slack)
      return placed;
  }
  return std::nullopt;
}

}  // namespace fettle::engine
