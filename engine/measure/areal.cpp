#include "engine/measure/areal.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "engine/base/memory.h"
#include "engine/compare/tile_sums.h"
#include "engine/measure/surface.h"

namespace fettle::engine {

namespace {

constexpr int kHaloSide = kTileSide + 1;
// Half one for each of the two heights that Sz lies between, and as much for what filtered them.
constexpr double kMostRoundings = 2.0;

// The region's samples of a rectangle less the form; NaN elsewhere. Returns the size of the largest height before.
float readResiduals(const FieldReader& field, const NominalForm& form, Region region, const SampleRect& rect,
                    double* out) noexcept {
  float z[kHaloSide * kHaloSide], most = 0.0F;
  readRegion(field, region, rect, z, kHaloSide);
  form.readHeights(rect, out, kHaloSide);
  for (int r = 0; r < rect.rows; ++r)
    for (int i = r * kHaloSide; i < r * kHaloSide + rect.columns; ++i) {
      out[i] = z[i] - out[i];
      most = std::fmax(most, std::abs(z[i]));
    }
  return most;
}

// The distance of floats of this size.
double roundingAt(float height) noexcept {
  return double{std::nextafter(height, std::numeric_limits<float>::infinity())} - height;
}

// All figures without a value, for one reason.
void leaveOut(ArealParameters& result, const ArealOptions& options, const std::string& why) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  result.sq = result.ssk = result.sku = result.sp = result.sv = result.sz = result.sa = kNone;
  result.sdq = result.sdr = kNone;
  result.ratio = {kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
  result.ratios.assign(options.at_heights.size(), kNone);
  result.heights.assign(options.at_ratios.size(), kNone);
  result.material.assign(options.at_volumes.size(), kNone);
  result.voids = result.material;
  result.differences.assign(options.between.size(), kNone);
  SpatialParameters& spatial = result.spatial;
  spatial.sal = spatial.str = spatial.lay = spatial.ssw = spatial.sal_direction = spatial.slow_direction =
      kNone;
  spatial.no_sal = spatial.no_str = spatial.no_lay = spatial.no_ssw = why;
  result.feature = withoutFeatures(why);
  const auto note = [&](bool wanted, std::initializer_list<const char*> keys) {
    if (!wanted) return;
    for (const char* const key : keys) result.not_stated.push_back({key, why});
  };
  note(true, {"sq", "ssk", "sku", "sp", "sv", "sz", "sa"});
  note(options.spatial, {"sal", "str", "std", "ssw"});
  note(options.hybrid, {"sdq", "sdr"});
  note(options.functional, {"sk", "spk", "svk", "smrk1", "smrk2", "vmp", "vmc", "vvc", "vvv", "sxp"});
  if (options.feature)
    result.not_stated.insert(result.not_stated.end(), result.feature.not_stated.begin(),
                             result.feature.not_stated.end());
}

struct MeanPart {
  std::int64_t samples = 0;
  CompensatedSum sum;
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  float most = 0.0F;  // size of a height with its form
};

struct PowerPart {
  CompensatedSum absolute, second, third, fourth;

  void add(double z) noexcept {
    const double square = z * z;
    absolute.add(std::abs(z));
    second.add(square);
    third.add(square * z);
    fourth.add(square * square);
  }
  void add(const PowerPart& other) noexcept {
    absolute.add(other.absolute);
    second.add(other.second);
    third.add(other.third);
    fourth.add(other.fourth);
  }
};

// Of a cell with corners a b (lower row) and c d, sides of sx and sy, heights and sides in millimetres.
struct Cell {
  double a, b, c, d, sx, sy;

