#include "app/work/through_noise.h"

#include "app/work/section_noise.h"
#include "engine/measure/three_point_errors.h"

namespace fettle::app {

engine::Status addThroughNoise(engine::FittedForm& fit, const engine::Version& field,
                               const engine::FormChoice& choice, engine::JobControl& job) {
  if (!fit.through || !choice.through) return {};
  const auto noise = sectionNoiseOf(field, job);
  if (!noise) return tl::unexpected(noise.error());
  engine::addLineErrors(*fit.through, field, *choice.through, choice.region, *noise);
  return {};
}

}  // namespace fettle::app
