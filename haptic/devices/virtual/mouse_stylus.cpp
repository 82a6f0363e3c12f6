#include "haptic/devices/virtual/mouse_stylus.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/stopwatch.h"
#include "haptic/base/force.h"

namespace fettle::haptic {

// Requests that may wait: a thousand cursor positions per second for eight seconds in which the loop does not
// run.
constexpr std::size_t kRequests = 8192;
// Of them reserved for buttons: cursor positions between two others can be omitted.
constexpr std::size_t kButtonPlaces = 64;
// The positions of one frame of the window are followed over this many ticks.
constexpr std::size_t kSpreadTicks = 8;
// Arrived: at most this part of the distance's scale is left.
constexpr double kArrived = 0.05;

constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

namespace {

// The turn that brings z there; of half a turn, where that leaves the axis open, about x. Nothing for no direction.
std::optional<glm::dquat> turnOfZ(const glm::dvec3& direction) noexcept {
  const glm::dvec3 to = glm::normalize(direction);
  if (!finite(to)) return std::nullopt;
  const double w = 1.0 + to.z;
  if (w < 1e-9) return glm::dquat(0.0, 1.0, 0.0, 0.0);
  return glm::normalize(glm::dquat(w, -to.y, to.x, 0.0));
}

}  // namespace

MouseStylus::MouseStylus(const MouseFeel& feel) : feel_(feel), requests_(kRequests) {
  profile_.name = "mouse";
  profile_.space = DeviceSpace::kField;
  profile_.workspace_radius_mm = 1e9;  // the field is its workspace
  profile_.max_force_n = 0.0;
  profile_.gives_force = false;
  request_.press_mm = depth_mm_ = std::clamp(feel.press_mm, 0.0, feel.deepest_mm);
}

void MouseStylus::send() noexcept {
  // A ring without a place for a button belongs to a loop that has stopped: nothing needs to be sent again.
  sent_ += requests_.push(Request(request_)) ? 1 : 0;
}

void MouseStylus::setCursor(const glm::dvec3& p) noexcept {
  if (!finite(p)) {
    leave();
    return;
  }
  if (request_.over && request_.surface_mm == p) return;
  request_.surface_mm = p;
  request_.over = true;
  if (requests_.freePlaces() > kButtonPlaces) send();
}

void MouseStylus::leave() noexcept {
  if (!request_.over) return;
  request_.over = false;
  send();
}

void MouseStylus::press(Tool tool) noexcept {
  request_.held = true;
  request_.tool = tool;
  send();
}

void MouseStylus::release() noexcept {
  if (!request_.held) return;
  request_.held = false;
  send();
}

void MouseStylus::wheel(double steps) noexcept {
  if (!std::isfinite(steps)) return;
  depth_mm_ = std::clamp(depth_mm_ - steps * feel_.wheel_step_mm, 0.0, feel_.deepest_mm);
  request_.press_mm = share_ * depth_mm_;
  if (requests_.freePlaces() > kButtonPlaces) send();
}

void MouseStylus::hold(const std::optional<PenHold>& pen) noexcept {
  const double share = pen && std::isfinite(pen->share) ? std::clamp(pen->share, 0.0, 1.0) : 1.0;
  const std::optional<glm::dquat> orientation = pen && pen->to_hand ? turnOfZ(*pen->to_hand) : std::nullopt;
  if (share == share_ && orientation == request_.orientation) return;
  share_ = share;
  request_.press_mm = share_ * depth_mm_;
  request_.orientation = orientation;
  if (requests_.freePlaces() > kButtonPlaces) send();
}

DeviceInput MouseStylus::read() noexcept {
  return readAt(engine::steadyNs());
}

bool MouseStylus::accept(const Request& request) noexcept {
  switch (stage_) {
    case Stage::kHover:
      now_ = request;
      if (request.held && request.over) stage_ = Stage::kLifted;
      return true;
    case Stage::kLifted:
    case Stage::kLanding:
    case Stage::kEnding:
      return false;
    case Stage::kStroke:
      if (!request.held) {
        now_.held = false;
        stage_ = Stage::kEnding;
        return true;
      }
      now_ = {request.surface_mm, request.press_mm, now_.tool, request.over, true, request.orientation};
      return true;
  }
  return true;
}

void MouseStylus::takeRequests() noexcept {
  const std::size_t waiting = requests_.waiting() + (has_next_ ? 1 : 0);
  // While hovering, positions between are not part of a stroke and may be skipped; a press always ends the
  // loop.
  for (std::size_t most = stage_ == Stage::kStroke ? 1 + waiting / kSpreadTicks : waiting; most > 0; --most) {
    if (!has_next_ && !requests_.pop(next_)) return;
    has_next_ = !accept(next_);
    if (has_next_) return;
    ++accepted_;
  }
}

void MouseStylus::move(double passed_s) noexcept {
  if (stage_ == Stage::kLifted) {
    input_.position_mm = glm::dvec3(kNowhere);
    input_.buttons = 0;
    input_.tool.reset();
    tip_mm_ = now_.surface_mm + glm::dvec3{0.0, 0.0, feel_.hover_mm};
    stage_ = Stage::kLanding;
    return;
  }
  const bool stroke = stage_ != Stage::kHover;
  const glm::dvec3 target =
      now_.surface_mm + glm::dvec3{0.0, 0.0, stroke && now_.over ? -now_.press_mm : feel_.hover_mm};
  const bool smooth = stage_ == Stage::kHover || stage_ == Stage::kStroke;
  // First-order follow, exact for any step: stable however late the loop is.
  tip_mm_ += (target - tip_mm_) * -std::expm1(-passed_s / (smooth ? feel_.follow_s : feel_.land_s));
  input_.position_mm = tip_mm_;
  input_.buttons = stroke ? kPrimaryButton : 0;
  input_.tool = stroke ? std::optional(now_.tool) : std::nullopt;
  input_.orientation = now_.orientation;

  const glm::dvec3 left = target - tip_mm_;
  if (stage_ == Stage::kLanding && std::abs(left.z) < kArrived * (feel_.hover_mm + now_.press_mm))
    stage_ = Stage::kStroke;
  else if (stage_ == Stage::kEnding && isThere())
    stage_ = Stage::kHover;
}

bool MouseStylus::isThere() const noexcept {
  const glm::dvec3 left = now_.surface_mm - tip_mm_;
  return !now_.over || std::hypot(left.x, left.y) < kArrived * feel_.hover_mm;
}

DeviceInput MouseStylus::readAt(std::int64_t now_ns) noexcept {
  const double passed_s =
      last_read_ns_ == 0 ? 0.0 : std::max(1e-9 * static_cast<double>(now_ns - last_read_ns_), 0.0);
  last_read_ns_ = now_ns;
  takeRequests();
  if (!now_.over && !placed_) {  // never was over the field: no position yet
    followed_.store(accepted_, std::memory_order_release);
    return input_;
  }
  if (!placed_) {
    // Comes down from the hover height, wherever it first appears.
    tip_mm_ = now_.surface_mm + glm::dvec3{0.0, 0.0, feel_.hover_mm};
    placed_ = true;
  }
  move(passed_s);
  if (stage_ == Stage::kHover && isThere()) followed_.store(accepted_, std::memory_order_release);
  input_.link = LinkState::kConnected;
  input_.arrival_ns = now_ns;
  ++input_.sequence;
  return input_;
}

}  // namespace fettle::haptic
