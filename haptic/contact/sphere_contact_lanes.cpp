// Explicit vectors, so that branches become arithmetic: on rough surfaces the branches of the scalar code
// cannot be predicted. Four doubles per vector; eight with AVX-512 measured a tenth slower.

#include "haptic/contact/sphere_contact_lanes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "engine/simd/kernel.h"

namespace fettle::haptic {

namespace {

// k / kTwistPieces, and beyond 1 for the lanes of the last.
constexpr auto kPieceEnds = [] {
  std::array<double, kTwistPieces + kSphereContactLanes> ends{};
  for (int k = 0; k < kTwistPieces + kSphereContactLanes; ++k)
    ends[static_cast<std::size_t>(k)] = static_cast<double>(k) / kTwistPieces;
  return ends;
}();

#define FETTLE_KERNEL "haptic/contact/sphere_contact_lanes-inl.h"
#include "engine/simd/each_cpu-inl.h"

// Those of AVX2 with AVX-512 too: masks in registers of their own cost more than they save here.
const SphereContactKernels kKernels =
    FETTLE_AT_LEVEL(std::min(engine::bestCpuLevel(), engine::CpuLevel::kAvx2), kernels)();

}  // namespace

const SphereContactKernels& sphereContactKernels() noexcept {
  return kKernels;
}

}  // namespace fettle::haptic
