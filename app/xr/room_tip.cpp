#include "app/xr/room_tip.h"

#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "engine/base/stopwatch.h"

namespace fettle::app {
namespace {

constexpr double kPen_m = 0.14;                       // of a hand's pen
constexpr double kFullForce_m = 0.08;                 // of the arrow of the largest force
constexpr std::int64_t kTouchLasts_ns = 100'000'000;  // as the vibration lasts (render/xr/hands)
constexpr float kPen_px = 6.0F, kPenRim_px = 9.0F;
constexpr glm::vec3 kRim{0.01F, 0.01F, 0.01F}, kOtherHand{0.25F, 0.25F, 0.28F};

void appendPen(const glm::dvec3& tip_mm, const glm::dvec3& tail_mm, const glm::vec3& colour,
               std::vector<render::OverlayLine>& lines) {
  constexpr auto kInScene = render::OverlayLine::Depth::kInScene;
  lines.push_back({tip_mm, tail_mm, kRim, 1.0F, kPenRim_px, kInScene});
  lines.push_back({tip_mm, tail_mm, colour, 1.0F, kPen_px, kInScene});
}

}  // namespace

void RoomTip::leave() {
  hand_.reset();
  pressed_ = false;
  touched_ = {};
  if (!link_) return;
  haptic::ControllerHand none;
  none.press = press_;
  link_->hand.publish(none);
}

// Whether the room's coordinates are others on the field than in the last frame, but for what hands that hold it do.
bool RoomTip::jumps(const RoomTable& table, const render::Framing& framing) {
  const Coordinates now{table.placements(), framing.first, framing.reference_mm, framing.exaggeration};
  const Coordinates before = std::exchange(coordinates_, now);
  return before != now;
}

void RoomTip::follow(const render::RoomHands& hands, const RoomHandUses& uses, const RoomTable& table,
                     const render::Framing& framing, std::uint64_t reader) {
  if (!link_) return;
  const bool presses = uses.tip() && uses.tip()->pressed;
  const bool jumped = jumps(table, framing);
  jumps_ += jumped ? 1 : 0;
  // A stroke does not go on elsewhere: what is pressed then has to be pressed again.
  spent_ = presses && (jumped || spent_);
  if (!uses.tip() || !table.placed()) {
    leave();
    return;
  }
  hand_ = uses.tip()->hand;
  pressed_ = presses && !spent_;
  const render::RoomPose& aim = hands[*hand_].aim;
  const auto axis = [&](const glm::dvec3& own) { return table.directionInScene(aim.turn * own); };
  haptic::ControllerHand hand;
  hand.tip = true;
  hand.pressed = pressed_;
  hand.press = press_ = uses.tip()->press + jumps_;
  hand.reader = reader;
  hand.when_ns = engine::steadyNs();
  hand.position_mm = framing.fieldOf(table.sceneOf(aim.position_m));
  // Its z runs from the tip to the hand, as that of an aim pose does.
  hand.orientation = glm::normalize(
      glm::quat_cast(glm::dmat3(axis({1.0, 0.0, 0.0}), axis({0.0, 1.0, 0.0}), axis({0.0, 0.0, 1.0}))));
  link_->hand.publish(hand);
  if (link_->touched.take()) touched_ = link_->touched.latest();
  // A loop that stands still touches nothing.
  if (hand.when_ns - touched_.when_ns > kTouchLasts_ns) touched_ = {};
}

std::optional<std::size_t> RoomTip::hand() const noexcept {
  return leads() ? hand_ : std::nullopt;
}

double RoomTip::vibration(std::size_t hand) const noexcept {
  return this->hand() == hand ? touched_.strength : 0.0;
}

bool RoomTip::works() const noexcept {
  return hand() && (pressed_ || touched_.contact);
}

void RoomTip::append(const render::RoomHands& hands, const RoomTable& table, const render::Framing& framing,
                     const TipLook& look, render::Overlays& overlays) const {
  const auto field = [&](const glm::dvec3& room_m) { return framing.fieldOf(table.sceneOf(room_m)); };
  for (std::size_t i = 0; i < hands.size(); ++i) {
    if (!hands[i].tracked) continue;
    const render::RoomPose& aim = hands[i].aim;
    const glm::dvec3 pen_m = aim.turn * glm::dvec3(0.0, 0.0, kPen_m);
    if (hand() != i) {
      appendPen(field(aim.position_m), field(aim.position_m + pen_m), kOtherHand, overlays.lines);
      continue;
    }
    // In contact the hand is under the surface: the pen stands on it.
    const glm::dvec3 at_mm = field(aim.position_m);
    const glm::dvec3 tip_mm = touched_.contact ? touched_.proxy_mm : at_mm;
    appendPen(tip_mm, field(table.roomOf(framing.sceneOf(tip_mm)) + pen_m), look.colour, overlays.lines);
    render::StylusState tip;
    tip.endpoint_mm = at_mm;
    tip.proxy_mm = tip_mm;
    tip.force_n = touched_.force_n;
    tip.contact = touched_.contact;
    tip.tip_radius_mm = look.ball_radius_mm;
    const double newton = glm::length(touched_.force_n);
    const double arrow_mm = kFullForce_m * touched_.strength / table.metresPerMm();
    render::appendStylus(tip, newton > 0.0 ? arrow_mm / newton : 0.0, overlays.lines);
    overlays.rings.push_back({tip_mm.x, tip_mm.y, look.ring_mm, look.colour, 2.0F});
  }
}

}  // namespace fettle::app
