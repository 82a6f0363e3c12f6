#pragma once

#include <cstdint>

namespace fettle::haptic {

/// Most cells that one search may visit, and most rounds (one evaluation of a patch each) it may take. At 1
/// kHz and 0.05 mm per cell, a hand at 2 m/s crosses 40 cells per tick; the bounds keep the worst tick near
/// 50 microseconds.
inline constexpr int kMaxCellsVisited = 512;
inline constexpr int kMaxRounds = 2048;

/// Searches for contacts after which a ball's tick takes no further step: the default, and the largest. Without this bound a
/// tick takes up to 128 steps (docs/decisions/ball-tip.md).
inline constexpr int kBallSearches = 16;
inline constexpr int kMostBallSearches = 4096;

/// Steep cells (BallMinima) that a ball's tick may search, all its searches together, after which no further try begins: the
/// default, and the largest. One takes 0.4 to 1.6 us, so that the default is below 100 us.
inline constexpr int kBallWork = 96;
inline constexpr int kMostBallWork = 1'000'000;

/// In which direction a ball's step has a largest length, a cell at most.
enum class BallSteps : std::uint8_t {
  kInSpace,  ///< in every direction: a ball falls a cell per step; before contact revision 4 (scene.h)
  kInPlan,   ///< horizontally: it falls and rises by any height in one step
};

/// Which minima of the distance a ball searches for inside a cell.
enum class BallMinima : std::uint8_t {
  kPieces,  ///< those that equal pieces of a cell show: beside a needle it may enter the material by its radius
  kAll,  ///< in steep cells, all that pieces in proportion to the scale of the distance show; twice the time there
};

}  // namespace fettle::haptic
