#include "app/window/workstation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "app/window/plane_map.h"
#include "app/work/visible_part.h"
#include "engine/marks/polygon.h"

namespace fettle::app {
namespace {

using render::InputEvent;
using render::InputKind;
using render::Key;
using render::MouseButton;

constexpr double kCross_px = 16.0;  // what an arrow key moves the cross by; Shift: one eighth
constexpr int kLooks = 12;          // at the picture, each way

}  // namespace

// The surface under a place of the picture; where there is none, the plane at half the field's height.
std::optional<glm::dvec2> Workstation::fieldAt(const glm::dvec2& pixel) const {
  if (const auto picked = pick(pixel.x, pixel.y)) return glm::dvec2(picked->position_mm);
  if (!picture_) return std::nullopt;  // the device is lost
  const engine::Grid& grid = touch_->field().grid();
  const engine::HeightBounds bounds = touch_->field().reader().bounds();
  if (bounds.empty()) return std::nullopt;
  const double z =
      0.5 * (static_cast<double>(bounds.min) + static_cast<double>(bounds.max)) * grid.height_unit.mm;
  const double wide = std::max(grid.width - 1, 1) * grid.spacingXMm(),
               tall = std::max(grid.height - 1, 1) * grid.spacingYMm();
  const double reach = 0.25 * std::max(wide, tall) / view_.zoom;
  const glm::dvec2 middle{view_.centre_x * wide, view_.centre_y * tall};
  std::array<PlaneMap::Pair, 4> pairs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const glm::dvec2 place = middle + reach * glm::dvec2(i % 2 == 0 ? -1.0 : 1.0, i < 2 ? -1.0 : 1.0);
    const auto seen = picture_->pixelOf(0, {place, z});
    if (!seen) return std::nullopt;
    pairs[i] = {{seen->first + window_->pictureArea().x, seen->second + window_->pictureArea().y}, place};
  }
  const auto plane = PlaneMap::through(pairs);
  return plane ? plane->fieldAt(pixel) : std::nullopt;
}

std::vector<engine::TileRange> Workstation::seenPart() const {
  const render::Rectangle& area = window_->pictureArea();
  std::vector<Seen> seen;
  for (int y = 0; y <= kLooks; ++y)
    for (int x = 0; x <= kLooks; ++x)
      if (const auto picked =
              pick(area.x + area.width * x / double(kLooks), area.y + area.height * y / double(kLooks)))
        seen.push_back({picked->column, picked->row});
  if (seen.empty()) return {};
  const engine::Grid& grid = touch_->field().grid();
  const auto along = [](double share, int side) {
    return static_cast<std::int32_t>(std::clamp(share, 0.0, 1.0) * (side - 1));
  };
  return visiblePart(grid, seen, {along(view_.centre_x, grid.width), along(view_.centre_y, grid.height)});
}

void Workstation::beginLasso(Lasso::Shape shape) {
  chooseTool(std::nullopt);
  const render::Rectangle& area = window_->pictureArea();
  const bool inside = inPicture(last_x_, last_y_);
  lasso_.begin(shape, inside ? glm::dvec2(last_x_, last_y_)
                             : glm::dvec2(area.x + 0.5 * area.width, area.y + 0.5 * area.height));
  lasso_drawn_ = false;
}

void Workstation::finishLasso(engine::MarkChange change) {
  if (!lasso_.closes()) {
    lasso_.leave();
    return;
  }
  const std::string name = std::string(lasso_.shape() == Lasso::Shape::kBox ? "Box" : "Lasso") +
                           (change == engine::MarkChange::kUnmark ? ", unmark" : "");
  engine::Polygon polygon =
      lasso_.finish(touch_->field().grid(), [&](const glm::dvec2& pixel) { return fieldAt(pixel); });
  display_.marks = true;
  mark_edit_.ask(
      name, [polygon = std::move(polygon), change](const engine::Version& base, engine::JobControl& job) {
        return engine::markPolygon(base, polygon, change, job);
      });
}

