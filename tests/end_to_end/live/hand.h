#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "haptic/devices/wooden/wooden_config.h"
#include "tests/haptic/devices/fake_hidapi/fake_woody.h"

namespace fettle::tests {

/// Encoder counts, from those of the home pose on, at which the stylus of woody_v2015 is at this place of the
/// desk [mm], to the nearest count.
[[nodiscard]] std::array<std::int32_t, 3> countsAt(const glm::dvec3& desk_mm);

/// The force that these currents put on the hand there [N], desk frame; counts from those of the home pose
/// on.
[[nodiscard]] glm::dvec3 forceOf(const std::array<std::int16_t, 3>& ma,
                                 const std::array<std::int32_t, 3>& counts);

/// What the device saw of a session, by its own clock: the proof that does not take the program's word.
struct Felt {
  double peak_n = 0.0;
  int peak_ma = 0;
  /// Largest change of the force from one report to the next, over the time between them, of which 1 ms
  /// counts at least (reports of a busy machine come in bursts) and 2 at most: a device holds what it has, so
  /// a step is a step however long ago the report before was.
  double rate_n_per_ms = 0.0;
  double rise_n = 0.0;  ///< largest rise of the force from one report to the next
  /// Most by which rises ran ahead of the slew limit over any time, each report counting for 1 ms at least
  /// [N].
  double ahead_n = 0.0;
  std::size_t reports = 0;
};
[[nodiscard]] Felt feltIn(const std::vector<fake::WoodyCurrents>& history, double slew_n_per_ms,
                          std::size_t from = 0);

}  // namespace fettle::tests
