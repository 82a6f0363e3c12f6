#include "app/work/plane_picking.h"

namespace fettle::app {

void choosePlaneByPoints(engine::FormChoice& choice, const engine::Grid& grid) {
  choice.kind = engine::FormKind::kPlane;
  choice.robust = false;  // around the points all samples count
  if (choice.through) return;
  const glm::dvec2 size((grid.width - 1) * grid.spacingXMm(), (grid.height - 1) * grid.spacingYMm());
  choice.through = engine::ThreePoints{
      {size * glm::dvec2(0.1, 0.1), size * glm::dvec2(0.9, 0.1), size * glm::dvec2(0.5, 0.9)}};
}

void PlanePicking::begin(engine::FormChoice& choice, const engine::Grid& grid) {
  before_ = choice;
  choosePlaneByPoints(choice, grid);
  next_ = 0;
}

bool PlanePicking::take(const glm::dvec2& at_mm, engine::FormChoice& choice) {
  choice.through->at_mm[*next_] = at_mm;
  if (++*next_ < choice.through->at_mm.size()) return false;
  next_.reset();
  return true;
}

void PlanePicking::leave(engine::FormChoice& choice) {
  if (!next_) return;
  choice = before_;
  next_.reset();
}

std::span<const glm::dvec2> PlanePicking::set(const engine::FormChoice& choice) const noexcept {
  if (!choice.through) return {};
  const std::span<const glm::dvec2> all(choice.through->at_mm);
  return next_ ? all.first(*next_) : all;
}

}  // namespace fettle::app
