#include "haptic/effects/viscosity.h"

namespace fettle::haptic {

namespace {

struct Viscosity {
  double damping_n_s_per_mm;

  static void run(void* data, TickState& state) noexcept {
    state.force_n -= static_cast<const Viscosity*>(data)->damping_n_s_per_mm * state.motion->mmPerS();
  }
};

}  // namespace

void addViscosity(EffectList& list, const EffectSource& from) {
  const ViscosityParams& params = from.scene.params.viscosity;
  Viscosity& viscosity = addData(list, EffectKind::kViscosity,
                                 std::make_shared<Viscosity>(Viscosity{params.damping_n_s_per_mm}));
  auto& where = params.medium == ViscousMedium::kEverywhere ? list.always : list.in_contact;
  where.push_back({&Viscosity::run, &viscosity});
  needMotion(list, from.scene);
}

}  // namespace fettle::haptic
