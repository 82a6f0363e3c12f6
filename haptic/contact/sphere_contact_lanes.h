#pragma once

#include <array>
#include <cstdint>

namespace fettle::haptic {

/// The vectorised arithmetic of SphereWindow::contacts: several cells at a time, for windows without holes.
/// Results are bit-identical to those of SphereWindow::contactsCellByCell; tests compare the two.
///
/// Threading: pure; wait-free, noexcept, allocates nothing.

/// Cells per call of find; the processor takes as many of them at a time as its registers hold.
inline constexpr int kSphereContactLanes = 8;
/// Pieces of a cell that is twisted enough for two minima. With 6 a ball penetrated a cell of slope 10 by
/// 0.016 of a cell.
inline constexpr int kTwistPieces = 24;

/// A window as the lanes read it: heights [mm] row-major, `columns` per row, the first at the field's sample
/// (column, row). kSphereContactLanes doubles after the last may be read; their values are ignored.
struct LaneWindow {
  const double* z;
  std::int32_t columns;
  std::int32_t column, row;
  double sx, sy;  ///< spacing [mm]
};

/// The ball: its centre, the largest distance of a contact, and the rounding allowed at a seam.
struct LaneProbe {
  double x, y, z;
  double reach, reach2;
  double seam_x, seam_y;
};

/// A cell by its lower-left sample in the window.
struct LaneCell {
  std::int16_t i, j;
};

/// Contacts of one kind in up to eight cells: those of the lanes in `found`.
struct LaneContacts {
  unsigned found = 0;  ///< bit k: cell k has one; the numbers of the other lanes are undefined
  alignas(64) std::array<double, kSphereContactLanes> u,
      v;  ///< where in the cell; edges fill the one that varies
  alignas(64) std::array<double, kSphereContactLanes> mx, my, mz;  ///< centre minus point [mm]
  alignas(64) std::array<double, kSphereContactLanes> d2;          ///< squared distance [mm^2]
};

struct LaneFinds {
  LaneContacts sample, edge_x, edge_y, inside;
  unsigned twisted = 0;  ///< bit k: cell k may have several minima inside; `inside` leaves it out
};

struct SphereContactKernels {
  /// The cells of [i0, i1] x [j0, j1] that the ball may reach, row by row, to `out` (room for all, and
  /// kSphereContactLanes more); how many there are.
  int (*reached)(const LaneWindow& w, const LaneProbe& ball, std::int32_t i0, std::int32_t i1,
                 std::int32_t j0, std::int32_t j1, LaneCell* out) noexcept;
  /// Contacts of `count` cells, 1 to kSphereContactLanes. The two samples beyond each cell must be in the
  /// window.
  void (*find)(const LaneWindow& w, const LaneProbe& ball, const LaneCell* cells, int count,
               LaneFinds& out) noexcept;
  /// Bit k: half the slope along v of the least squared distance along u (see SphereWindow) is below zero at
  /// v = k / kTwistPieces and above at (k + 1) / kTwistPieces.
  unsigned (*rises)(const LaneWindow& w, const LaneProbe& ball, LaneCell cell) noexcept;
};

/// The kernels for this machine, chosen when the program starts.
[[nodiscard]] const SphereContactKernels& sphereContactKernels() noexcept;

}  // namespace fettle::haptic
