#include "app/window/marking.h"

#include <algorithm>
#include <string>
#include <utility>

#include <glm/geometric.hpp>

#include "engine/marks/polygon.h"

namespace fettle::app {
namespace {

using render::InputKind;
using render::Key;
using render::MouseButton;

constexpr double kCross_px = 16.0;  // by which an arrow key moves the cross; Shift: one eighth

engine::MarkChange changeOf(const render::InputEvent& event) {
  return event.modifiers.control ? engine::MarkChange::kUnmark : engine::MarkChange::kMark;
}

}  // namespace

void Marking::beginLasso(Lasso::Shape shape, const glm::dvec2& cursor, const render::Rectangle& area,
                         const WindowPicture& picture) {
  lasso_.begin(shape, picture.inside(cursor.x, cursor.y)
                          ? cursor
                          : glm::dvec2(area.x + 0.5 * area.width, area.y + 0.5 * area.height));
  drawn_ = held_ = false;
}

void Marking::leaveLasso() {
  lasso_.leave();
  held_ = false;
}

// The next line of the same shape, where the cursor is.
void Marking::beginNext() {
  lasso_.begin(lasso_.shape(), lasso_.cross());
  drawn_ = held_ = false;
}

void Marking::finish(engine::MarkChange change, const Scope& scope) {
  if (!lasso_.closes()) {
    beginNext();
    return;
  }
  const std::string name = std::string(lasso_.shape() == Lasso::Shape::kBox ? "Box" : "Lasso") +
                           (change == engine::MarkChange::kUnmark ? ", unmark" : "");
  const engine::Version& field = scope.client.field();
  const auto onSurface = [&](const glm::dvec2& pixel) {
    const auto picked = scope.picture.pick(pixel.x, pixel.y);
    return picked ? std::optional(picked->position_mm) : std::nullopt;
  };
  const auto onLevel = [&](const glm::dvec2& pixel, std::optional<double> height) {
    return scope.picture.levelAt(pixel, field, scope.view, height);
  };
  engine::Polygon polygon = lasso_.finish(field.grid(), {onSurface, onLevel});
  beginNext();
  scope.display.marks = true;
  edit.ask(name,
           [polygon = std::move(polygon), change](const engine::Version& base, engine::JobControl& job) {
             return engine::markPolygon(base, polygon, change, job);
           });
}

bool Marking::handle(const render::InputEvent& event, const Scope& scope) {
  switch (event.kind) {
    case InputKind::kMove:
      if (scope.dragging) return false;
      if (held_ && glm::distance(lasso_.cross(), glm::dvec2(event.x, event.y)) > 0.0) drawn_ = true;
      lasso_.move({event.x, event.y}, held_ ? Lasso::Drawing::kYes : Lasso::Drawing::kNo);
      return held_;
    case InputKind::kButtonDown:
      if (event.panels_mouse || !scope.picture.inside(event.x, event.y) || event.modifiers.alt) return false;
      if (event.button == MouseButton::kRight) {
        if (lasso_.line().empty()) return false;  // nothing is begun: it moves the view
        finish(changeOf(event), scope);
        return true;
      }
      if (event.button != MouseButton::kLeft) return false;
      lasso_.move({event.x, event.y}, Lasso::Drawing::kNo);
      drawn_ = false;
      held_ = !lasso_.set();
      if (!held_) finish(changeOf(event), scope);
      return true;
    case InputKind::kButtonUp:
      if (event.button != MouseButton::kLeft || !held_) return false;
      held_ = false;
      if (drawn_ && lasso_.closes()) finish(changeOf(event), scope);
      return true;
    case InputKind::kKeyDown:
      return handleKey(event, scope);
    default:
      return false;
  }
}

bool Marking::handleKey(const render::InputEvent& event, const Scope& scope) {
  const double step = event.modifiers.shift ? kCross_px / 8.0 : kCross_px;
  const auto go = [&](double dx, double dy) {
    lasso_.move(lasso_.cross() + step * glm::dvec2(dx, dy), Lasso::Drawing::kNo);
    return true;
  };
  switch (event.key) {
    case Key::kLeft:
      return go(-1.0, 0.0);
    case Key::kRight:
      return go(1.0, 0.0);
    case Key::kUp:
      return go(0.0, -1.0);
    case Key::kDown:
      return go(0.0, 1.0);
    case Key::kSpace:
      if (lasso_.set()) finish(changeOf(event), scope);
      return true;
    case Key::kBackspace:
      return lasso_.takeBack();
    case Key::kEnter:
    case Key::kKeypadEnter:
      if (lasso_.line().empty()) return false;  // it applies what is previewed
      finish(changeOf(event), scope);
      return true;
    case Key::kEscape:
      leaveLasso();
      return true;
    default:
      return false;
  }
}

void Marking::turnChoice(double engine::EdgeChoice::*number, double by, double high,
                         const LoopClient& client) {
  double& value = edges.choice.*number;
  value = std::clamp(value + by, 0.0, high);
  edges.redraw(client);
}

void Marking::scaleEdges(double factor, const LoopClient& client) {
  using engine::EdgeResponse;
  edges.sigma = std::clamp(edges.sigma * factor, EdgeResponse::kSmallestSigma, EdgeResponse::kLargestSigma);
  if (edges.on()) edges.search(client);
}

bool Marking::poll(LoopClient& client, bool draw_lines, std::vector<Notice>& notices) {
  lines.follow(client, edit, draw_lines);
  bool changed = edit.poll(client, notices);
  changed |= edges.poll(client, notices);
  return places.poll(client, notices) || changed;
}

void Marking::reset() {
  edit.cancel();
  leaveLasso();
  edges.drop();
  places.drop();
  lines.choose(std::nullopt);
}

}  // namespace fettle::app
