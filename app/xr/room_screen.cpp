#include "app/xr/room_screen.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

namespace fettle::app {
namespace {

// Before the head and under it: behind a table that is looked down at.
constexpr double kScreenAhead_m = 1.15, kScreenUnder_m = 0.1;
constexpr double kRay_m = 0.004, kSpot_m = 0.02;

}  // namespace

void RoomScreen::place(const render::RoomPose& head) {
  const glm::dvec3 ahead = head.turn * glm::dvec3(0.0, 0.0, -1.0);
  const double yaw = std::hypot(ahead.x, ahead.z) > 1e-3 ? std::atan2(-ahead.x, -ahead.z) : 0.0;
  pose_.turn = glm::dquat(std::cos(0.5 * yaw), 0.0, std::sin(0.5 * yaw), 0.0);
  pose_.position_m = head.position_m + pose_.turn * glm::dvec3(0.0, -kScreenUnder_m, -kScreenAhead_m);
  placed_ = true;
}

void RoomScreen::setShape(int width_px, int height_px) noexcept {
  height_m_ = width_m_ * std::max(height_px, 1) / std::max(width_px, 1);
}

std::optional<ScreenPoint> RoomScreen::beside(const render::RoomPose& aim) const noexcept {
  if (!placed_) return std::nullopt;
  const glm::dquat back = glm::conjugate(pose_.turn);
  const glm::dvec3 from = back * (aim.position_m - pose_.position_m);
  const glm::dvec3 along = back * (aim.turn * glm::dvec3(0.0, 0.0, -1.0));
  // From its front alone, and not along it.
  if (from.z <= 0.0 || along.z > -1e-3) return std::nullopt;
  const glm::dvec3 hit = from - (from.z / along.z) * along;
  return ScreenPoint{hit.x / width_m_ + 0.5, 0.5 - hit.y / height_m_, pose_.position_m + pose_.turn * hit};
}

std::optional<ScreenPoint> RoomScreen::under(const render::RoomPose& aim) const noexcept {
  const auto point = beside(aim);
  const auto inside = [](double share) { return share >= 0.0 && share <= 1.0; };
  return point && inside(point->x) && inside(point->y) ? point : std::nullopt;
}

void RoomScreen::carry(const render::RoomPose& before, const render::RoomPose& now) noexcept {
  const glm::dquat turn = now.turn * glm::conjugate(before.turn);
  pose_.position_m = now.position_m + turn * (pose_.position_m - before.position_m);
  pose_.turn = glm::normalize(turn * pose_.turn);
}

render::RoomPanel RoomScreen::panel() const noexcept {
  return {render::RoomPicture::kWindow, pose_, width_m_, height_m_};
}

render::RoomPanel RoomScreen::ray(const glm::dvec3& from, const glm::dvec3& to,
                                  const glm::dvec3& head) noexcept {
  const glm::dvec3 middle = 0.5 * (from + to);
  const double length = std::max(glm::length(to - from), 1e-6);
  const glm::dvec3 along = (to - from) / length;
  // Its flat side to the head, which sees all of its width.
  glm::dvec3 front = (head - middle) - glm::dot(head - middle, along) * along;
  if (glm::length(front) < 1e-6) front = std::abs(along.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  front = glm::normalize(front - glm::dot(front, along) * along);
  const glm::dmat3 axes(glm::cross(along, front), along, front);
  return {render::RoomPicture::kRay, {middle, glm::normalize(glm::quat_cast(axes))}, kRay_m, length};
}

render::RoomPanel RoomScreen::spot(const glm::dvec3& at) const noexcept {
  return {render::RoomPicture::kSpot, {at, pose_.turn}, kSpot_m, kSpot_m};
}

}  // namespace fettle::app
