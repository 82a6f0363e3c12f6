#include "haptic/devices/virtual/controller_stylus.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/stopwatch.h"
#include "haptic/base/force.h"

namespace fettle::haptic {
namespace {

// About a frame of a headset: shorter, and the tip would move in steps; longer, and it would lag behind the hand.
constexpr double kFollows_s = 0.012;
constexpr std::int64_t kFramesStayAway_ns = std::chrono::nanoseconds(kFramesStayAway).count();

}  // namespace

ControllerStylus::ControllerStylus(const MouseFeel& feel, std::shared_ptr<ControllerLink> link)
    : mouse_(feel),
      link_(std::move(link)),
      profile_(mouse_.profile()),
      number_(link_->reader.fetch_add(1, std::memory_order_relaxed) + 1) {
  profile_.name = "mouse and controllers";
}

void ControllerStylus::lead(bool leads) noexcept {
  if (leads_ && !leads) spent_press_ = press_;
  leads_ = leads;
  tip_mm_.reset();
  link_->leads.store(leads, std::memory_order_relaxed);
}

void ControllerStylus::stop() noexcept {
  chosen_ = false;
  lead(false);
  spent_press_.reset();
  link_->touched.publish({});
}

void ControllerStylus::show(const Touched& touched) noexcept {
  link_->touched.publish(leads_ ? touched : Touched{});
}

DeviceInput ControllerStylus::read() noexcept {
  return readAt(engine::steadyNs());
}

DeviceInput ControllerStylus::numbered(DeviceInput input) noexcept {
  input.sequence = ++sequence_;
  return input;
}

DeviceInput ControllerStylus::readAt(std::int64_t now_ns) noexcept {
  const double passed_s = 1e-9 * static_cast<double>(std::max<std::int64_t>(now_ns - last_read_ns_, 0));
  last_read_ns_ = now_ns;
  // Also while it does not lead: what the window asks of it is completed.
  DeviceInput mouse = mouse_.readAt(now_ns);
  static_cast<void>(link_->hand.take());
  const ControllerHand& hand = link_->hand.latest();
  if (!spent_press_ || link_->asked.load(std::memory_order_relaxed)) spent_press_ = hand.press;
  const bool seen = hand.tip && hand.reader == number_ && now_ns - hand.when_ns < kFramesStayAway_ns &&
                    finite(hand.position_mm);
  const bool presses = seen && hand.pressed && hand.press != *spent_press_;
  const bool mouse_presses = mouse.buttons != 0;
  // Where neither presses, or both do, all stays as it is.
  if (presses != mouse_presses) chosen_ = presses;
  DeviceInput lifted;
  lifted.position_mm = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
  lifted.link = LinkState::kConnected;
  lifted.arrival_ns = now_ns;
  if (const bool leads = chosen_ && seen; leads != leads_) {
    lead(leads);
    press_ = hand.press;
    return numbered(lifted);
  }
  // A mouse that was never over the field after a hand has led: there is no tip, and nothing was unplugged.
  if (!leads_ && sequence_ > 0 && mouse.link != LinkState::kConnected) return numbered(lifted);
  if (!leads_) {
    const bool newer = std::exchange(mouse_sequence_, mouse.sequence) != mouse.sequence;
    if (newer) return numbered(mouse);
    mouse.sequence = sequence_;
    return mouse;
  }
  if (std::exchange(press_, hand.press) != hand.press) {
    tip_mm_.reset();
    return numbered(lifted);
  }
  // First-order follow, exact for any step: stable however late the loop is.
  tip_mm_ = tip_mm_ ? *tip_mm_ + (hand.position_mm - *tip_mm_) * -std::expm1(-passed_s / kFollows_s)
                    : hand.position_mm;
  DeviceInput input;
  input.position_mm = *tip_mm_;
  input.buttons = presses ? kPrimaryButton : 0U;
  input.orientation = hand.orientation;
  input.link = LinkState::kConnected;
  input.arrival_ns = now_ns;
  return numbered(input);
}

}  // namespace fettle::haptic
