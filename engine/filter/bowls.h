#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace fettle::engine {

/// A ball's surface below its top, over a grid.
struct BallDepth {
  double radius, squared, most, spacing_x, spacing_y, height_mm;
};

/// Of a sample so many columns and rows away. Not radius - root, whose digits cancel.
[[nodiscard]] inline double depthOfBall(const BallDepth& ball, double columns, double rows) noexcept {
  const double x = columns * ball.spacing_x, y = rows * ball.spacing_y;
  const double distance = x * x + y * y, rest = ball.squared - distance;
  const double depth = distance / (ball.radius + std::sqrt(rest > 0.0 ? rest : 0.0)) / ball.height_mm;
  return distance > ball.most ? std::numeric_limits<double>::infinity() : depth;
}

/// A sample's bowl is how high a ball below it that touches it lies, by where its middle is. In floats and from below: its depth goes on
/// as a paraboloid beyond `bend`, so that bowls are finite everywhere, and curved by 1 / radius at least.
struct BowlShape {
  float square_x, square_y;  ///< of a sample's spacing [mm^2]
  float bend, squared;       ///< of a distance, of the radius [mm^2]
  float radius;              ///< [mm]
  float slope_beyond;        ///< by the square of the distance [height_unit/mm^2]
  float per_unit;            ///< [height_unit/mm]
  float steep_x, steep_y;    ///< make a slope's square of the squares of slopes along rows and columns
};

/// Groups of 16 x 16 samples in a grid. No sample is lower than `least` plus the slopes times its distance from its group's middle.
struct LargeGroups {
  const float *least, *slope_x, *slope_y;
  std::ptrdiff_t stride;
  int columns, rows;
  float x, y;  ///< of the first one's middle from that of a block of results [samples]
};

/// Groups of 4 x 4 samples, x, y: of their middle from the first one of 16 x 16 results [samples]. What lists hold is followed by
/// 16 infinite ones.
struct SmallGroups {
  float *least, *slope_x, *slope_y, *x, *y;
  std::int32_t* number;
};

/// The bowls of groups at the middle of a block: of a sample in the group's middle, of any less what the group's extent can do.
struct GroupBowls {
  float *middle, *least, *slope_x, *slope_y;
};

/// A block of results, x, y: its middle from the first one of 16 x 16. A bowl that is no lower than `most` there, less the
/// differences of its slopes to these times the halves, is lower than another one nowhere on the block.
struct BowlTest {
  float x, y, half_x, half_y;
  float slope_x, slope_y;
  float most;
};

/// Where samples' heights and depths lie, from those of the first of 16 x 16 results.
struct BowlPlaces {
  std::int32_t *height, *depth;
};

}  // namespace fettle::engine
