#pragma once

namespace fettle::engine {

/// Kinds of processor for which kernels are compiled, each able to do what the ones before can.
enum class CpuLevel {
  kPlain,   ///< what every processor of the architecture has
  kAvx2,    ///< x86-64 with AVX2 and FMA: Haswell, 2013
  kAvx512,  ///< x86-64 with AVX-512 F, BW, DQ, VL: Skylake server, 2017
};

/// The best level that this processor has and that kernels were compiled for.
[[nodiscard]] CpuLevel bestCpuLevel() noexcept;

// A kernel lies in a "-inl.h" file without a guard and without includes, which its .cpp includes by way of
// each_cpu-inl.h once for each level, in the namespaces plain, avx2 and avx512. Explicit vectors are cut to
// the machine's before functions are cloned for machines, so target_clones would come too late for them. All
// levels give the same bits. GCC only; elsewhere there is just the plain level.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
#define FETTLE_CPU_LEVELS
/// The kernel `name` of the level that `level` is.
#define FETTLE_AT_LEVEL(level, name)                             \
  ((level) == ::fettle::engine::CpuLevel::kAvx512 ? avx512::name \
   : (level) == ::fettle::engine::CpuLevel::kAvx2 ? avx2::name   \
                                                  : plain::name)
#else
#define FETTLE_AT_LEVEL(level, name) ((void)(level), plain::name)
#endif

}  // namespace fettle::engine
