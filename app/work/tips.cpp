#include "app/work/tips.h"

#include <utility>

#include "haptic/contact/sphere_tip.h"
#include "haptic/trials/contact_trial.h"

namespace fettle::app {

ChosenTip nextTip(haptic::Scene scene, const engine::Grid& grid) {
  const double radius_mm = scene.tip == haptic::TipShape::kSphere ? scene.tip_radius_mm : 0.0;
  const trials::ContactChoice* next = nullptr;
  double next_mm = 0.0;
  for (const trials::ContactChoice& choice : trials::contactChoices()) {
    const haptic::Scene with = choice.in(scene, grid);
    if (with.tip != haptic::TipShape::kSphere || choice.search_rounds != haptic::defaultScene().search_rounds)
      continue;
    const double mm = with.tip_radius_mm;
    if (!(mm > radius_mm) || (next != nullptr && mm >= next_mm) || haptic::sphereProblem(mm, grid)) continue;
    next = &choice;
    next_mm = mm;
  }
  if (next != nullptr) {
    scene.tip = haptic::TipShape::kSphere;
    scene.tip_radius_mm = next_mm;
    return {std::move(scene), next->name};
  }
  scene.tip = haptic::TipShape::kPoint;
  // The rounds of a ball's steps: level paper has no fewer than all.
  if (scene.level == haptic::ContactLevel::kPaper) scene.search_rounds = haptic::defaultScene().search_rounds;
  return {std::move(scene), "point"};
}

}  // namespace fettle::app
