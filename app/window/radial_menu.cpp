#include "app/window/radial_menu.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace fettle::app {
namespace {

using render::InputKind;
using render::Key;
using render::MouseButton;

constexpr std::size_t kItemCount = RadialMenu::kItems.size();

constexpr double kBesideBorder_px = 4.0;  // at scale 1

// In one direction, where there is room; else the middle.
double inside(double at, int low, int length, double before, double after) {
  return length > before + after ? std::clamp(at, low + before, low + length - after)
                                 : low + 0.5 * (length + before - after);
}

}  // namespace

void RadialMenu::open(const glm::dvec2& cursor, const render::Rectangle& picture, double scale, By by) {
  active_ = true;
  held_ = by;
  of_device_ = by == By::kDevice;
  was_pointed_ = false;
  pointed_.reset();
  scale_ = scale;
  middle_ = cursor;
  picture_ = picture;
}

glm::dvec2 RadialMenu::drawnAt(const Reach& names) const noexcept {
  const double border = kBesideBorder_px * scale_;
  return {inside(middle_.x, picture_.x, picture_.width, names.left + border, names.right + border),
          inside(middle_.y, picture_.y, picture_.height, names.up + border, names.down + border)};
}

void RadialMenu::point(const glm::dvec2& cursor) noexcept {
  const glm::dvec2 off = cursor - middle_;
  pointed_.reset();
  if (glm::length(off) < kMiddle_px * scale_) return;
  // Clockwise from the top, as shares of a turn.
  const double turn = std::atan2(off.x, -off.y) / (2.0 * std::numbers::pi);
  const auto nearest = std::lround(turn * static_cast<double>(kItemCount));
  pointed_ = static_cast<std::size_t>(nearest + static_cast<long>(kItemCount)) % kItemCount;
  was_pointed_ = true;
}

// One item further on the shorter way; at once from the middle.
void RadialMenu::turnTo(std::size_t item) noexcept {
  was_pointed_ = true;
  if (!pointed_) {
    pointed_ = item;
    return;
  }
  const std::size_t way = (item + kItemCount - *pointed_) % kItemCount;
  if (way != 0) pointed_ = (*pointed_ + (way <= kItemCount / 2 ? 1 : kItemCount - 1)) % kItemCount;
}

RadialMenu::Outcome RadialMenu::choose() noexcept {
  close();
  return {true, pointed_ ? std::optional(kItems[*pointed_].action) : std::nullopt};
}

RadialMenu::Outcome RadialMenu::release() noexcept {
  held_.reset();
  if (!was_pointed_) return {true};  // a tap
  return choose();
}

RadialMenu::Outcome RadialMenu::press(const render::InputEvent& event) {
  switch (event.key) {
    case Key::kUp:
      turnTo(0);
      return {true};
    case Key::kRight:
      turnTo(kItemCount / 4);
      return {true};
    case Key::kDown:
      turnTo(kItemCount / 2);
      return {true};
    case Key::kLeft:
      turnTo(3 * kItemCount / 4);
      return {true};
    case Key::kEnter:
    case Key::kKeypadEnter:
      return choose();
    case kKey:
      return event.repeat || held_ == By::kKey ? Outcome{true} : choose();
    case Key::kEscape:
      close();
      return {true};
    default:
      // What the key does elsewhere.
      close();
      return {};
  }
}

RadialMenu::Outcome RadialMenu::handle(const render::InputEvent& event) {
  if (!active_) return {};
  switch (event.kind) {
    case InputKind::kMove:
      if (!of_device_) point({event.x, event.y});
      return {true};
    case InputKind::kKeyDown:
      return press(event);
    case InputKind::kKeyUp:
      return event.key == kKey && held_ == By::kKey ? release() : Outcome{true};
    case InputKind::kButtonUp:
      return event.button == MouseButton::kRight && held_ == By::kButton ? release() : Outcome{true};
    case InputKind::kButtonDown:
      point({event.x, event.y});
      return choose();
    case InputKind::kWheel:
    case InputKind::kLeave:
      break;
  }
  return {true};
}

}  // namespace fettle::app
