#pragma once

namespace fettle::engine {

/// Kinds of processor for which kernels are compiled, each able to do what the ones before can.
enum class CpuLevel {
  kPlain,   ///< what every processor of the architecture has
  kAvx2,    ///< x86-64 with AVX2 and FMA: Haswell, 2013
  kAvx512,  ///< x86-64 with AVX-512 F, BW, DQ, VL: Skylake server, 2017
};

/// The best level that this processor has and that kernels were compiled for; no higher than the environment
/// variable FETTLE_CPU says when it is first asked for: plain, avx2 or avx512, others are ignored. Any thread.
[[nodiscard]] CpuLevel bestCpuLevel() noexcept;

}  // namespace fettle::engine
