#pragma once

#include <cstring>

#include "engine/simd/cpu.h"

// How a function is compiled once for each CpuLevel and chosen at run time, for GCC and clang.
//
// The function lies in a "-inl.h" file without a guard and without includes. Its source includes this header
// and, within an anonymous namespace,
//
//    #define FETTLE_KERNEL "engine/filter/box-inl.h"
//    #include "engine/simd/each_cpu-inl.h"
//
// which includes the file once for each level, in the namespaces plain, avx2 and avx512, with the vectors of
// vectors-inl.h and FETTLE_LEVEL (0, 1, 2) defined. FETTLE_AT_LEVEL(level, name) is the function of a level.
// Such a source is compiled APART.
//
// All levels and both compilers give the same bits: the order of operations is fixed by the source, and
// contraction to fused multiply-adds is off. Why not target_clones or Highway:
// docs/decisions/kernels-for-each-processor.md.

#if defined(__GNUC__) && defined(__x86_64__)
#include <immintrin.h>
#define FETTLE_CPU_LEVELS
#define FETTLE_AT_LEVEL(level, ...)                                     \
  ((level) == ::fettle::engine::CpuLevel::kAvx512 ? avx512::__VA_ARGS__ \
   : (level) == ::fettle::engine::CpuLevel::kAvx2 ? avx2::__VA_ARGS__   \
                                                  : plain::__VA_ARGS__)
#else
// Both the same, so that a function template among them has a context to be resolved in.
#define FETTLE_AT_LEVEL(level, ...) \
  ((level) == ::fettle::engine::CpuLevel::kPlain ? plain::__VA_ARGS__ : plain::__VA_ARGS__)
#endif

/// For what a kernel calls: a call that is not inlined could leave for another level's version.
#define FETTLE_INLINE inline __attribute__((always_inline))
