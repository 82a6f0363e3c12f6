#include "haptic/effects/effect.h"

namespace fettle::haptic {

namespace {

struct Viscosity {
  double damping_n_s_per_mm;

  static void run(void* data, TickState& state) noexcept {
    state.force_n -= static_cast<const Viscosity*>(data)->damping_n_s_per_mm * state.motion->mmPerS();
  }
};

}  // namespace

// A viscous medium: F = -b v of the endpoint, v from VelocityFilter (delay T / 2 + tau).
//
// Source: Rosenberg and Adelstein, "Perceptual decomposition of virtual haptic surfaces" (1993), damping as
// one of a surface's parts; the sampled damper: Colgate and Schenkel (1994/1997).
// Stability. A mass m in nothing but the medium, force held for T, filter weight a = T / (T + tau): with
// beta = b T / m the characteristic polynomial is
//   z^2 + (a beta / 2 - 2 + a) z + (1 - a + a beta / 2),
// by Jury's test stable exactly for beta < 2, whatever the filter:
//   b < 2 m / T      (0.1 kg at 1 kHz: 0.2 N s/mm).
// In touch with a wall K, the device must damp b_device > K T / 2 + b a / (2 - a) for passivity (Colgate
// and Schenkel's condition at the Nyquist frequency, where the filtered difference is weighted so).
// What a device allows is in its profile: max_damping_n_s_per_mm; stability.h compares.
// No state of its own. Cost: three multiplications, and the filter's ten shared with coupling.
void addViscosity(EffectList& list, const EffectSource& from) {
  const ViscosityParams& params = from.scene.params.viscosity;
  Viscosity& viscosity = addData(list, EffectKind::kViscosity,
                                 std::make_shared<Viscosity>(Viscosity{params.damping_n_s_per_mm}));
  auto& where = params.medium == ViscousMedium::kEverywhere ? list.always : list.in_contact;
  where.push_back({&Viscosity::run, &viscosity});
  needMotion(list, from.scene);
}

}  // namespace fettle::haptic
