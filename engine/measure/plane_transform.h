#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/job.h"

namespace fettle::engine {

/// The least number from `least` on without a prime factor above 5: lengths whose transforms are fast.
[[nodiscard]] std::int32_t transformLength(std::int32_t least) noexcept;

enum class Transform : std::uint8_t { kForward, kBackward };

/// The discrete Fourier transform of width x height values, row-major, in place; neither direction is scaled. Rows from
/// `rows` on hold zeros and are left out of the first pass of a forward transform (0: every row is used).
///
/// KISS FFT as Eigen has it: one thread a line, so that bits are the same for any number of them. Stops early when the job
/// is cancelled. Throws std::bad_alloc. Thread: any; on all workers of the calling arena.
void transformPlane(std::vector<std::complex<double>>& values, std::int32_t width, std::int32_t height,
                    Transform direction, JobControl& job, std::int32_t rows = 0);

}  // namespace fettle::engine
