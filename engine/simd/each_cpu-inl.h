// Includes the file named by FETTLE_KERNEL once for each CpuLevel: see cpu.h. No include guard: every kernel
// does it. The includer has included <cstring>, and <immintrin.h> where FETTLE_CPU_LEVELS is defined.

// All that takes or returns a vector is inlined: there is no call whose convention could differ.
// To the end of the file, because that is where the compiler speaks of it.
#pragma GCC diagnostic ignored "-Wpsabi"
#ifdef FETTLE_CPU_LEVELS
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
#pragma GCC push_options
#pragma GCC target("avx2,fma,bmi2,popcnt")
namespace avx2 {
#include "engine/simd/vectors-inl.h"
#include FETTLE_KERNEL
}  // namespace avx2
#pragma GCC pop_options
#undef FETTLE_LEVEL
#define FETTLE_LEVEL 2
#pragma GCC push_options
// The widest vectors though the compiler thinks half as wide ones the better bargain for everyday code.
#pragma GCC target("avx512f,avx512bw,avx512dq,avx512vl,fma,bmi2,popcnt,prefer-vector-width=512")
namespace avx512 {
#include "engine/simd/vectors-inl.h"
#include FETTLE_KERNEL
}  // namespace avx512
#pragma GCC pop_options
#endif
#undef FETTLE_LEVEL
#undef FETTLE_KERNEL
