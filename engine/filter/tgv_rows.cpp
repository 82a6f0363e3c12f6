#include "engine/filter/tgv_rows.h"

#include <algorithm>
#include <cmath>

#include "engine/simd/kernel.h"

namespace fettle::engine::tgv {

namespace {

#define FETTLE_KERNEL "engine/filter/tgv_rows-inl.h"
#include "engine/simd/each_cpu-inl.h"

}  // namespace

void stepDuals(CpuLevel level, const Row& row, const Row& next, int columns, float dual) noexcept {
  FETTLE_AT_LEVEL(level, duals)
  (columns, dual, row.u2, next.u2, row.x2, next.x2, row.y2, next.y2, row.wp, row.wq, row.wv, row.p, row.q,
   row.xx, row.yy, row.xy);
}

void stepSurface(CpuLevel level, const Row& row, const Row& before, int columns, float primal) noexcept {
  FETTLE_AT_LEVEL(level, surface)
  (columns, primal, row.f, row.p, row.q, before.q, row.xx, row.yy, before.yy, row.xy, before.xy, row.u,
   row.u2, row.x, row.y, row.x2, row.y2);
}

void reweight(CpuLevel level, const Row& row, const Row& next, int columns, const Weights& weights) noexcept {
  FETTLE_AT_LEVEL(level, lower)
  (columns, weights, row.u, next.u, row.x, next.x, row.y, next.y, row.wp, row.wq, row.wv);
}

void sumWindows(CpuLevel level, const float* const* rows, int radius, int columns,
                const PlaneSums& sums) noexcept {
  for (double* values : {sums.sum, sums.squares, sums.along, sums.across}) std::fill_n(values, columns, 0.0);
  for (int dy = -radius; dy <= radius; ++dy) FETTLE_AT_LEVEL(level, addRow)
  (columns, radius, dy, rows[dy + radius], rows[radius], sums.sum, sums.squares, sums.along, sums.across);
}

}  // namespace fettle::engine::tgv
