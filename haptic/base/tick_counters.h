#pragma once

#include <cstdint>

namespace fettle::haptic {

/// Rare but legal cases of a tick, counted so that they can be reported. Plain numbers, used by the ticking
/// thread only.
struct TickCounters {
  /// Input with a NaN or an infinity: treated as no input, zero force. Expected: 0 but for device dropouts.
  std::int64_t bad_input = 0;
  /// Endpoint outside the field: no contact there. Expected: whenever the hand leaves the field.
  std::int64_t outside = 0;
  /// Endpoint over a cell with a hole for a corner, at or below the field's highest point: no contact there.
  std::int64_t over_hole = 0;
  /// Force cut to the limit. Expected: common when pressing hard.
  std::int64_t force_clamped = 0;
  /// Ended contact because the cell of the previous proxy became a hole. Expected: only after adopting.
  std::int64_t lost_cell = 0;
  /// Contact that began directly from outside the field or from over a hole: mostly through the side wall.
  std::int64_t side_entries = 0;
  /// Closest-point search stopped by its bound instead of by itself. Expected: never below 100 cells per
  /// tick.
  std::int64_t search_bound_hits = 0;
  /// The mean normal at a vertex pointed to the wrong side and was overruled (contact.h). Expected: spikes.
  std::int64_t mean_normal_overruled = 0;
  /// Endpoint below the surface without contact. Expected: 0 or nearly so, on spikes only.
  std::int64_t below_without_contact = 0;
  /// Edits refused because the tile pool was empty (live loop only). Expected: 0.
  std::int64_t refused_edits = 0;
  /// Most cells one closest-point search visited.
  std::int64_t longest_search = 0;
  /// Ticks in which the passivity controller changed the force. Expected: rare below the stable stiffness.
  std::int64_t passivity_ticks = 0;
  /// Net work that the applied forces did on the hand since the first tick [N mm], as the passivity observer
  /// sees it; below zero, the hand did more work than it received. Stays 0 when the scene has no observer.
  double work_on_hand_mj = 0.0;
  /// Tiles of edge snap's field for which no memory was left: no pull there until the scene is loaded again.
  std::int64_t snap_tiles_refused = 0;

  friend bool operator==(const TickCounters&, const TickCounters&) = default;
};

}  // namespace fettle::haptic
