#include "app/work/edit_latency.h"

#include <algorithm>

#include "haptic/loop/loop_tick.h"

namespace fettle::app {

void EditLatency::noteEdit(const haptic::LoopEvent& event, const haptic::LoopState& newest, double rate_hz) {
  // Made after the event before was published, and at the earliest one period of publication ago for each
  // publication merged into this one.
  const double period_ns = 1e9 / rate_hz;
  const std::uint64_t periods = haptic::LoopOptions::kPublishTicks * (std::uint64_t{event.merged} + 1);
  const std::uint64_t first = std::max(last_event_tick_, event.tick > periods ? event.tick - periods : 0);
  const double ago = newest.tick > first ? static_cast<double>(newest.tick - first) * period_ns : 0.0;
  const std::int64_t made = newest.time_ns - static_cast<std::int64_t>(ago);
  if (!unshown_ns_ || made < *unshown_ns_) unshown_ns_ = made;
}

void EditLatency::noteEvent(const haptic::LoopEvent& event) {
  last_event_tick_ = std::max(last_event_tick_, event.tick);
}

void EditLatency::noteShown(std::int64_t edit_ns, std::int64_t shown_ns) {
  latency_.add(shown_ns - edit_ns);
  last_ms_ = 1e-6 * static_cast<double>(shown_ns - edit_ns);
}

}  // namespace fettle::app
