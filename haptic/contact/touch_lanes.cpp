// Explicit vectors, so that branches become arithmetic: in rough surfaces the plain way's cannot be foretold.
// Four doubles abreast; eight with AVX-512 measured a tenth slower.

#include "haptic/contact/touch_lanes.h"

#include <algorithm>
#include <cmath>

#include "engine/simd/kernel.h"

namespace fettle::haptic {

namespace {

#define FETTLE_KERNEL "haptic/contact/touch_lanes-inl.h"
#include "engine/simd/each_cpu-inl.h"

// Those of AVX2 with AVX-512 too: masks in registers of their own cost more than they save here.
const TouchKernels kKernels =
    FETTLE_AT_LEVEL(std::min(engine::bestCpuLevel(), engine::CpuLevel::kAvx2), kernels)();

}  // namespace

const TouchKernels& touchKernels() noexcept {
  return kKernels;
}

}  // namespace fettle::haptic
