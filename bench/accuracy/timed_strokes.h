#pragma once

#include <span>
#include <vector>

#include "bench/accuracy/drawn_scan.h"
#include "engine/suggest/worth_places.h"

namespace fettle::bench {

/// A stroke with the time of the person who draws one after the other [s]. Without points: a place where the person
/// saw no edge.
struct TimedStroke {
  engine::EdgeStroke stroke;
  double begins_s = 0.0;  ///< after the way to it
  double ends_s = 0.0;
};

/// A person who goes to one place after the other, and draws along the true edge there as far as the place shows it.
/// Places where no true edge is seen cost the way to them. `drawn` is the same person's hand along all edges.
[[nodiscard]] std::vector<TimedStroke> strokesAtPlaces(const engine::SimulatedScan& scan,
                                                       const DrawnEdges& drawn,
                                                       std::span<const engine::WorthPlace> places,
                                                       double reach_s);

/// A person who draws along all true edges, the longest first.
[[nodiscard]] std::vector<TimedStroke> strokesByLength(const engine::SimulatedScan& scan,
                                                       const DrawnEdges& drawn, double reach_s);

/// What is drawn after so many seconds; the last stroke may be unfinished.
[[nodiscard]] std::vector<engine::EdgeStroke> drawnUntil(std::span<const TimedStroke> strokes,
                                                         double seconds);

}  // namespace fettle::bench
