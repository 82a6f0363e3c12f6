#pragma once

#include "app/live/session_log.h"
#include "haptic/loop/messages.h"
#include "haptic/loop/timing.h"

namespace fettle::app {

/// Output of a live session: one line on stderr that is updated, when stderr is a terminal, and a line for
/// each event; nothing with Voice::quiet. One thread.
class StatusLine {
 public:
  StatusLine();
  ~StatusLine();  ///< wipes the line
  StatusLine& operator=(StatusLine&&) = delete;

  /// Redraws at most five times per second. `ticks_per_second` as measured.
  void show(const haptic::LoopState& state, const haptic::LoopTiming& timing, double seconds,
            double ticks_per_second);
  void report(const SessionEvent& event);

 private:
  void wipe();

  bool terminal_ = false;
  double shown_at_ = -1.0;
};

}  // namespace fettle::app
