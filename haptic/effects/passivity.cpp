#include "haptic/effects/passivity.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "haptic/base/force.h"

namespace fettle::haptic {

namespace {

void runPassivity(void* data, TickState& state) noexcept {
  static_cast<Passivity*>(data)->run(state);
}
void resetPassivity(void* data, ResetCause why) noexcept {
  // A contact that ended or a surface that was replaced is in the balance already.
  if (why == ResetCause::kInputLost) static_cast<Passivity*>(data)->inputLost();
}

}  // namespace

void Passivity::run(TickState& state) noexcept {
  // dt is 0 where the step does not measure a speed (VelocityFilter): in a jump or a gap the hand did not
  // move against the force, so it is neither counted nor damped.
  const double dt_s = state.motion->dt();
  const bool moved = known_ && dt_s > 0.0;
  const glm::dvec3 step = moved ? state.endpoint_mm - at_mm_ : glm::dvec3(0.0);
  if (moved) {
    const double work_mj = glm::dot(given_n_, step);
    state.counters.work_on_hand_mj += work_mj;
    balance_mj_ = std::max(balance_mj_ + work_mj, -state.stored_mj);
  }
  glm::dvec3 force_n = state.force_n - state.weight_n;
  const double length = glm::length(step);
  if (length > 0.0 && balance_mj_ + glm::dot(force_n, step) > 0.0) {
    const glm::dvec3 along = step / length;
    const double driving_n = glm::dot(force_n, along);
    const double least_n = std::min(driving_n, 0.0) - brake_ * length / dt_s;
    force_n += (std::max(-balance_mj_ / length, least_n) - driving_n) * along;
    const ClampedForce clamped = clampForce(force_n + state.weight_n, state.force_limit_n);
    state.force_n = clamped.force_n;
    force_n = state.force_n - state.weight_n;
    ++state.counters.passivity_ticks;
  }
  given_n_ = force_n;
  at_mm_ = state.endpoint_mm;
  known_ = true;
}

void addPassivity(EffectList& list, const EffectSource& from) {
  Passivity& passivity =
      addData(list, EffectKind::kPassivity, std::make_shared<Passivity>(from.scene.params.passivity));
  list.finishing.push_back({&runPassivity, &passivity});
  list.resets.push_back({&resetPassivity, &passivity});
  needMotion(list, from.scene);
}

}  // namespace fettle::haptic
