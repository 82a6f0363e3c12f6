#include "engine/simd/cpu.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

CpuLevel processorLevel() noexcept {
#ifdef FETTLE_CPU_LEVELS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    return CpuLevel::kAvx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
      __builtin_cpu_supports("bmi2"))
    return CpuLevel::kAvx2;
#endif
  return CpuLevel::kPlain;
}

CpuLevel allowedLevel() noexcept {
  const char* text = std::getenv("FETTLE_CPU");
  const std::string_view word = text == nullptr ? "" : text;
  return word == "plain" ? CpuLevel::kPlain : word == "avx2" ? CpuLevel::kAvx2 : CpuLevel::kAvx512;
}

}  // namespace

CpuLevel bestCpuLevel() noexcept {
  static const CpuLevel level = std::min(processorLevel(), allowedLevel());
  return level;
}

}  // namespace fettle::engine
