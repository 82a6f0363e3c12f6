#pragma once

#include <cstdint>
#include <string>

#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "haptic/base/strokes.h"
#include "haptic/loop/messages.h"

namespace fettle::app {

/// Something that happened in a session, with its time [s] since the first tick.
struct SessionEvent {
  double t = 0.0;
  std::string what;    ///< "armed", "fault: unplugged", "stroke kept" ...
  std::string remedy;  ///< what the user may do; may be empty
};

/// Figures of the forces sent to the device.
struct GivenForce {
  double peak_n = 0.0;
  double rate_n_per_ms = 0.0;  ///< largest change of the vector between two ticks, over the time between them
  double rise_n_per_ms = 0.0;  ///< likewise of its length, increases only
};

/// Writes the records of a session from the loop's ring to the disk. One thread, not the loop's.
class SessionLog {
 public:
  /// `strokes` outlives this.
  explicit SessionLog(haptic::StrokesWriter& strokes) : strokes_(strokes) {}

  /// Errors: those of the strokes file (full disk); rows after one are not written.
  [[nodiscard]] engine::Status add(const haptic::TickRecord& record);
  /// Once per second of session time, passes added rows to the operating system; cheap, may be called often.
  [[nodiscard]] engine::Status flushIfDue();

  [[nodiscard]] std::int64_t rows() const noexcept { return rows_; }
  [[nodiscard]] double seconds() const noexcept { return last_t_; }
  [[nodiscard]] const GivenForce& given() const noexcept { return given_; }

 private:
  haptic::StrokesWriter& strokes_;
  GivenForce given_;
  glm::dvec3 last_n_{0.0};
  double last_t_ = 0.0;
  double flushed_t_ = 0.0;
  std::int64_t rows_ = 0;
};

}  // namespace fettle::app
