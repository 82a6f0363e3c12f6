#include "haptic/tick/tick.h"

#include "haptic/base/force.h"

namespace fettle::haptic {

Tick::Tick(const Scene& scene, engine::LiveField& field, const engine::Version& original)
    : field_(field),
      surface_(field.reader()),
      tracker_(scene.level, scene.certified_radius_cells, scene.search_rounds),
      sphere_(scene.tip == TipShape::kSphere
                  ? std::make_unique<SphereTracker>(scene.tip_radius_mm, field.reader().grid(),
                                                    scene.search_rounds - 1, SphereSearch::kBounded,
                                                    scene.ball_searches, scene.ball_minima, scene.ball_steps,
                                                    scene.ball_work)
                  : nullptr),
      effects_(composeEffects(scene, original, field.snapshot())),
      force_limit_n_(scene.force_limit_n) {}

void Tick::reset(ResetCause why) noexcept {
  for (const EffectReset& reset : effects_.resets) reset.run(reset.data, why);
}

void Tick::fieldChanged() noexcept {
  surface_.refresh(field_.reader());
  reset(ResetCause::kFieldChanged);
}

ForceSample Tick::run(const StrokeSample& input) noexcept {
  ForceSample out{input.t, input.tip_mm, glm::dvec3(0.0), false};
  if (!finite(input.tip_mm)) {
    ++counters_.bad_input;
    tracker_.reset();
    if (sphere_) sphere_->reset();
    contact_ = {};
    weight_n_ = glm::dvec3(0.0);
    if (effects_.motion) effects_.motion->reset();
    reset(ResetCause::kInputLost);
    return out;
  }
  const bool was_touching = contact_.touching;
  if (sphere_)
    contact_ = sphere_->update(surface_, input.tip_mm, counters_);
  else
    tracker_.update(surface_, input.tip_mm, counters_, contact_);
  if (effects_.motion) effects_.motion->update(input.t, input.tip_mm);
  if (!contact_.touching) {
    if (was_touching) reset(ResetCause::kContactEnded);
    if (effects_.onlyInContact()) return out;
  }

  TickState state{contact_, field_, surface_, counters_};
  state.t_s = input.t;
  state.endpoint_mm = input.tip_mm;
  state.motion = effects_.motion ? &*effects_.motion : nullptr;
  state.force_limit_n = force_limit_n_;
  if (contact_.touching)
    for (const EffectStep& effect : effects_.in_contact) effect.run(effect.data, state);
  for (const EffectStep& effect : effects_.always) effect.run(effect.data, state);
  const ClampedForce clamped = clampForce(state.force_n, force_limit_n_);
  counters_.force_clamped += clamped.clamped ? 1 : 0;
  // With the spring alone the two are the same number.
  state.strength =
      state.force_n == state.press_n ? clamped.strength : clampForce(state.press_n, force_limit_n_).strength;
  state.force_n = clamped.force_n;
  weight_n_ = state.weight_n;
  for (const EffectStep& effect : effects_.finishing) effect.run(effect.data, state);
  out.force_n = state.force_n;
  if (contact_.touching) {
    if (const EffectStep& tool = effects_.tools[static_cast<std::size_t>(input.tool)]; tool.run != nullptr)
      tool.run(tool.data, state);
    out.proxy_mm = contact_.proxy.position_mm;
    out.contact = true;
  }
  for (const EffectStep& effect : effects_.upkeep) effect.run(effect.data, state);
  return out;
}

}  // namespace fettle::haptic
