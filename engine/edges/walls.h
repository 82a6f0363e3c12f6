#pragma once

#include <vector>

#include "engine/base/job.h"
#include "engine/edges/polyline.h"
#include "engine/edges/sample_window.h"

namespace fettle::engine {

/// Where a tall wall runs at a point of a line.
struct WallPlace {
  double offset = 0.0;     ///< across, from the point [samples]
  double deviation = 0.0;  ///< standard deviation of the place [samples]
  bool found =
      false;  ///< the wall is tall, a smooth line divides its samples, and no other line settles there
};

/// Moves located lines at tall walls to between the samples of their two sides; returns the places, by line and point.
///
/// At a wall of 24 noises or more the side of nearly every sample is certain from its height alone, so the samples
/// next to the wall bound the line from both sides. Of the parabolas through 5 to 12 points before and after, that
/// one is taken which divides them best, by a logistic penalty. Samples between the surfaces (mixed pixels, or what a
/// spot of light blurs) have no say. A sample on the wrong side of a line that divides all others, such as a mixed
/// pixel that happens to have the height of a surface, is left out. The deviation is that of the room which the samples
/// leave: half a sample where a wall runs along a row, a tenth or less where it is slanted or curved.
///
/// Nothing is found at corners, where lines are bent within 8 samples, and where a side has too few samples, as on
/// ribs of two samples: there the line stays as it is. Where two lines settle within a sample of each other one of
/// them is of another edge: both lie at the wall, and keep the deviations that they had.
///
/// Notes in the window which points its samples are nearest to. Deterministic. Blocks, on all workers; stops early when
/// cancelled.
std::vector<std::vector<WallPlace>> settleAtWalls(std::vector<Polyline>& lines, double noise,
                                                  SampleWindow& window, const JobControl& job);

}  // namespace fettle::engine
