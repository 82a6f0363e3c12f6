#pragma once

#include <cstddef>
#include <cstdint>

namespace fettle::engine {

/// How to add up many floats exactly in plain doubles.
///
/// A double holds any integer to 2^53. If all samples are multiples of one step 2^s and no partial sum passes
/// 2^(53 + s), every addition and subtraction is exact, in any order. Where the samples' range is too wide
/// for that, each is cut into lanes, the upper bits and the rest, and each lane is summed exactly by itself:
/// kMaxLanes lanes hold every float there is, from the smallest denormal up, a million times over. The
/// cutting adds and subtracts a large constant, which rounds to its last bit (T. J. Dekker, A floating-point
/// technique for extending the available precision, 1971; for sums: S. M. Rump, T. Ogita, S. Oishi, Accurate
/// floating-point summation, part I, 2008, section 3).
///
/// Exact sums are what makes running sums usable: adding a sample and taking it away again leaves nothing.
struct SumLanes {
  static constexpr int kMaxLanes = 9;

  int lanes = 1;
  /// Lane l takes (rest + cut[l]) - cut[l] of what the lanes above left; the last takes what is left.
  double cut[kMaxLanes] = {};
};

/// How samples of no magnitude above `magnitude` are cut so that sums of up to `count` (1 .. 2^20) of them, and the difference of
/// two such sums, are exact in each lane but the last one; `lanes` is 1.
[[nodiscard]] SumLanes cutsFor(float magnitude, std::int64_t count) noexcept;

/// Whether the last of 1 or 2 lanes holds all that the ones above leave of these samples; NaN is left out.
[[nodiscard]] bool lanesHold(const SumLanes& cuts, int lanes, const float* samples, int n) noexcept;

/// The lanes in which sums of up to `count` (1 .. 2^20) of the given samples, and the difference of two such
/// sums, are exact. rows x columns, row-major, stride in elements; NaN is left out, no infinity; no magnitude
/// is above `magnitude`. `lanes` comes out as 1, 2 or kMaxLanes.
[[nodiscard]] SumLanes chooseLanes(const float* heights, std::ptrdiff_t stride, int columns, int rows,
                                   float magnitude, std::int64_t count) noexcept;

/// The double nearest to the exact sum of the lanes, ties to even: the same for the same exact sum, however
/// it is spread over lanes. No intermediate overflow as long as the lanes come from floats.
[[nodiscard]] double roundedSum(const double* lanes, int count, std::ptrdiff_t stride) noexcept;

}  // namespace fettle::engine