  // Mean square of the gradient: along a side the slope is linear in the other direction.
  [[nodiscard]] double gradientSquare() const noexcept {
    const double lower = (b - a) / sx, upper = (d - c) / sx;
    const double left = (c - a) / sy, right = (d - b) / sy;
    return (lower * lower + lower * upper + upper * upper + left * left + left * right + right * right) / 3.0;
  }
  // Area over that of its projection, less 1, without cancellation where it is nearly flat.
  [[nodiscard]] double areaExcess() const noexcept {
    constexpr double kPlaces[] = {0.1127016653792583, 0.5, 0.8872983346207417};  // (1 -+ sqrt(0.6)) / 2
    constexpr double kWeights[] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
    const double lower = (b - a) / sx, upper = (d - c) / sx;
    const double left = (c - a) / sy, right = (d - b) / sy;
    double sum = 0.0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double gx = lower + kPlaces[i] * (upper - lower), gy = left + kPlaces[j] * (right - left);
        const double square = gx * gx + gy * gy;
        sum += kWeights[i] * kWeights[j] * square / (1.0 + std::sqrt(1.0 + square));
      }
    return sum;
  }
};

struct SlopePart {
  std::int64_t cells = 0;
  CompensatedSum gradient, excess;
};

SlopePart slopesOf(const FieldReader& field, const NominalForm& form, Region region, JobControl& job) {
  const Grid& grid = field.grid();
  const double mm = grid.height_unit.mm, sx = grid.spacingXMm(), sy = grid.spacingYMm();
  job.begin("measuring slopes", tileCount(field));
  const auto parts = forEachTile<SlopePart>(field, job, [&](SampleRect rect, SlopePart& part) {
    rect.columns = std::min(kHaloSide, field.width() - rect.column);
    rect.rows = std::min(kHaloSide, field.height() - rect.row);
    double z[kHaloSide * kHaloSide];
    readResiduals(field, form, region, rect, z);
    for (int r = 0; r + 1 < rect.rows; ++r)
      for (int c = 0; c + 1 < rect.columns; ++c) {
        const double* const low = z + r * kHaloSide + c;
        const double* const up = low + kHaloSide;
        const Cell cell{mm * low[0], mm * low[1], mm * up[0], mm * up[1], sx, sy};
        const double gradient = cell.gradientSquare();
        if (std::isnan(gradient)) continue;
        ++part.cells;
        part.gradient.add(gradient);
        part.excess.add(cell.areaExcess());
      }
  });
  SlopePart all;
  for (const SlopePart& part : parts) {
    all.cells += part.cells;
    all.gradient.add(part.gradient);
    all.excess.add(part.excess);
  }
  return all;
}

// Its parameters without a value where memory for it is not free.
Result<SpatialAnalysis> spatialOf(const Surface& surface, const ArealOptions& options, JobControl& job) {
  constexpr double kGibi = 1024.0 * 1024.0 * 1024.0;
  const double wanted = correlationBytes(surface),
               free = static_cast<double>(options.free_memory ? *options.free_memory : availableMemory());
  if (free > 0.0 && wanted > 0.8 * free) {
    SpatialAnalysis nothing;
    SpatialParameters& none = nothing.parameters;
    none.sal = none.str = none.lay = none.ssw = none.sal_direction = none.slow_direction = std::nan("");
    none.no_sal = none.no_str = none.no_lay = none.no_ssw =
        fmt::format("it takes {:.1f} GiB of memory, of which {:.1f} are free: measure a smaller region",
                    wanted / kGibi, free / kGibi);
    return nothing;
  }
  return correlate(surface, job);
}

}  // namespace

