#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "app/live/live_terminal.h"
#include "app/live/session_log.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "haptic/devices/device.h"
#include "haptic/loop/haptic_loop.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

/// How force is allowed. The user of a force device must allow it, at the start and after each fault: only
/// the user knows whether the hand holds the stylus and where it is.
enum class ArmPolicy : std::uint8_t {
  kByKey,  ///< the key 'a'
  kAuto,   ///< automatically: devices without force and simulated ones
};

struct LiveSettings {
  haptic::HapticLoop::Settings loop;
  ArmPolicy arm = ArmPolicy::kByKey;
  KeySource keys = KeySource::kTerminal;
  double seconds = 0.0;          ///< ends after this time; 0 = no limit
  std::uint64_t most_ticks = 0;  ///< ends after this number of ticks; 0 = no limit
};

struct LiveOutcome {
  engine::Version field;   ///< at the end of the session, upright
  std::string ended_by;    ///< "time", "end of the strokes", "key", "signal"
  haptic::LoopState last;  ///< the last tick
  haptic::RealTimeReport granted;
  haptic::TimingFigures lateness;
  haptic::TimingFigures compute;
  std::uint64_t missed = 0;
  std::uint64_t over_1_ms = 0;
  haptic::DeviceCounters device;
  std::vector<SessionEvent> events;
};

/// "f feel, s smooth, ...": the keys of the tools, with a text between two of them.
[[nodiscard]] std::string toolKeys(std::string_view between);

/// A live session without a window: the loop on its thread, records to `log`, keys, status and events, until
/// time, strokes, a key or a signal (job.cancelled()) ends it; then the force is faded out before the loop
/// stops.
///
///   a arm   d disarm   c calibrate (stylus held in its home pose)
///   the keys of the tools (haptic/base/tools.h)   q end
///
/// Errors: those of HapticLoop::create and start, of the device, of the strokes file. Thread: main; blocks.
[[nodiscard]] engine::Result<LiveOutcome> runLive(const engine::Version& start,
                                                  const engine::Version& original, const haptic::Scene& scene,
                                                  haptic::Device& device, const LiveSettings& settings,
                                                  SessionLog& log, const engine::JobControl& job);

}  // namespace fettle::app
