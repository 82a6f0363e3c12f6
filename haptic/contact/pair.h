#pragma once

#if defined(__SSE2__)
#include <emmintrin.h>
#else
#include <algorithm>
#include <cmath>
#endif

namespace fettle::haptic {

/// Two doubles in one register, mostly the values for u and for v: one operation works on both, each rounded
/// as a single one would be. A vector type of GCC and Clang; p[0], p[1] are the two.
using Pair = double __attribute__((vector_size(16)));

[[nodiscard]] inline Pair swapped(Pair p) noexcept {
  return Pair{p[1], p[0]};
}

/// Result of comparing two pairs, lane by lane; comparisons with NaN are false. Intrinsics, because GCC 12
/// compiles the comparison operators of vectors through two general registers.
#if defined(__SSE2__)
using PairMask = __m128d;
[[nodiscard]] inline PairMask equal(Pair a, Pair b) noexcept {
  return _mm_cmpeq_pd(a, b);
}
[[nodiscard]] inline PairMask less(Pair a, Pair b) noexcept {
  return _mm_cmplt_pd(a, b);
}
[[nodiscard]] inline PairMask atMost(Pair a, Pair b) noexcept {
  return _mm_cmple_pd(a, b);
}
[[nodiscard]] inline PairMask both(PairMask a, PairMask b) noexcept {
  return _mm_and_pd(a, b);
}
[[nodiscard]] inline PairMask either(PairMask a, PairMask b) noexcept {
  return _mm_or_pd(a, b);
}
/// Lane by lane a where the mask is true, else b.
[[nodiscard]] inline Pair chosen(PairMask mask, Pair a, Pair b) noexcept {
  return _mm_or_pd(_mm_and_pd(mask, a), _mm_andnot_pd(mask, b));
}
/// std::min(b, a) and std::max(b, a) in both lanes; b where one is NaN.
[[nodiscard]] inline Pair smaller(Pair a, Pair b) noexcept {
  return _mm_min_pd(a, b);
}
[[nodiscard]] inline Pair larger(Pair a, Pair b) noexcept {
  return _mm_max_pd(a, b);
}
/// a where the mask is false, else 0.
[[nodiscard]] inline Pair butNot(Pair a, PairMask mask) noexcept {
  return _mm_andnot_pd(mask, a);
}
/// std::clamp(x, 0.0, 1.0) in both lanes, NaN and -0 included, and no branch.
[[nodiscard]] inline Pair unit(Pair x) noexcept {
  return _mm_min_pd(_mm_set1_pd(1.0), _mm_max_pd(_mm_setzero_pd(), x));
}
[[nodiscard]] inline Pair absolute(Pair x) noexcept {
  return _mm_andnot_pd(_mm_set1_pd(-0.0), x);
}
/// True in the first lane only.
[[nodiscard]] inline PairMask firstLane() noexcept {
  return _mm_castsi128_pd(_mm_set_epi64x(0, -1));
}
[[nodiscard]] inline PairMask secondLane() noexcept {
  return _mm_castsi128_pd(_mm_set_epi64x(-1, 0));
}
/// Bit 0: first lane true, bit 1: second lane true.
[[nodiscard]] inline int lanes(PairMask mask) noexcept {
  return _mm_movemask_pd(mask);
}
#else
using PairMask = int;  // as lanes() returns it
[[nodiscard]] inline PairMask equal(Pair a, Pair b) noexcept {
  return (a[0] == b[0] ? 1 : 0) | (a[1] == b[1] ? 2 : 0);
}
[[nodiscard]] inline PairMask less(Pair a, Pair b) noexcept {
  return (a[0] < b[0] ? 1 : 0) | (a[1] < b[1] ? 2 : 0);
}
[[nodiscard]] inline PairMask atMost(Pair a, Pair b) noexcept {
  return (a[0] <= b[0] ? 1 : 0) | (a[1] <= b[1] ? 2 : 0);
}
[[nodiscard]] inline PairMask both(PairMask a, PairMask b) noexcept {
  return a & b;
}
[[nodiscard]] inline PairMask either(PairMask a, PairMask b) noexcept {
  return a | b;
}
[[nodiscard]] inline Pair chosen(PairMask mask, Pair a, Pair b) noexcept {
  return Pair{(mask & 1) != 0 ? a[0] : b[0], (mask & 2) != 0 ? a[1] : b[1]};
}
[[nodiscard]] inline Pair smaller(Pair a, Pair b) noexcept {
  return Pair{std::min(b[0], a[0]), std::min(b[1], a[1])};
}
[[nodiscard]] inline Pair larger(Pair a, Pair b) noexcept {
  return Pair{std::max(b[0], a[0]), std::max(b[1], a[1])};
}
[[nodiscard]] inline Pair butNot(Pair a, PairMask mask) noexcept {
  return chosen(mask, Pair{0.0, 0.0}, a);
}
[[nodiscard]] inline Pair unit(Pair x) noexcept {
  return Pair{std::clamp(x[0], 0.0, 1.0), std::clamp(x[1], 0.0, 1.0)};
}
[[nodiscard]] inline Pair absolute(Pair x) noexcept {
  return Pair{std::abs(x[0]), std::abs(x[1])};
}
[[nodiscard]] inline PairMask firstLane() noexcept {
  return 1;
}
[[nodiscard]] inline PairMask secondLane() noexcept {
  return 2;
}
[[nodiscard]] inline int lanes(PairMask mask) noexcept {
  return mask;
}
#endif

}  // namespace fettle::haptic
