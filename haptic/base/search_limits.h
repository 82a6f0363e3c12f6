#pragma once

namespace fettle::haptic {

/// Cells one search may move through, and rounds (one look at a patch each) it may take. At 1 kHz and 0.05 mm
/// a cell a hand at 2 m/s crosses 40 a tick; the bounds keep the worst tick near 50 microseconds.
inline constexpr int kMaxCellsVisited = 512;
inline constexpr int kMaxRounds = 2048;

}  // namespace fettle::haptic
