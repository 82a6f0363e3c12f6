// Includes the file named by FETTLE_KERNEL once for each CpuLevel: see kernel.h. No include guard: every kernel
// does it.

// All that takes or returns a vector is inlined: there is no call whose convention could differ.
// To the end of the file, because that is where the compiler speaks of it.
#pragma GCC diagnostic ignored "-Wpsabi"
#if defined(FETTLE_CPU_LEVELS) && !defined(__clang__)
// GCC 12 takes the undefined lanes inside its own intrinsics for the caller's variables.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#endif
// FETTLE_LEVEL is the level within a kernel: GCC 12 reads the whole file before it heeds a pragma, so that
// __AVX512F__ and the like are never defined there.
#define FETTLE_LEVEL 0
namespace plain {
#include "engine/simd/vectors-inl.h"
#include FETTLE_KERNEL
}  // namespace plain
#ifdef FETTLE_CPU_LEVELS
#undef FETTLE_LEVEL
#define FETTLE_LEVEL 1
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,fma,bmi,bmi2,popcnt"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,bmi,bmi2,popcnt")
#endif
namespace avx2 {
#include "engine/simd/vectors-inl.h"
#include FETTLE_KERNEL
}  // namespace avx2
#undef FETTLE_LEVEL
#define FETTLE_LEVEL 2
#ifdef __clang__
#pragma clang attribute pop
// clang-format off
#pragma clang attribute push(__attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,fma,bmi,bmi2,popcnt"))), apply_to = function)
// clang-format on
#else
#pragma GCC pop_options
#pragma GCC push_options
// The widest vectors though the compiler thinks half as wide ones the better bargain for everyday code.
#pragma GCC target("avx512f,avx512bw,avx512dq,avx512vl,fma,bmi,bmi2,popcnt,prefer-vector-width=512")
#endif
namespace avx512 {
#include "engine/simd/vectors-inl.h"
#include FETTLE_KERNEL
}  // namespace avx512
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif
#undef FETTLE_LEVEL
#undef FETTLE_KERNEL
