#include "haptic/tick.h"

#include <cmath>

#include "haptic/force.h"

namespace fettle::haptic {

Tick::Tick(const Scene& scene, engine::LiveField& field, const engine::Version& original)
    : field_(field),
      surface_(field.reader()),
      tracker_(scene.level, scene.certified_radius_cells),
      effects_(composeEffects(scene, original)),
      force_limit_n_(scene.force_limit_n) {}

ForceSample Tick::run(const StrokeSample& input) noexcept {
  ForceSample out{input.t, input.tip_mm, glm::dvec3(0.0), false};
  if (!(std::isfinite(input.tip_mm.x) && std::isfinite(input.tip_mm.y) && std::isfinite(input.tip_mm.z))) {
    ++counters_.bad_input;
    tracker_.reset();
    contact_ = {};
    return out;
  }
  contact_ = tracker_.update(surface_, input.tip_mm, counters_);
  if (!contact_.touching) return out;

  TickState state{contact_, field_, surface_, counters_};
  for (const EffectStep& effect : effects_.forces) effect.run(effect.data, state);
  const ClampedForce clamped = clampForce(state.force_n, force_limit_n_);
  counters_.force_clamped += clamped.clamped ? 1 : 0;
  state.force_n = clamped.force_n;
  state.strength = clamped.strength;
  if (const EffectStep& tool = effects_.tools[static_cast<std::size_t>(input.tool)]; tool.run != nullptr)
    tool.run(tool.data, state);
  out.proxy_mm = contact_.proxy.position_mm;
  out.force_n = clamped.force_n;
  out.contact = true;
  return out;
}

}  // namespace fettle::haptic
