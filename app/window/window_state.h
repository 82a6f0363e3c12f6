#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/report.h"
#include "app/window/event_log.h"
#include "app/window/input.h"
#include "app/window/parts.h"

namespace fettle::app {

/// Of the headset (`--xr`).
struct HeadsetFigures {
  std::string name;                ///< empty without one
  std::uint64_t frames = 0;        ///< drawn
  bool over = false;               ///< its session has ended
  bool stands = false;             ///< its frames stay away
  bool true_size = false;          ///< chosen, rather than a giant's
  double metres_per_mm = 0.0;      ///< of the field in the room; 0: it is not placed yet
  std::optional<std::size_t> tip;  ///< the hand that is the tip, 0 left, 1 right
  bool points = false;             ///< a hand points at the window's frame
  std::vector<std::string> validation;
};

/// Figures of the window's report in addition to its parts.
struct RunFigures {
  std::uint64_t frames = 0;  ///< shown
  int device_losses = 0;
  HeadsetFigures headset{};
  std::int64_t shown_ns = 0;  ///< the last frame: engine::steadyNs() when it was passed to the window system
};

/// Whether somebody acts, or something moves: the next frame follows immediately.
[[nodiscard]] bool actsNow(const Parts& parts, const Input& input);
/// Or something must be drawn.
[[nodiscard]] bool isActive(const Parts& parts, const Input& input);

/// The visible state of the window, for scripts and tests that drive it by keys and mouse and must know when
/// the result of their input is on the screen. Keys are stable. Lengths are pixels of the frame, "cursor" and
/// "picture" from its upper left corner.
[[nodiscard]] Report windowState(const Parts& parts, const Input& input, const RunFigures& run);
/// Writes it to the log when it has changed, with the texts on the screen. After each frame.
void logState(EventLog& log, const Parts& parts, const Input& input, const RunFigures& run);

/// The report of `fettle view` at its end.
[[nodiscard]] Report runReport(const Parts& parts, const RunFigures& run);
/// Adds to it what is known of the headset, once its session has ended.
void noteHeadset(const HeadsetFigures& headset, Report& report);

}  // namespace fettle::app
