#include "engine/filter/coarse_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <utility>

#include "engine/field/between_means.h"
#include "engine/field/means.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/limit_change.h"
#include "engine/filter/merge.h"

namespace fettle::engine {

std::optional<FilterSpec> coarseSpec(const FilterSpec& spec, std::int32_t step, std::int32_t counted,
                                     double spacing_mm) noexcept {
  const Filter& filter = filterOf(spec.kind);
  FilterSpec coarse = spec;
  coarse.threads = 0;
  if (filter.range_sigma.exists())
    coarse.range_sigma =
        std::max(spec.range_sigma / std::sqrt(static_cast<double>(counted)), FilterSpec::kLeastRange);
  if (filter.nesting.exists() && spec.nesting_mm < filter.least_nesting * spacing_mm) return std::nullopt;
  if (!filter.window.exists() || step == 1) return coarse;
  const int half = spec.window / 2;
  const auto cells = static_cast<int>(std::lround(static_cast<double>(half) / step));
  coarse.window = 2 * cells + 1;
  coarse.sigma = spec.sigma / step;
  if (cells >= 1) return coarse;
  // As wide by fewer passes of the smallest window.
  const double variance = half * (half + 1.0) / (2.0 * step * step);
  coarse.passes = static_cast<int>(std::lround(spec.passes * variance));
  coarse.window = 3;
  coarse.sigma = 0.0;
  if (coarse.passes < 1) return std::nullopt;
  return coarse;
}

Result<CoarseFilter> CoarseFilter::make(const Version& input, const Version& original, const FilterSpec& spec,
                                        const SampleRect& rect, std::int32_t step, JobControl& job) try {
  Version means = meansOf(input, rect, step);
  if (job.cancelled()) return cancelled();
  const Grid grid = means.grid();
  if (const auto coarse =
          coarseSpec(spec, step, samplesOfMean(step), std::max(grid.spacingXMm(), grid.spacingYMm()))) {
    // The original is only read where the change is measured against it.
    const bool other = spec.max_change && !(original == input);
    auto filtered = applyFilter(means, other ? meansOf(original, rect, step) : means, *coarse, job);
    if (!filtered) return tl::unexpected(filtered.error());
    means = std::move(filtered->field);
  }
  CoarseFilter made;
  made.rect_ = rect;
  made.step_ = step;
  made.columns_ = grid.width;
  made.rows_ = grid.height;
  made.heights_.resize(static_cast<std::size_t>(grid.samples()));
  means.reader().readHeights(0, 0, grid.width, grid.height, made.heights_.data(), grid.width);
  made.means_ = std::move(means);
  return made;
} catch (const std::bad_alloc&) {
  return failure("memory for filtering could not be had", "filter");
}

float CoarseFilter::heightAt(std::int32_t column, std::int32_t row) const noexcept {
  const BetweenMeans x = betweenMeans(column - rect_.column, step_, columns_);
  const BetweenMeans y = betweenMeans(row - rect_.row, step_, rows_);
  const auto across = [&](const float* z) { return heightBetween(z[x.cell], z[x.next], x.share); };
  return heightBetween(across(rowOfCells(y.cell)), across(rowOfCells(y.next)), y.share);
}

TileRef CoarseFilter::tile(const Version& input, const Version& original, const FilterSpec& spec,
                           std::int32_t tc, std::int32_t tr) const {
  const FieldReader reader = input.reader();
  const Tile& before = reader.tile(tc, tr);
  TileRef after = TileRef::adopt(input.memory()->bulk().acquire());
  if (!after) return after;
  std::array<BetweenMeans, kTileSide> across;
  for (std::int32_t c = 0; c < kTileSide; ++c)
    across[static_cast<std::size_t>(c)] = betweenMeans(tc * kTileSide + c - rect_.column, step_, columns_);
  using Row = std::array<float, kTileSide>;
  // Two rows of cells, spread out over the samples of the tile.
  std::array<Row, 2> spread{};
  std::array<std::int32_t, 2> spread_of{-1, -1};
  const auto rowOf = [&](std::int32_t cell) -> const Row& {
    const auto slot = static_cast<std::size_t>(cell & 1);
    if (spread_of[slot] != cell) {
      spread_of[slot] = cell;
      const float* const z = rowOfCells(cell);
      for (std::size_t c = 0; c < kTileSide; ++c)
        spread[slot][c] = heightBetween(z[across[c].cell], z[across[c].next], across[c].share);
    }
    return spread[slot];
  };
  alignas(64) std::array<float, kTileSamples> results;
  const float sign = reader.sign();
  for (std::int32_t r = 0; r < kTileSide; ++r) {
    const BetweenMeans y = betweenMeans(tr * kTileSide + r - rect_.row, step_, rows_);
    const Row& low = rowOf(y.cell);
    const Row& high = rowOf(y.next);
    const float* const old = before.samples.data() + r * kTileSide;
    float* const out = results.data() + r * kTileSide;
    for (std::size_t c = 0; c < kTileSide; ++c) {
      const float z = heightBetween(low[c], high[c], y.share);
      // As stored, without the sign; a cell of holes alone says nothing of a sample in a row that was not read.
      out[c] = z != z ? old[c] : sign * z;
    }
  }
  if (spec.max_change) {
    const float* const origin = original.reader().tile(tc, tr).samples.data();
    for (std::size_t i = 0; i < kTileSamples; ++i)
      if (before.samples[i] == before.samples[i])
        results[i] = limitedChange(results[i], origin[i], *spec.max_change);
  }
  (void)mergeTile(before, results.data(), kTileSide, 1.0F, spec.scope, *after, bestCpuLevel());
  return after;
}

}  // namespace fettle::engine
