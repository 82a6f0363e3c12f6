#pragma once

#include <array>
#include <cstdint>

namespace fettle::haptic {

/// The vectorised arithmetic of SphereWindow::contacts: several cells at a time, those without holes around them.
/// Results are bit-identical to those of SphereWindow::contactsCellByCell; tests compare the two.
///
/// Threading: pure; wait-free, noexcept, allocates nothing.

/// Cells per call of find; the processor takes as many of them at a time as its registers hold.
inline constexpr int kSphereContactLanes = 8;
/// Pieces of a cell that is twisted enough for two minima. With 6 a ball penetrated a cell of slope 10 by
/// 0.016 of a cell.
inline constexpr int kTwistPieces = 24;

/// Samples along a side of a window at most; its cells, and room for the lanes of the last.
inline constexpr int kMostLaneSide = 44;
inline constexpr int kMostLaneCells = kMostLaneSide * kMostLaneSide + kSphereContactLanes;

/// A window as the lanes read it: heights [mm] row-major, `columns` per row, the first at the field's sample
/// (column, row). kSphereContactLanes doubles after the last may be read; their values are ignored.
struct LaneWindow {
  const double* z;
  std::int32_t columns;
  std::int32_t column, row;
  double sx, sy;  ///< spacing [mm]
};

/// Bounds of a window's cells, prepared once for all searches in it; cell (i, j) at j * columns + i. A cell without
/// a surface is beyond every reach.
struct LaneBounds {
  std::array<double, kMostLaneCells> top;  ///< highest corner [mm]
  /// The plane through a cell's middle, normal of unit length: nx x + ny y + nz z + offset for x and y from the
  /// window's first sample [mm]; and how far the cell leaves it, infinite where that does not bound a contact.
  std::array<double, kMostLaneCells> nx, ny, nz, offset, margin;
  /// Not 0: a cell next to one without a surface, or at the window's border. find() cannot look at it.
  std::array<std::uint8_t, kMostLaneCells> rim;
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

/// A cell's inside along v, see SphereWindow::Valley, which has the same names.
struct LaneValley {
  double b, c, d, ex, ey, w0, sx, sy;
};

/// A cell and what of it may hold a contact: some of kSampleFeature and the others.
struct LaneCandidate {
  std::int16_t i, j;
  std::uint16_t features;
};
inline constexpr unsigned kSampleFeature = 1;  ///< its upper right sample
inline constexpr unsigned kEdgeXFeature = 2;   ///< its upper edge, along x
inline constexpr unsigned kEdgeYFeature = 4;   ///< its right edge, along y
inline constexpr unsigned kInsideFeature = 8;
inline constexpr unsigned kRimFeature = 16;  ///< all of it: a cell that find() cannot look at

/// What around one place may hold a contact, in find()'s order, and the cells among it whose inside may, in the
/// same order, as the lanes read them.
struct LaneCandidates {
  static constexpr int kMost = 96;
  std::array<LaneCandidate, kMost> cells;
  int count = 0;
  int insides = 0;
  std::array<double, kMost + kSphereContactLanes> z00, b, c, d, low, high, x0, y0;
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
  /// The cells of [i0, i1] x [j0, j1] that the ball may reach by their bounds, row by row, to `out` (room for all, and
  /// kSphereContactLanes more); how many there are.
  int (*reached)(const LaneWindow& w, const LaneBounds& bounds, const LaneProbe& ball, std::int32_t i0,
                 std::int32_t i1, std::int32_t j0, std::int32_t j1, LaneCell* out) noexcept;
  /// Fills the bounds of a window of `rows` rows, all but `rim`, with `more_mm` added to their margins.
  void (*prepare)(const LaneWindow& w, std::int32_t rows, double more_mm, LaneBounds& bounds) noexcept;
  /// Contacts of `count` cells, 1 to kSphereContactLanes. The two samples beyond each cell must be in the
  /// window.
  void (*find)(const LaneWindow& w, const LaneProbe& ball, const LaneCell* cells, int count,
               LaneFinds& out) noexcept;
  /// Bit k: half the slope along v of the least squared distance along u (see SphereWindow) is below zero at
  /// v = k / kTwistPieces and above at (k + 1) / kTwistPieces.
  unsigned (*rises)(const LaneValley& g) noexcept;
  /// Half the slope along v of the least squared distance along u of a steep cell, and its derivative, at
  /// kSphereContactLanes places.
  void (*steepSlopes)(const LaneValley& g, const double* v, double* slope, double* bend) noexcept;
  /// All that find() may find, around `ball`'s centre within `room` and with a reach shorter by `room`, in
  /// the cells [i0, i1] x [j0, j1]. False: more than fit.
  bool (*candidates)(const LaneWindow& w, const LaneBounds& bounds, const LaneProbe& ball, double room,
                     std::int32_t i0, std::int32_t i1, std::int32_t j0, std::int32_t j1,
                     LaneCandidates& out) noexcept;
  /// Minima inside the cells from the `from`th of some.insides, at most kSphereContactLanes: `inside` and
  /// `twisted` of `out`.
  void (*insides)(const LaneCandidates& some, int from, double sx, double sy, const LaneProbe& ball,
                  LaneFinds& out) noexcept;
};

/// The kernels for this machine, chosen when the program starts.
[[nodiscard]] const SphereContactKernels& sphereContactKernels() noexcept;

}  // namespace fettle::haptic
