#pragma once

#include <array>
#include <cstdint>

namespace fettle::haptic {

/// The arithmetic of SphereWindow::touches on several cells abreast, for windows without holes. What is
/// found, and every bit of it, is what SphereWindow::touchesCellByCell finds; tests compare the two.
///
/// Threading: pure; wait-free, noexcept, allocates nothing.

/// Cells of one look; the processor takes as many of them at a time as its registers hold.
inline constexpr int kTouchLanes = 8;
/// Pieces of a cell that is twisted enough for two minima. With 6 a ball came 0.016 of a cell into one of
/// slope 10.
inline constexpr int kTwistPieces = 24;

/// A window as lanes read it: heights [mm] row-major, `columns` a row, the first at the field's sample
/// (column, row). kTouchLanes doubles behind the last may be read and mean nothing.
struct LaneWindow {
  const double* z;
  std::int32_t columns;
  std::int32_t column, row;
  double sx, sy;  ///< spacing [mm]
};

/// The ball: its centre and how far a touch may be, with what rounding may do at a seam.
struct LaneProbe {
  double x, y, z;
  double reach, reach2;
  double seam_x, seam_y;
};

/// A cell by its lower-left sample in the window.
struct LaneCell {
  std::int16_t i, j;
};

/// Touches of one kind in up to eight cells: those of the lanes in `found`.
struct LaneTouches {
  unsigned found = 0;  ///< bit k: cell k has one; the numbers of the other lanes mean nothing
  alignas(64) std::array<double, kTouchLanes> u, v;  ///< where in the cell; edges fill the one that varies
  alignas(64) std::array<double, kTouchLanes> mx, my, mz;  ///< centre minus point [mm]
  alignas(64) std::array<double, kTouchLanes> d2;          ///< squared distance [mm^2]
};

struct LaneFinds {
  LaneTouches sample, edge_x, edge_y, inside;
  unsigned twisted = 0;  ///< bit k: cell k may have several minima inside; `inside` leaves it out
};

struct TouchKernels {
  /// The cells of [i0, i1] x [j0, j1] that the ball may reach, row by row, to `out` (room for all, and
  /// kTouchLanes more); how many there are.
  int (*reached)(const LaneWindow& w, const LaneProbe& ball, std::int32_t i0, std::int32_t i1,
                 std::int32_t j0, std::int32_t j1, LaneCell* out) noexcept;
  /// Touches of `count` cells, 1 to kTouchLanes. The two samples beyond each cell must be in the window.
  void (*look)(const LaneWindow& w, const LaneProbe& ball, const LaneCell* cells, int count,
               LaneFinds& out) noexcept;
  /// Bit k: half the slope along v of the least squared distance along u (see SphereWindow) is below zero at
  /// v = k / kTwistPieces and above at (k + 1) / kTwistPieces.
  unsigned (*rises)(const LaneWindow& w, const LaneProbe& ball, LaneCell cell) noexcept;
};

/// The kernels for this machine, chosen when the program starts.
[[nodiscard]] const TouchKernels& touchKernels() noexcept;

}  // namespace fettle::haptic
