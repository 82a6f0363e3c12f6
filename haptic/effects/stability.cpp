#include "haptic/effects/stability.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace fettle::haptic {

namespace {

bool lists(const Scene& scene, EffectKind kind) noexcept {
  return std::find(scene.effects.begin(), scene.effects.end(), kind) != scene.effects.end();
}

}  // namespace

StabilityNeed stabilityNeed(const Scene& scene, double rate_hz) noexcept {
  using std::numbers::pi;
  const EffectParams& params = scene.params;
  double across = 0.0, along = 0.0;
  if (lists(scene, EffectKind::kSpring)) across = scene.stiffness_n_per_mm;
  if (lists(scene, EffectKind::kTexture)) {
    const double wave = pi / params.texture.wavelength_mm;
    const double slope = params.texture.amplitude_mm * wave;
    across += scene.stiffness_n_per_mm * slope * slope +
              scene.force_limit_n * 1.02 * 2.0 * params.texture.amplitude_mm * wave * wave;
  }
  if (lists(scene, EffectKind::kFriction)) along += params.friction.stiffness_n_per_mm;
  if (lists(scene, EffectKind::kEdgeSnap))
    along += 4.0 * params.edge_snap.force_n / params.edge_snap.reach_mm;

  StabilityNeed need;
  need.stiffness_n_per_mm = std::max(across, along);
  double filtered = 0.0;
  if (lists(scene, EffectKind::kViscosity)) filtered += params.viscosity.damping_n_s_per_mm;
  if (lists(scene, EffectKind::kCoupling)) filtered += params.coupling.damping_n_s_per_mm;
  need.damping_n_s_per_mm = filtered;
  if (lists(scene, EffectKind::kPassivity))
    need.damping_n_s_per_mm += params.passivity.max_damping_n_s_per_mm;
  const double a = 1.0 / (1.0 + 1e-3 * params.velocity.filter_ms * rate_hz);
  need.device_damping_n_s_per_mm = need.stiffness_n_per_mm / (2.0 * rate_hz) + filtered * a / (2.0 - a);
  return need;
}

std::optional<std::string> stabilityProblem(const Scene& scene, const DeviceProfile& profile,
                                            double rate_hz) {
  const StabilityNeed need = stabilityNeed(scene, rate_hz);
  const double holds = profile.max_stiffness_n_per_mm * rate_hz / 1000.0;
  if (need.stiffness_n_per_mm > holds)
    return fmt::format("the scene is up to {:.3g} N/mm stiff, the {} holds {:.3g} at {:.0f} Hz: it may buzz",
                       need.stiffness_n_per_mm, profile.name, holds, rate_hz);
  if (need.damping_n_s_per_mm > profile.max_damping_n_s_per_mm)
    return fmt::format("the scene damps with up to {:.3g} N s/mm, the {} takes {:.3g}: it may buzz",
                       need.damping_n_s_per_mm, profile.name, profile.max_damping_n_s_per_mm);
  return std::nullopt;
}

}  // namespace fettle::haptic