// What the lasso does not want goes on to the others: wheel, middle button, other keys.
bool Workstation::handleLasso(const InputEvent& event) {
  const auto change = event.modifiers.control ? engine::MarkChange::kUnmark : engine::MarkChange::kMark;
  switch (event.kind) {
    case InputKind::kMove:
      if (drag_ != Drag::kNone) return false;
      if (stylus_held_ && glm::distance(lasso_.cross(), glm::dvec2(event.x, event.y)) > 0.0)
        lasso_drawn_ = true;
      lasso_.move({event.x, event.y}, stylus_held_ ? Lasso::Drawing::kYes : Lasso::Drawing::kNo);
      return stylus_held_;
    case InputKind::kButtonDown:
      if (event.panels_mouse || !inPicture(event.x, event.y) || event.modifiers.alt) return false;
      if (event.button == MouseButton::kRight) {
        finishLasso(change);
        return true;
      }
      if (event.button != MouseButton::kLeft) return false;
      lasso_.move({event.x, event.y}, Lasso::Drawing::kNo);
      lasso_drawn_ = false;
      stylus_held_ = true;
      if (lasso_.set()) {
        stylus_held_ = false;
        finishLasso(change);
      }
      return true;
    case InputKind::kButtonUp:
      if (event.button != MouseButton::kLeft || !stylus_held_) return false;
      stylus_held_ = false;
      if (lasso_.active() && lasso_drawn_ && lasso_.closes()) finishLasso(change);
      return true;
    case InputKind::kKeyDown: {
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
          if (lasso_.set()) finishLasso(change);
          return true;
        case Key::kBackspace:
          if (!lasso_.takeBack()) lasso_.leave();
          return true;
        case Key::kEnter:
        case Key::kKeypadEnter:
          finishLasso(change);
          return true;
        case Key::kEscape:
          lasso_.leave();
          stylus_held_ = false;
          return true;
        default:
          return false;
      }
    }
    default:
      return false;
  }
}

void Workstation::drawLasso() const {
  if (!lasso_.active()) return;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto at = [](const glm::dvec2& p) {
    return ImVec2(static_cast<float>(p.x), static_cast<float>(p.y));
  };
  const auto scale = static_cast<float>(window_->scale());
  std::vector<ImVec2> line;
  for (const glm::dvec2& p : lasso_.line()) line.push_back(at(p));
  // Dark under light: seen on every ground.
  for (const auto& [colour, width] :
       {std::pair{IM_COL32(0, 0, 0, 160), 4.0F}, {IM_COL32(255, 170, 40, 255), 2.0F}}) {
    if (line.size() > 1)
      list.AddPolyline(line.data(), static_cast<int>(line.size()), colour, ImDrawFlags_Closed, width * scale);
    const ImVec2 c = at(lasso_.cross());
    const float arm = 9.0F * scale;
    list.AddLine(ImVec2(c.x - arm, c.y), ImVec2(c.x + arm, c.y), colour, width * scale);
    list.AddLine(ImVec2(c.x, c.y - arm), ImVec2(c.x, c.y + arm), colour, width * scale);
  }
}

void Workstation::actOnEdges(Action action) {
  engine::EdgeChoice& choice = edges_.choice;
  const auto turn = [&](double& value, double by, double low, double high) {
    value = std::clamp(value + by, low, high);
    edges_.redraw(*touch_);
  };
  switch (action) {
    case Action::kEdges:
      display_.marks = true;
      edges_.search(*touch_);
      break;
    case Action::kEdgesMore:
    case Action::kEdgesFewer:
      turn(choice.sensitivity, action == Action::kEdgesMore ? 0.05 : -0.05, 0.0, 1.0);
      break;
    case Action::kEdgesThicker:
    case Action::kEdgesThinner:
      turn(choice.thickness, action == Action::kEdgesThicker ? 1.0 : -1.0, 0.0, 64.0);
      break;
    case Action::kEdgesCoarser:
    case Action::kEdgesFiner: {
      using engine::EdgeResponse;
      const double factor = action == Action::kEdgesCoarser ? 1.25 : 0.8;
      edges_.sigma =
          std::clamp(edges_.sigma * factor, EdgeResponse::kSmallestSigma, EdgeResponse::kLargestSigma);
      if (edges_.on()) edges_.search(*touch_);
      break;
    }
    default:
      break;
  }
}

void Workstation::pollMarking() {
  if (!(touch_->original() == marking_original_)) {
    marking_original_ = touch_->original();
    mark_edit_.cancel();
    lasso_.leave();
    edges_.drop();
    change_.begin(marking_original_);
  }
  if (mark_edit_.poll(*touch_, notices_)) stale_ = true;
  if (edges_.poll(*touch_, notices_)) stale_ = true;
}

}  // namespace fettle::app
