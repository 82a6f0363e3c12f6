#include "tests/end_to_end/live/hand.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "haptic/devices/wooden/wooden_kinematics.h"

namespace fettle::tests {

namespace {

const haptic::WoodenConfig& config() {
  static const haptic::WoodenConfig c = *haptic::wooden("woody_v2015");
  return c;
}

// Counts from zero, as woodenAngles takes them.
std::array<std::int32_t, 3> fromHome(std::array<std::int32_t, 3> counts) {
  for (std::size_t i = 0; i < 3; ++i) counts[i] += config().calibrate_enc[i];
  return counts;
}

}  // namespace

std::array<std::int32_t, 3> countsAt(const glm::dvec3& desk_mm) {
  const glm::dvec3 wanted = 1e-3 * haptic::deskToWooden(desk_mm);
  std::array<std::int32_t, 3> home = fromHome({});
  glm::dvec3 angles = haptic::woodenAngles(config(), home);
  // Newton's method; half steps, since the home pose may be far.
  for (int i = 0; i < 60; ++i) {
    const glm::dvec3 miss = wanted - haptic::woodenPosition(config(), angles);
    angles += 0.5 * (glm::inverse(haptic::woodenJacobian(config(), angles)) * miss);
  }
  // woodenAngles is linear in the counts: one count's angle in each body gives its inverse.
  const glm::dvec3 zero = haptic::woodenAngles(config(), {0, 0, 0});
  const glm::dvec3 one = haptic::woodenAngles(config(), {1, 1, 1}) - zero;
  std::array<std::int32_t, 3> counts{};
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    counts[at] = static_cast<std::int32_t>(std::lround((angles[i] - zero[i]) / one[i])) - home[at];
  }
  return counts;
}

glm::dvec3 forceOf(const std::array<std::int16_t, 3>& ma, const std::array<std::int32_t, 3>& counts) {
  const glm::dvec3 angles = haptic::woodenAngles(config(), fromHome(counts));
  // woodenCurrents is a factor a body: its inverse from unit torques.
  const glm::dvec3 per_nm = haptic::woodenCurrents(config(), glm::dvec3{1.0});
  const glm::dvec3 torques = glm::dvec3{ma[0], ma[1], ma[2]} / per_nm;
  const glm::dmat3 jacobian = haptic::woodenJacobian(config(), angles);
  return haptic::woodenToDesk(glm::inverse(glm::transpose(jacobian)) * torques);
}

Felt feltIn(const std::vector<fake::WoodyCurrents>& history, double slew_n_per_ms, std::size_t from) {
  Felt felt;
  double ahead_n = 0.0;
  glm::dvec3 last{0.0};
  for (std::size_t i = from; i < history.size(); ++i) {
    const fake::WoodyCurrents& now = history[i];
    const glm::dvec3 force = forceOf(now.ma, now.counts);
    felt.peak_n = std::max(felt.peak_n, glm::length(force));
    for (const std::int16_t ma : now.ma)
      felt.peak_ma = std::max(felt.peak_ma, std::abs(static_cast<int>(ma)));
    if (i > from && now.by == fake::WoodyCurrents::By::kOutput) {
      const double apart = std::chrono::duration<double, std::milli>(now.at - history[i - 1].at).count();
      const double ms = std::clamp(apart, 1.0, 2.0);
      felt.rate_n_per_ms = std::max(felt.rate_n_per_ms, glm::length(force - last) / ms);
      const double rise_n = glm::length(force) - glm::length(last);
      felt.rise_n = std::max(felt.rise_n, rise_n);
      ahead_n = std::max(ahead_n + rise_n - slew_n_per_ms * std::max(apart, 1.0), 0.0);
      felt.ahead_n = std::max(felt.ahead_n, ahead_n);
    }
    last = force;
    ++felt.reports;
  }
  return felt;
}

}  // namespace fettle::tests
