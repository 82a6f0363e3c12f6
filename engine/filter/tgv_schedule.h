#pragma once

#include <cstdint>

#include "engine/filter/tgv_rows.h"

namespace fettle::engine::tgv {

// The schedule of generalised variation. It is part of what the filter is, wherever its steps run.

// Both lengths at 1 / sqrt(12) converge as well (|grad, E|^2 <= 12). Short steps in the surface and long ones
// in the duals are four times as fast on scans: what is sought differs from the scan by some noise, while the
// duals along an edge have far to go.
inline constexpr float kBalance = 0.15F;
inline constexpr float kRootOf12 = 3.4641016F;
inline constexpr StepLength kStep{kBalance / kRootOf12, 1.0F / (kBalance * kRootOf12)};

inline constexpr Weights kWeights{2.2F, 4.4F, 0.5F, 0.1F};
inline constexpr int kFirstSteps = 60;
/// Each begins with reweight().
inline constexpr int kRounds = 4;
inline constexpr int kRoundSteps = 40;

/// Side of the squares that are worked out as a whole, and the samples around each. With 48 no result is further than
/// 0.002 of the noise from what the whole field in one would give; with 32 it is 0.02, with 16 one sample at an edge may
/// fall to the other side. [samples]
inline constexpr std::int32_t kSide = 256, kHalo = 48;

}  // namespace fettle::engine::tgv
