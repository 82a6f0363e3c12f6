#include "engine/filter/merge.h"

#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/filter/merge-inl.h"
#include "engine/simd/each_cpu-inl.h"

}  // namespace

TileReport mergeTile(const Tile& before, const float* results, std::ptrdiff_t stride, float sign,
                     FilterScope scope, Tile& after, CpuLevel level, const Tile* ahead) noexcept {
  const std::uint64_t flip = scope == FilterScope::kKeepMarks ? ~std::uint64_t{0} : 0;
  const TileReport report = FETTLE_AT_LEVEL(level, merge)(
      before, results, stride, sign, flip, ahead == nullptr ? nullptr : ahead->samples.data(), after);
  after.marks = before.marks;
  after.nan_samples = before.nan_samples;
  after.marked_samples = before.marked_samples;
  return report;
}

TileReport compareTiles(const Tile& before, const Tile& after, CpuLevel level) noexcept {
  return FETTLE_AT_LEVEL(level, compare)(before, after);
}

}  // namespace fettle::engine
