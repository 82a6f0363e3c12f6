// Explicit vectors, so that branches become arithmetic: in rough surfaces the plain way's cannot be foretold.
// Four doubles abreast; eight with AVX-512 measured a tenth slower.

#include "haptic/contact/touch_lanes.h"

#include <cmath>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace fettle::haptic {

namespace {

// Explicit vectors are cut to the machine's before functions are cloned for machines (see median_small.cpp).
// FETTLE_TOUCH_REGISTER: bits of a register whose intrinsics may be used, 0 for none.
#if defined(__SSE2__)
#define FETTLE_TOUCH_REGISTER 128
#else
#define FETTLE_TOUCH_REGISTER 0
#endif
namespace plain {
#include "haptic/contact/touch_lanes-inl.h"
}
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
#define FETTLE_TOUCH_AVX2
#pragma GCC push_options
#pragma GCC target("avx2,bmi,bmi2")
#undef FETTLE_TOUCH_REGISTER
#define FETTLE_TOUCH_REGISTER 256
namespace avx2 {
#include "haptic/contact/touch_lanes-inl.h"
}
#pragma GCC pop_options
#endif

TouchKernels chooseKernels() noexcept {
#ifdef FETTLE_TOUCH_AVX2
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2")) return avx2::kernels();
#endif
  return plain::kernels();
}

const TouchKernels kKernels = chooseKernels();

}  // namespace

const TouchKernels& touchKernels() noexcept {
  return kKernels;
}

}  // namespace fettle::haptic
