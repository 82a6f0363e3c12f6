#include "haptic/devices/vendor/force_exchange.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "engine/base/stopwatch.h"
#include "haptic/devices/emergency_zero.h"

namespace fettle::haptic {

namespace {

constexpr std::int64_t kStaleAfterNs = 10'000'000;  // as OutputTimes::stale_after
constexpr double kFarthestMm = 10'000.0;

void add(std::atomic<std::uint64_t>& counter) noexcept {
  counter.fetch_add(1, std::memory_order_relaxed);
}

bool isFinite(const glm::dvec3& v) noexcept {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

DeviceInput ForceExchange::read() noexcept {
  input_.take();
  DeviceInput input = input_.latest();
  input.output_pending = written_ns_ != sent_ns_.load(std::memory_order_relaxed);
  // Without a device nothing waits for it: what was written meanwhile is not held against it when it comes.
  if (input.link != LinkState::kConnected)
    waiting_since_ns_ = engine::steadyNs();
  else if (input.output_pending)
    input.output_waits_ns = std::max<std::int64_t>(engine::steadyNs() - waiting_since_ns_, 0);
  return input;
}

void ForceExchange::write(const glm::dvec3& force_n) noexcept {
  const std::int64_t now = engine::steadyNs();
  if (written_ns_ == sent_ns_.load(std::memory_order_relaxed)) waiting_since_ns_ = now;
  written_ns_ = now;
  output_.publish({isFinite(force_n) ? force_n : glm::dvec3{0.0}, now});
  written_.post();
}

glm::dvec3 ForceExchange::force(std::int64_t now_ns) noexcept {
  output_.take();
  const Output& output = output_.latest();
  taken_ns_ = output.written_ns;
  const bool recent = output.written_ns != 0 && now_ns - output.written_ns < kStaleAfterNs;
  zero_for_want_ = !recent;
  if (!recent || newest_.link != LinkState::kConnected || devicesHeldAtZero()) return glm::dvec3{0.0};
  return output.force_n;
}

void ForceExchange::sent(bool accepted) noexcept {
  if (!accepted) return add(failed_outputs_);
  add(outputs_);
  if (zero_for_want_) add(forced_zeros_);
  sent_ns_.store(taken_ns_, std::memory_order_relaxed);
}

bool ForceExchange::received(const glm::dvec3& position_mm, std::uint32_t buttons,
                             std::int64_t now_ns) noexcept {
  if (!isFinite(position_mm) || glm::length(position_mm) > kFarthestMm) {
    add(bad_inputs_);
    return false;
  }
  newest_.position_mm = position_mm;
  newest_.buttons = buttons;
  newest_.arrival_ns = now_ns;
  newest_.sequence = inputs_.fetch_add(1, std::memory_order_relaxed) + 1;
  input_.publish(newest_);
  return true;
}

void ForceExchange::setLink(LinkState link) noexcept {
  if (link == newest_.link) return;
  if (link == LinkState::kConnected) add(connects_);
  if (newest_.link == LinkState::kConnected) add(disconnects_);
  newest_.link = link;
  if (link == LinkState::kDisconnected) newest_.buttons = 0;
  input_.publish(newest_);
}

void ForceExchange::fault() noexcept {
  add(faults_);
}

DeviceCounters ForceExchange::counters() const noexcept {
  DeviceCounters c;
  c.inputs = inputs_.load(std::memory_order_relaxed);
  c.bad_inputs = bad_inputs_.load(std::memory_order_relaxed);
  c.outputs = outputs_.load(std::memory_order_relaxed);
  c.forced_zeros = forced_zeros_.load(std::memory_order_relaxed);
  c.failed_outputs = failed_outputs_.load(std::memory_order_relaxed);
  c.faults = faults_.load(std::memory_order_relaxed);
  c.connects = connects_.load(std::memory_order_relaxed);
  c.disconnects = disconnects_.load(std::memory_order_relaxed);
  return c;
}

}  // namespace fettle::haptic
