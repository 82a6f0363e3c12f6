#pragma once

#include "engine/base/job.h"
#include "engine/measure/surface.h"

namespace fettle::engine {

/// How many waves there are over the surface along its rows and along its columns; their ratio is the wave's direction.
struct WavesOver {
  double columns = 0.0, rows = 0.0;
};

/// The wave near `start` that leaves least of the surface's mean square, with a mean of its own: A cos(phi) + B sin(phi) + C by least
/// squares over the samples, holes left out. Where the surface is one wave it is that wave, whatever part of a period there is at its
/// ends. Gauss and Newton's steps, each as far as it explains more, no more than one wave over the surface away from the start in each
/// direction; to 1e-3 of one.
///
/// Time: 3 to 8 passes over the samples. Bit-identical for any number of threads. Where the job is cancelled: some wave. Surfaces of 2 columns and
/// rows and more. Thread: any; on all workers of the calling arena. May throw std::bad_alloc.
[[nodiscard]] WavesOver nearestWave(const Surface& surface, const WavesOver& start, JobControl& job);

}  // namespace fettle::engine
