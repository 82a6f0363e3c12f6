#include "haptic/contact/closest_point.h"

#include <algorithm>
#include <cmath>

#include "haptic/base/search_limits.h"
#include "haptic/contact/closest_on_cell.h"
#include "haptic/contact/hull_distance.h"
#include "haptic/contact/normal.h"

namespace fettle::haptic {

namespace {

// The state of one call of searchClosest.
class CellByCell {
 public:
  // run() fills the patch before anything reads it: to clear it here would cost every tick.
  // NOLINTNEXTLINE(clang-analyzer-optin.cplusplus.UninitializedObject)
  CellByCell(Surface& surface, const glm::dvec3& endpoint) noexcept : surface_(surface), e_(endpoint) {}

  [[gnu::always_inline]] inline SearchResult run(CellIndex start, double u, double v) noexcept {
    SearchResult result;
    if (!surface_.patch(start, here_)) return result;
    cell_ = start;
    result.cells = 1;
    result.end = SearchEnd::kAtRest;
    look(u, v);
    // A hand that moves little leaves its proxy at the same vertex.
    if (atVertex(u, v) && highestRise(here_, away_, u, v) <= 0.0 && around(u, v).rising == 0) {
      at_ = {u, v, away2_};
      result.ringed = true;
    } else {
      at_ = closestOnCell(here_, e_, u, v);
      moveOn(result);
    }
    const glm::dvec3 point = here_.at(at_.u, at_.v);
    const glm::dvec3 d = point - e_;
    result.point = {cell_, at_.u, at_.v, point, d.x * d.x + d.y * d.y + d.z * d.z};
    return result;
  }

 private:
  [[nodiscard]] static bool onLine(double x) noexcept { return x == 0.0 || x == 1.0; }
  [[nodiscard]] static bool atVertex(double u, double v) noexcept { return onLine(u) && onLine(v); }

  // From a point of the present cell to the endpoint.
  void look(double u, double v) noexcept {
    away_ = e_ - here_.at(u, v);
    away2_ = away_.x * away_.x + away_.y * away_.y + away_.z * away_.z;
  }

  // The cells around a vertex of the present one: 1 across u, 2 across v, 4 across both.
  struct Around {
    int rising = 0;  // cells with a corner that may be nearer, or that is a hole
    bool complete = false;
  };
  // At a vertex of the present cell, of which look() was called. The three other cells have five corners that the present
  // cell has not; its own are not nearer.
  [[gnu::always_inline]] inline Around around(double u, double v) noexcept {
    const int dc = u == 1.0 ? 1 : -1;
    const int dr = v == 1.0 ? 1 : -1;
    const Surface::Star star =
        surface_.star(cell_.column + (u == 1.0 ? 1 : 0), cell_.row + (v == 1.0 ? 1 : 0), dc, dr);
    const double height = e_.z - away_.z;
    const double step_x = dc * here_.sx * away_.x;
    const double step_y = dr * here_.sy * away_.y;
    // Where a sample is a hole the comparison is false.
    const double limit = 0.25 * (away2_ - shorterThan(away2_, e_));
    const auto behind = [&](double along, double to) {
      return along + away_.z * (to - height) <= limit ? 1 : 0;
    };
    const int across_u = behind(step_x, star.across_u);
    const int across_v = behind(step_y, star.across_v);
    const int all_u = across_u & behind(step_x - step_y, star.corners[0]);
    const int all_v = across_v & behind(step_y - step_x, star.corners[1]);
    const int all_both = across_u & across_v & behind(step_x + step_y, star.corners[2]);
    return {7 & ~(all_u | all_v << 1 | all_both << 2), star.complete()};
  }

  // From the bounded closest point of the present cell to that of the cell where the search rests.
  void moveOn(SearchResult& result) noexcept {
    for (;;) {
      if (!onLine(at_.u) && !onLine(at_.v)) {
        result.ringed = true;
        return;
      }
      look(at_.u, at_.v);
      const bool vertex = atVertex(at_.u, at_.v);
      const Around near = vertex ? around(at_.u, at_.v) : Around{7, true};
      int missing = vertex ? 0 : 1;
      bool moves = false;
      PatchPoint nearest = at_;
      double shorter = shorterThan(nearest.distance2_mm2, e_);
      CellIndex nearest_cell;
      Patch nearest_patch;
      forEachSharing(surface_, cell_, at_.u, at_.v, [&](const SharingCell& other) {
        // Across u, across v or both: at least one.
        const bool across_v = other.cell.row != cell_.row;
        const int bit = !across_v ? 0 : (other.cell.column != cell_.column ? 2 : 1);
        Patch patch;
        if ((near.rising >> bit & 1) == 0 || !surface_.patch(other.cell, patch)) return;
        missing = 0;
        // What is left of the distance at the cell's highest corner bounds the distance of all of it.
        const double left = away2_ - highestRise(patch, away_, other.u, other.v);
        if (left > 0.0 && left * left >= shorter * away2_) return;
        const PatchPoint point = closestOnCell(patch, e_, other.u, other.v);
        if (!(point.distance2_mm2 < shorter)) return;
        nearest = point;
        shorter = shorterThan(nearest.distance2_mm2, e_);
        nearest_cell = other.cell;
        nearest_patch = patch;
        moves = true;
      });
      if (!moves) {
        result.ringed = missing == 0 && near.complete;
        return;
      }
      at_ = nearest;
      cell_ = nearest_cell;
      here_ = nearest_patch;
      if (++result.cells >= kMaxCellsVisited) {
        result.end = SearchEnd::kBound;
        return;
      }
    }
  }

  Surface& surface_;
  const glm::dvec3& e_;
  Patch here_;
  CellIndex cell_;
  PatchPoint at_;
  glm::dvec3 away_{0.0};
  double away2_ = 0.0;
};

}  // namespace

SearchResult searchClosest(Surface& surface, const glm::dvec3& endpoint, CellIndex start, double u,
                           double v) noexcept {
  return CellByCell(surface, endpoint).run(start, u, v);
}

}  // namespace fettle::haptic