Result<ArealParameters> measureAreal(const Version& field, const NominalForm& form,
                                     const ArealOptions& options, JobControl& job) try {
  const FieldReader reader = field.reader();
  const Region region = options.region;
  const auto forEachHeight = [&](const SampleRect& rect, auto&& take) {
    double z[kHaloSide * kHaloSide];
    const float most = readResiduals(reader, form, region, rect, z);
    for (int r = 0; r < rect.rows; ++r)
      for (int i = r * kHaloSide; i < r * kHaloSide + rect.columns; ++i)
        if (!std::isnan(z[i])) take(z[i]);
    return most;
  };

  job.begin("measuring heights", 3 * tileCount(reader));
  const auto means = forEachTile<MeanPart>(reader, job, [&](const SampleRect& rect, MeanPart& part) {
    part.most = forEachHeight(rect, [&](double z) {
      ++part.samples;
      part.sum.add(z);
      part.low = std::min(part.low, z);
      part.high = std::max(part.high, z);
    });
  });
  if (job.cancelled()) return cancelled();
  MeanPart all;
  std::vector<std::int64_t> first;  // sample of each tile among all
  first.reserve(means.size());
  for (const MeanPart& part : means) {
    first.push_back(all.samples);
    all.samples += part.samples;
    all.sum.add(part.sum);
    all.low = std::min(all.low, part.low);
    all.high = std::max(all.high, part.high);
    all.most = std::max(all.most, part.most);
  }
  if (all.samples == 0) return nothingIn(region, "");
  const auto n = static_cast<double>(all.samples);
  ArealParameters result;
  result.samples = all.samples;
  result.mean = all.sum.value() / n;
  result.sp = all.high - result.mean;
  result.sv = result.mean - all.low;
  result.sz = all.high - all.low;
  if (all.samples <= std::max(options.fitted, 1)) {
    leaveOut(result, options,
             all.samples == 1 ? "one sample has no height about its mean"
                              : fmt::format("the form goes through all {} samples", all.samples));
    return result;
  }
  if (result.sz > 0.0 && result.sz <= kMostRoundings * roundingAt(all.most)) {
    leaveOut(result, options, "what is left is no more than the rounding of the heights");
    return result;
  }

  const auto powers = forEachTile<PowerPart>(reader, job, [&](const SampleRect& rect, PowerPart& part) {
    forEachHeight(rect, [&](double z) { part.add(z - result.mean); });
  });
  if (job.cancelled()) return cancelled();
  PowerPart power;
  for (const PowerPart& part : powers) power.add(part);
  const double variance = power.second.value() / n;
  result.sq = std::sqrt(variance);
  result.sa = power.absolute.value() / n;
  result.ssk = variance > 0.0 ? power.third.value() / n / (variance * result.sq) : std::nan("");
  result.sku = variance > 0.0 ? power.fourth.value() / n / (variance * variance) : std::nan("");
  if (!(variance > 0.0))
    for (const char* const key : {"ssk", "sku"}) result.not_stated.push_back({key, "the surface is flat"});

  if (options.functional) {
    std::vector<float> heights(static_cast<std::size_t>(all.samples));
    tbb::parallel_for(std::size_t{0}, first.size(), [&](std::size_t tile) {
      if (job.cancelled()) return;
      float* out = heights.data() + first[tile];
      forEachHeight(tileRect(reader, static_cast<std::int64_t>(tile)),
                    [&](double z) { *out++ = static_cast<float>(z - result.mean); });
      job.advance();
    });
    if (job.cancelled()) return cancelled();
    tbb::parallel_sort(heights.begin(), heights.end());
    if (job.cancelled()) return cancelled();
    result.ratio = materialRatio(heights, options.volumes);
    if (std::isnan(result.ratio.smrk1))
      for (const char* const key : {"smrk1", "smrk2"})
        result.not_stated.push_back({key, variance > 0.0
                                              ? "two fifths of the heights are one: the core has none"
                                              : "the surface is flat"});
    for (const double height : options.at_heights) result.ratios.push_back(ratioAtHeight(heights, height));
    for (const double ratio : options.at_ratios) result.heights.push_back(heightAtRatio(heights, ratio));
    for (const double ratio : options.at_volumes) {
      result.material.push_back(materialVolume(heights, ratio));
      result.voids.push_back(voidVolume(heights, ratio));
    }
    for (const RatioPair& pair : options.between)
      result.differences.push_back(heightAtRatio(heights, pair.first) - heightAtRatio(heights, pair.second));
  }

  if (options.hybrid) {
    const SlopePart slopes = slopesOf(reader, form, region, job);
    if (job.cancelled()) return cancelled();
    result.cells = slopes.cells;
    const auto cells = static_cast<double>(slopes.cells);
    result.sdq = slopes.cells > 0 ? std::sqrt(slopes.gradient.value() / cells) : std::nan("");
    result.sdr = slopes.cells > 0 ? slopes.excess.value() / cells : std::nan("");
    if (slopes.cells == 0)
      for (const char* const key : {"sdq", "sdr"})
        result.not_stated.push_back({key, "no four samples next to each other"});
  }
  if (!options.spatial && !options.feature) return result;

  const auto surface = surfaceOf(field, form, result.mean, region, job);
  if (!surface) return tl::unexpected(surface.error());
  const auto note = [&](const char* key, const std::string& why) {
    if (!why.empty()) result.not_stated.push_back({key, why});
  };
  if (options.spatial) {
    auto spatial = spatialOf(*surface, options, job);
    if (!spatial) return tl::unexpected(spatial.error());
    result.spatial = spatial->parameters;
    if (options.analysis && !spatial->correlation.values.empty())
      result.analysis = std::make_shared<const SpatialAnalysis>(*std::move(spatial));
    note("sal", result.spatial.no_sal);
    note("str", result.spatial.no_str);
    note("std", result.spatial.no_lay);
    note("ssw", result.spatial.no_ssw);
  }
  if (options.feature) {
    auto feature = measureFeatures(*surface, result.sz, options.prune, job);
    if (!feature) return tl::unexpected(feature.error());
    result.feature = *std::move(feature);
    for (const auto& [parameter, reason] : result.feature.not_stated) note(parameter.c_str(), reason);
  }
  return result;
} catch (const std::bad_alloc&) {
  return failure("memory is exhausted", "measuring", "measure a smaller field or region");
}

}  // namespace fettle::engine
