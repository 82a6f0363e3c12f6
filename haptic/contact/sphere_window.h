#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <glm/vec3.hpp>

#include "haptic/base/search_limits.h"
#include "haptic/contact/sphere_contact_lanes.h"
#include "haptic/contact/surface.h"

namespace fettle::haptic {

/// The material around a ball's centre, and where its distance to the centre is a local minimum.
///
/// The material M is everything at or below the bilinear surface of the cells without holes: the surface
/// itself, and vertical walls below the rims of holes and below the field's own edges. Where the ball rests,
/// the point of M that it touches is a local minimum of the distance over M; such points are of four kinds,
/// each with a test on which neighbouring cells agree, so that a seam between two cells in one plane is no
/// contact (the "internal edge" of physics engines):
///   a sample: the centre is on the far side of the planes square to its edges;
///   an edge: perpendicular at the foot, and the two cells next to it lead away from the centre;
///   a cell's inside: the surface's normal there goes through the centre;
///   a wall: level with the centre, out of the rim's side.

/// A point of the material where the distance to the centre is a local minimum.
struct SphereContact {
  glm::dvec3 point_mm{0.0};
  glm::dvec3 normal{0.0, 0.0, 1.0};  ///< from the point to the centre, unit length, z >= 0; z = 0 at a wall
  double distance_mm = 0.0;          ///< from the point to the centre
  CellIndex cell;                    ///< a cell without holes that holds the point, or the rim above it
  double u = 0.0, v = 0.0;           ///< of the point (the rim above it) in that cell
};

/// Contacts near one centre, in a fixed order of cells.
struct SphereContactList {
  static constexpr int kMost = 96;
  std::array<SphereContact, kMost> contacts;
  int count = 0;
  /// Nearest distance among all found [mm]; HUGE_VAL when there is none.
  double nearest_mm = 0.0;
  /// Whether the centre is below the surface; then the contacts are not valid.
  bool below = false;
};

/// How contacts are searched for: the same bits both ways.
enum class SphereSearch : std::uint8_t {
  kBounded,     ///< by bounds of cells, and among what was gathered around an earlier search
  kCellByCell,  ///< every cell near, one after the other: what tests compare with
};

/// A copy of the samples around a ball, in millimetres.
///
/// Threading: one thread; nothing allocates, locks or throws. About 135 kB, of which a ball of two cells uses 15.
class SphereWindow {
 public:
  /// Samples along a side at most: a ball of 16 cells radius and a margin.
  static constexpr std::int32_t kMostSide = kMostLaneSide;

  explicit SphereWindow(BallMinima minima = BallMinima::kPieces,
                        BallSteps steps = BallSteps::kInPlan) noexcept
      : minima_(minima), from_field_(steps == BallSteps::kInPlan) {}

  /// Copies what a ball of radius `reach_mm` needs anywhere within `room_mm` (horizontally) of `centre`,
  /// which is finite. What does not fit kMostSide is left out: keep (reach + room) / spacing <= 20.
  void load(const Surface& surface, const glm::dvec3& centre, double reach_mm, double room_mm) noexcept;
  /// Whether a ball at `centre` still lies within what was loaded.
  [[nodiscard]] bool holds(const glm::dvec3& centre) const noexcept;

  /// To be called when the field may have changed: the next centre is not held.
  void invalidate() noexcept {
    low_x_ = HUGE_VAL;
    gathered_ = false;
  }

  /// All contacts nearer than `reach_mm` (at most load()'s value); when there are more than fit, the nearest
  /// ones. `centre` is held. What may hold a contact for any centre within `room_mm` >= 0 is kept when that
  /// seems to pay, and looked at alone by searches nearby: the contacts are the same bits for any room.
  void contacts(const glm::dvec3& centre, double reach_mm, double room_mm, SphereContactList& out) noexcept;
  /// How many cells the last contacts() looked at because they were gathered; -1: all within reach.
  [[nodiscard]] int gatheredCells() const noexcept { return gathered_ ? candidates_.count : -1; }
  /// The same, of all cells within reach.
  void contactsSearched(const glm::dvec3& centre, double reach_mm, SphereContactList& out) const noexcept;
  /// The same, one cell after the other without bounds: the reference for both in tests.
  void contactsCellByCell(const glm::dvec3& centre, double reach_mm, SphereContactList& out) const noexcept;

