#pragma once

#include <array>
#include <cstdint>

#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::bench {

/// Of kOpening and kClosing with a disk: its chords, of both erosions.
[[nodiscard]] std::int64_t chordsOfDisk(const engine::FilterSpec& spec, const engine::Grid& grid);

/// What an erosion of kOpening and kClosing with a ball cannot do without where every sample of it is held against each result:
/// samples that lie equally far to the left and to the right make a pair, and each depth is added once to the least of its pairs.
struct BallPairs {
  std::int64_t pairs = 0;
  std::int64_t depths = 0;  ///< different ones
};
[[nodiscard]] BallPairs pairsOfBall(const engine::Version& field, const engine::FilterSpec& spec);

/// What one of them cannot do without where only those samples count that the ball touches, and it is known which these are: per
/// sample of the field.
struct BallTouches {
  /// Sums of a sample and a depth. A sample that is touched from any of a block's 8 x 4 results is held against all of these.
  double sums = 0.0;
  /// That all others are no lower: for 16 x 16 results one test of each group of 16 x 16 samples within reach, and of each group of
  /// 4 x 4 in those of them with a touched sample; for 8 x 4 results one of each sample in groups of 4 x 4 with a touched sample.
  double tests = 0.0;
};

/// Of the erosion of the heights, and of the one of what that leaves: counted on 4 to 64 blocks of 16 x 16 results, evenly over the
/// field. Of samples that a ball touches together one counts. Some seconds at most. Throws std::bad_alloc.
[[nodiscard]] std::array<BallTouches, 2> touchesOfBall(const engine::Version& field,
                                                       const engine::FilterSpec& spec);

}  // namespace fettle::bench
