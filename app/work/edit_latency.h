#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "haptic/loop/messages.h"
#include "haptic/loop/timing.h"

namespace fettle::app {

/// Edit to pixel: time from an edit to the frame on the screen that shows it. Threading: main.
class EditLatency {
 public:
  /// An event of the loop with an edit; `newest` is the loop's newest state.
  void noteEdit(const haptic::LoopEvent& event, const haptic::LoopState& newest, double rate_hz);
  /// Any event, after noteEdit().
  void noteEvent(const haptic::LoopEvent& event);
  /// A new loop starts, with its own count of ticks.
  void restart() noexcept { last_event_tick_ = 0; }

  /// Earliest possible time [steady_clock ns] of the edits in the live field that no earlier call returned;
  /// empty when there is none. Too early by at most the loop's period of publication.
  [[nodiscard]] std::optional<std::int64_t> takeUnshownEdit() noexcept {
    return std::exchange(unshown_ns_, std::nullopt);
  }
  /// A frame with all edits of such a time was on the screen at `shown_ns`.
  void noteShown(std::int64_t edit_ns, std::int64_t shown_ns);

  [[nodiscard]] const haptic::TimingHistogram& histogram() const noexcept { return latency_; }
  [[nodiscard]] double lastMs() const noexcept { return last_ms_; }

 private:
  std::optional<std::int64_t> unshown_ns_;
  std::uint64_t last_event_tick_ = 0;
  haptic::TimingHistogram latency_;
  double last_ms_ = 0.0;
};

}  // namespace fettle::app