  /// Height of the surface under (x, y) [mm]; -HUGE_VAL over holes and outside the field.
  [[nodiscard]] double heightUnder(const glm::dvec3& at) const noexcept;
  /// The point of the surface straight above or below `at`, and the surface's normal there; false over holes
  /// and outside the field. With BallSteps::kInSpace u and v are rounded as the window lies.
  [[nodiscard]] bool under(const glm::dvec3& at, SphereContact& out) const noexcept;
  /// Curvature of the distance to the contact: the second derivative's bilinear form [1/mm] at `centre` for
  /// two directions perpendicular to the line to the point; 0 for a plane, 1 / distance for a sample.
  [[nodiscard]] double bend(const glm::dvec3& centre, const SphereContact& touch, const glm::dvec3& a,
                            const glm::dvec3& b) const noexcept;
  // Of a centre that is held, so that what else the window holds changes nothing.
  /// Whether cells within `reach_mm` are so steep that their minima are searched for one by one; none with
  /// BallMinima::kPieces.
  [[nodiscard]] bool steepNear(const glm::dvec3& at, double reach_mm) const noexcept;
  /// How many of those cells a ball may reach by their highest corners: what a search there takes, at some 1 us each.
  [[nodiscard]] int steepCells(const glm::dvec3& at, double reach_mm) const noexcept;
  /// Whether the material straight below some sample comes nearer than `distance_mm`: then no search finds a ball of that radius
  /// free. Answered where the window has steep cells.
  [[nodiscard]] bool columnWithin(const glm::dvec3& at, double distance_mm) const noexcept;
  /// The lowest height of a centre at (x, y) of `at` from which a ball reaches no sample; -HUGE_VAL: none near.
  [[nodiscard]] double overSamples(const glm::dvec3& at, double radius_mm) const noexcept;
  /// Highest sample of the cells within `radius_mm`; -HUGE_VAL: none.
  [[nodiscard]] double highestNear(const glm::dvec3& at, double radius_mm) const noexcept;
  /// Highest sample within the window [mm]; -HUGE_VAL when there is none.
  [[nodiscard]] double highest() const noexcept { return highest_; }

 private:
  struct Corners {
    double z00, z10, z01, z11;
  };
  [[nodiscard]] Corners corners(std::int32_t i, std::int32_t j) const noexcept {
    const double* z = z_.data() + j * columns_ + i;
    return {z[0], z[1], z[columns_], z[columns_ + 1]};
  }
  /// Whether a place, in cells from the first sample, lies over one of the window's cells.
  [[nodiscard]] bool within(double x, double y) const noexcept {
    return x >= 0.0 && y >= 0.0 && x < columns_ - 1 && y < rows_ - 1;
  }
  [[nodiscard]] bool valid(std::int32_t i, std::int32_t j) const noexcept;
  struct Box {
    std::int32_t i0, i1, j0, j1;  // cells
  };
  [[nodiscard]] Box boxAround(const glm::dvec3& centre, double reach_mm) const noexcept;
  [[nodiscard]] LaneWindow laneWindow() const noexcept {
    return {z_.data(), columns_, column_, row_, sx_, sy_};
  }
  /// Whether pieces may hide a minimum of a cell with this twist [mm].
  [[nodiscard]] bool steep(double twist) const noexcept {
    return minima_ == BallMinima::kAll && std::abs(twist) > kTwistPieces * std::min(sx_, sy_);
  }
  /// Whether a steep cell's valley is narrower than the places along a cell differ by; then its inside is not searched (sphere_collector).
  [[nodiscard]] bool tooNarrow(double twist) const noexcept {
    constexpr double kNarrowest = 4e-16;
    return std::min(sx_, sy_) < kNarrowest * std::abs(twist);
  }
  void markRims() noexcept;
  [[nodiscard]] bool markSteep() noexcept;
  // Columns of a box, a bit each.
  [[nodiscard]] static std::uint64_t columnsOf(const Box& box) noexcept {
    return ((std::uint64_t{2} << (box.i1 - box.i0)) - 1) << box.i0;
  }
  void gather(const glm::dvec3& centre, double reach_mm, double room_mm) noexcept;
  class Collector;
  class Valley;

  BallMinima minima_;
  bool
      from_field_;  // whether under() takes u and v from the field's corner, so that its bits do not depend on where the window lies
  std::array<double, kMostSide * kMostSide + kSphereContactLanes> z_{};  // lanes read past the end
  std::array<float, kMostSide * kMostSide> raw_{};
  std::int32_t column_ = 0, row_ = 0;    // field sample of z_[0]
  std::int32_t columns_ = 0, rows_ = 0;  // samples
  double sx_ = 1.0, sy_ = 1.0;
  double low_x_ = 0.0, high_x_ = 0.0, low_y_ = 0.0, high_y_ = 0.0;  // centres it holds [mm]
  double highest_ = 0.0;
  bool whole_ = false;  // no NaN in it
  // Otherwise its cells without a hole, a bit per column: row j at j + 1, and none beyond the window.
  std::array<std::uint64_t, kMostSide + 2> cells_{};
  // While has_steep_cells_: those, a bit per column; the highest sample of each row.
  std::array<std::uint64_t, kMostSide> steep_{};
  std::array<double, kMostSide> row_top_{};
  bool boundable_ = false;
  bool has_steep_cells_ = false;
  LaneBounds bounds_;
  bool gathered_ = false;  // whether candidates_ are those around gathered_at_
  bool reused_ = true;     // whether the last that were gathered were used twice
  LaneCandidates candidates_;
  glm::dvec3 gathered_at_{0.0}, searched_at_{NAN};
  double gathered_reach_ = 0.0, gathered_room_ = 0.0;
};

}  // namespace fettle::haptic
