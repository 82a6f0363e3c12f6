#include "haptic/effects/friction.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace fettle::haptic {

namespace {

constexpr double kRest_s = 0.020;  // without slipping, after which a tip sticks again
constexpr double kTurnedBack = 0.5;
// A tip at rest is where it slipped to, apart from rounding.
constexpr double kRelativeTolerance = 1.0 + 1e-9;

void runFriction(void* data, TickState& state) noexcept {
  static_cast<Friction*>(data)->run(state);
}
void resetFriction(void* data, ResetCause /*why*/) noexcept {
  static_cast<Friction*>(data)->reset();
}

}  // namespace

Friction::Friction(const FrictionParams& params) noexcept
    : static_(params.static_coefficient),
      dynamic_(params.dynamic_coefficient),
      stiffness_(params.stiffness_n_per_mm) {}

void Friction::run(TickState& state) noexcept {
  const double press = glm::length(state.press_n);
  // Negated: a NaN press counts as none.
  if (!(press > 0.0 && std::isfinite(press))) return reset();
  const glm::dvec3 normal = state.press_n / press;
  if (!anchored_) {
    anchored_ = true;
    slipping_ = false;
    anchor_mm_ = state.endpoint_mm;
    return;
  }
  const double holding_n = std::min(press, state.force_limit_n);
  glm::dvec3 strain = state.endpoint_mm - anchor_mm_;
  strain -= normal * glm::dot(strain, normal);
  const double pull_n = stiffness_ * glm::length(strain);
  const double slide_n = dynamic_ * holding_n;
  if (slipping_ && (pull_n < kTurnedBack * slide_n ||
                    (pull_n <= kRelativeTolerance * slide_n && state.t_s - slip_t_s_ >= kRest_s)))
    slipping_ = false;
  if (pull_n > kRelativeTolerance * (slipping_ ? slide_n : static_ * holding_n)) {
    // A fast hand is beyond the break-away force within one tick, which friction never gave.
    if (!slipping_) state.released_n = static_ * holding_n - slide_n;
    slipping_ = true;
    slip_t_s_ = state.t_s;
    strain *= slide_n / pull_n;
  }
  anchor_mm_ = state.endpoint_mm - strain;
  state.slipping = slipping_;
  state.force_n -= stiffness_ * strain;
  state.stored_mj += 0.5 * stiffness_ * glm::dot(strain, strain);
}

void addFriction(EffectList& list, const EffectSource& from) {
  Friction& friction =
      addData(list, EffectKind::kFriction, std::make_shared<Friction>(from.scene.params.friction));
  list.in_contact.push_back({&runFriction, &friction});
  list.resets.push_back({&resetFriction, &friction});
}

}  // namespace fettle::haptic
