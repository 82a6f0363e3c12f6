#include "app/window/section_drag.h"

#include <algorithm>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "app/window/drags.h"

namespace fettle::app {

namespace {

using render::InputKind;

bool holdsAll(const render::InputEvent& event) {
  return event.modifiers == render::Modifiers{.control = true, .shift = true, .alt = false};
}

double distanceToLine(const glm::dvec2& place, const KeptSection& section) {
  const glm::dvec2 along = section.to - section.from;
  const double square = glm::dot(along, along);
  const double t = square > 0.0 ? std::clamp(glm::dot(place - section.from, along) / square, 0.0, 1.0) : 0.0;
  return glm::distance(place, section.from + t * along);
}

}  // namespace

std::optional<glm::dvec2> SectionDrag::placeOf(const render::InputEvent& event, const Scope& scope) {
  if (event.panels_mouse || !scope.picture.inside(event.x, event.y)) return std::nullopt;
  return scope.picture.fieldAt({event.x, event.y}, scope.field, scope.view);
}

std::optional<SectionDrag::Found> SectionDrag::find(const glm::dvec2& place_mm, const Scope& scope) {
  const double grip_mm = kGrip_px * scope.picture.mmPerPixel();
  std::optional<Found> found;
  // Ends lie on top of lines, and those of the chosen section on top of all.
  enum Rank : std::uint8_t { kLine, kEnd, kChosenEnd };
  std::pair<Rank, double> best{kLine, -grip_mm};
  const auto look = [&](std::size_t i, Part part, Rank rank, double distance_mm) {
    if (distance_mm > grip_mm || std::pair(rank, -distance_mm) < best) return;
    best = {rank, -distance_mm};
    found = Found{i, part};
  };
  for (std::size_t i = 0; i < scope.sections.sections().size(); ++i) {
    const KeptSection& section = scope.sections.sections()[i];
    const Rank end = scope.sections.chosen() == i ? kChosenEnd : kEnd;
    look(i, Part::kLine, kLine, distanceToLine(place_mm, section));
    look(i, Part::kFrom, end, glm::distance(place_mm, section.from));
    look(i, Part::kTo, end, glm::distance(place_mm, section.to));
  }
  return found;
}

std::optional<SectionDrag::Found> SectionDrag::grasp(const render::InputEvent& event, const Scope& scope) {
  if (event.kind != InputKind::kButtonDown || event.button != render::MouseButton::kLeft) return std::nullopt;
  const bool plain = event.modifiers == render::Modifiers{} && !scope.tool_on;
  if ((!plain && !holdsAll(event)) || scope.sections.sections().empty()) return std::nullopt;
  const auto place = placeOf(event, scope);
  const auto found = place ? find(*place, scope) : std::nullopt;
  // A plain button turns the view: it takes hold only of what is drawn as a handle.
  if (found && plain && (found->part == Part::kLine || scope.sections.chosen() != found->section))
    return std::nullopt;
  return found;
}

bool SectionDrag::begins(const render::InputEvent& event, const Scope& scope) {
  return grasp(event, scope).has_value();
}

void SectionDrag::move(const glm::dvec2& place_mm, const engine::Version& field,
                       SectionTool& sections) const {
  if (sections.section() == nullptr) return;
  KeptSection moved = *sections.section();
  const engine::Grid& grid = field.grid();
  const glm::dvec2 last((grid.width - 1) * grid.spacingXMm(), (grid.height - 1) * grid.spacingYMm());
  const KeptSection& before = held_->before;
  // Not beyond the field: an end out there could be neither seen nor taken hold of again.
  const glm::dvec2 low = held_->part == Part::kTo     ? before.to
                         : held_->part == Part::kFrom ? before.from
                                                      : glm::min(before.from, before.to),
                   high = held_->part == Part::kLine ? glm::max(before.from, before.to) : low;
  const glm::dvec2 by = glm::clamp(place_mm - held_->grip_mm, glm::min(-low, glm::dvec2(0.0)),
                                   glm::max(last - high, glm::dvec2(0.0)));
  if (held_->part != Part::kTo) moved.from = held_->before.from + by;
  if (held_->part != Part::kFrom) moved.to = held_->before.to + by;
  sections.set(moved);
}

bool SectionDrag::handle(const render::InputEvent& event, const Scope& scope) {
  if (held_ && event.kind == InputKind::kMove) {
    if (const auto place = placeOf(event, scope)) move(*place, scope.field, scope.sections);
    return true;
  }
  if (event.button != render::MouseButton::kLeft) return false;
  if (event.kind == InputKind::kButtonDown) {
    pressed_.reset();
    if (const auto found = grasp(event, scope)) {
      scope.sections.choose(found->section);
      held_ = Held{found->part, *placeOf(event, scope), *scope.sections.section()};
      return true;
    }
    if (event.modifiers == render::Modifiers{} && !scope.tool_on && placeOf(event, scope))
      pressed_ = {event.x, event.y};
    return false;
  }
  if (event.kind != InputKind::kButtonUp) return false;
  const auto pressed = std::exchange(pressed_, std::nullopt);
  if (std::exchange(held_, std::nullopt)) return true;
  if (pressed && glm::distance(*pressed, {event.x, event.y}) <= kClick_px)
    if (const auto place = placeOf(event, scope))
      if (const auto found = find(*place, scope)) scope.sections.choose(found->section);
  return false;
}

void SectionDrag::stop() noexcept {
  held_.reset();
  pressed_.reset();
}

void SectionDrag::cancel(SectionTool& sections) {
  if (held_ && sections.section() != nullptr) sections.set(held_->before);
  stop();
}

}  // namespace fettle::app
