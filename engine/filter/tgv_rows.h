#pragma once

#include "engine/simd/cpu.h"

namespace fettle::engine::tgv {

/// One row of each array that a step of total generalised variation works on (tgv.cpp). Each can be read and
/// written from column -1 to the column after the last.
///
///   f        heights less a reference, in units of the noise; NaN: no height is known here
///   u, u2    the surface sought, and its value extrapolated by a step
///   x, y     slopes v along a row and along a column, x2 and y2 extrapolated by a step
///   p, q     the dual of grad u - v: along a row, along a column
///   xx, yy, xy  the dual of the symmetrised gradient of v
///   wp, wq, wv  the largest |p|, |q| and |(xx, yy, xy)|; wp is 0 where a sample or the next of its row is
///            missing, wq where it or the next of its column is
struct Row {
  float *f, *u, *u2, *x, *y, *x2, *y2, *p, *q, *xx, *yy, *xy, *wp, *wq, *wv;
};

/// Lengths of a step in the surface and in the duals.
struct StepLength {
  float primal, dual;
};

/// Moves the duals of a row by one step; `next` is the row after it.
void stepDuals(CpuLevel level, const Row& row, const Row& next, int columns, float dual) noexcept;

/// Moves surface and slopes of a row by one step; `before` is the row before it.
void stepSurface(CpuLevel level, const Row& row, const Row& before, int columns, float primal) noexcept;

/// How strongly jumps and creases are held against the surface, in units of the noise.
struct Weights {
  float jump, crease;            ///< the largest duals where the surface is smooth
  float half_jump, half_crease;  ///< the jump and the crease that halve them
};

/// A wp or wq that lets two samples jump, while their slopes are held together.
inline constexpr float kCut = 1e-18F;

/// Lowers the weights of a row where the surface jumps or is creased; `next` is the row after it. Weights
/// of kCut or less stay so.
void reweight(CpuLevel level, const Row& row, const Row& next, int columns, const Weights& weights) noexcept;

/// The sums of a window of (2 radius + 1)^2 heights around each sample that a plane through them is fitted
/// with; heights less that of the window's centre, NaN where one is missing. `rows` are the 2 radius + 1 rows of f.
struct PlaneSums {
  double *sum, *squares, *along, *across;
};
void sumWindows(CpuLevel level, const float* const* rows, int radius, int columns,
                const PlaneSums& sums) noexcept;

}  // namespace fettle::engine::tgv
