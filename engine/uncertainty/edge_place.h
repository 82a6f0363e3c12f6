#pragma once

#include "engine/measure/section.h"
#include "engine/measure/section_figures.h"

namespace fettle::engine {

/// Standard error of the place of an edge that edgeIn() or grooveIn() found, by the step there [mm]. Two errors make it: the edge lies anywhere between two
/// places, spacing / sqrt(12); and noise lets places beside it fit better on the other side. The sum of squares by which an edge m places off fits worse
/// is a random walk in m that falls by half of (step / noise)^2 a place and scatters by step / noise (D. Hinkley, Inference about the change-point in a
/// sequence of random variables, 1970); the mean square of the place of its maximum is that of 4,096 walks, the same ones each time. The noise is what the heights
/// scatter by about the lines, and what neighbouring places share of it.
///
/// Of an edge within one place: one that rises over several is found where the lines fit best, which is about its middle. NaN where the
/// step is less than three and a half times the noise: how far the edge is off goes by the fourth power of their ratio, which is not known well enough then.
[[nodiscard]] double edgeError(const Section& section, const StepFigures& step);

}  // namespace fettle::engine
