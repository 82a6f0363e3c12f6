#include "engine/measure/gaussian_filter.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <new>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "engine/base/memory.h"
#include "engine/compare/tile_sums.h"
#include "engine/field/builder.h"
#include "engine/measure/form.h"
#include "engine/measure/plane_transform.h"

namespace fettle::engine {

namespace {

// Along one direction: how far weights reach, the length of transforms, and what these make of each wave.
struct WaveAxis {
  std::int32_t length = 1;
  std::vector<double> transmission;
};

WaveAxis axisOf(std::int32_t samples, double spacing, double cut_off, JobControl& job) {
  const double width = std::sqrt(std::numbers::ln2 / std::numbers::pi) * cut_off;
  const auto weight = [&](std::int32_t k) {
    const double x = k * spacing / width;
    return std::exp(-std::numbers::pi * x * x);
  };
  // Beyond the field's other end is no sample.
  const auto reach = static_cast<std::int32_t>(std::min(std::ceil(cut_off / spacing), samples - 1.0));
  WaveAxis axis;
  axis.length = transformLength(samples + reach);
  std::vector<std::complex<double>> line(static_cast<std::size_t>(axis.length));
  line[0] = weight(0);
  for (std::int32_t k = 1; k <= reach; ++k) {
    line[static_cast<std::size_t>(k)] += weight(k);
    line[static_cast<std::size_t>(axis.length - k)] += weight(k);
  }
  transformPlane(line, axis.length, 1, Transform::kForward, job);
  axis.transmission.reserve(line.size());
  // Normalised, and what the transforms there and back multiply by: no more than a scale.
  for (const std::complex<double>& value : line)
    axis.transmission.push_back(value.real() / line[0].real() / axis.length);
  return axis;
}

}  // namespace

Result<Version> gaussianFiltered(const Version& field, double cut_off_mm, Waves waves, JobControl& job) try {
  Grid grid = field.grid();
  const double spacing = std::max(grid.spacingXMm(), grid.spacingYMm());
  if (!(cut_off_mm >= kLeastCutOff * spacing) || !std::isfinite(cut_off_mm))
    return inputError(fmt::format("a cut-off of {:.6g} mm is shorter than two samples", cut_off_mm), "filter",
                      fmt::format("take {:.6g} mm or more", kLeastCutOff * spacing));
  grid.height_per_count = 0.0;
  const FieldReader from = field.reader();
  const WaveAxis along = axisOf(grid.width, grid.spacingXMm(), cut_off_mm, job);
  const WaveAxis up = axisOf(grid.height, grid.spacingYMm(), cut_off_mm, job);
  const double bytes = 16.0 * along.length * up.length, free = static_cast<double>(availableMemory());
  if (free > 0.0 && bytes > free) throw std::bad_alloc();

  // A plane passes the filter, but for ends and holes, where the weights of one side are missing: it is taken out before.
  const auto fit = fitForm(field, {.degree = 1, .region = Region::kAll, .robust = false}, job);
  if (!fit && fit.error().kind == ErrorKind::kInput) return field;  // of holes alone
  if (!fit) return tl::unexpected(fit.error());
  const PolynomialForm& level = fit->form;
  job.begin("filtering", 2 * tileCount(from));
  // Heights about it as real parts, 1 for a sample as imaginary ones: one transform for sums and weights.
  const auto wide = static_cast<std::size_t>(along.length);
  std::vector<std::complex<double>> plane(wide * static_cast<std::size_t>(up.length));
  struct Nothing {};
  (void)forEachTile<Nothing>(from, job, [&](const SampleRect& rect, Nothing&) {
    float z[kTileSamples];
    double nominal[kTileSamples];
    from.readHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
    level.readHeights(rect, nominal, kTileSide);
    for (int r = 0; r < rect.rows; ++r)
      for (int c = 0; c < rect.columns; ++c)
        if (const float height = z[r * kTileSide + c]; !std::isnan(height))
          plane[static_cast<std::size_t>(rect.row + r) * wide + static_cast<std::size_t>(rect.column + c)] = {
              height - nominal[r * kTileSide + c], 1.0};
  });
  transformPlane(plane, along.length, up.length, Transform::kForward, job, grid.height);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, up.transmission.size()), [&](const auto& range) {
    for (std::size_t r = range.begin(); r < range.end(); ++r)
      for (std::size_t c = 0; c < wide; ++c)
        plane[r * wide + c] *= up.transmission[r] * along.transmission[c];
  });
  transformPlane(plane, along.length, up.length, Transform::kBackward, job);
  if (job.cancelled()) return cancelled();

  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), "the filtered field");
  if (!builder) return tl::unexpected(builder.error());
  (void)forEachTile<Nothing>(from, job, [&](const SampleRect& rect, Nothing&) {
    float z[kTileSamples];
    double nominal[kTileSamples];
    std::uint8_t marks[kTileSamples];
    level.readHeights(rect, nominal, kTileSide);
    from.readHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
    from.readMarks(rect.column, rect.row, rect.columns, rect.rows, marks, kTileSide);
    for (int r = 0; r < rect.rows; ++r)
      for (int c = 0; c < rect.columns; ++c) {
        float& height = z[r * kTileSide + c];
        if (std::isnan(height)) continue;
        const std::complex<double> sums =
            plane[static_cast<std::size_t>(rect.row + r) * wide + static_cast<std::size_t>(rect.column + c)];
        const double low = nominal[r * kTileSide + c] + sums.real() / sums.imag();
        height = static_cast<float>(waves == Waves::kLong ? low : height - low);
      }
    builder->writeHeights(rect.column, rect.row, rect.columns, rect.rows, z, kTileSide);
    builder->writeMarks(rect.column, rect.row, rect.columns, rect.rows, marks, kTileSide);
  });
  if (job.cancelled()) return cancelled();
  return std::move(*builder).build().withLines(field.lines());
} catch (const std::bad_alloc&) {
  return failure("memory is exhausted", "filtering", "filter a smaller field, or with a shorter cut-off");
}

}  // namespace fettle::engine
