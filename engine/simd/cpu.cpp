#include "engine/simd/cpu.h"

namespace fettle::engine {

CpuLevel bestCpuLevel() noexcept {
#ifdef FETTLE_CPU_LEVELS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    return CpuLevel::kAvx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2"))
    return CpuLevel::kAvx2;
#endif
  return CpuLevel::kPlain;
}

}  // namespace fettle::engine
