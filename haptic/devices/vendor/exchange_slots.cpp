#include "haptic/devices/vendor/exchange_slots.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include <glm/geometric.hpp>

#include "engine/base/stopwatch.h"

namespace fettle::haptic {

namespace {

// As OutputTimes::stale_after: the loop that computed the force hangs, is stopped in a debugger or has ended.
constexpr std::int64_t kForceStaleNs = 10'000'000;
// No arm of a desk device reaches so far: a number beyond it is an error of the device or its library.
constexpr double kFarthestMm = 2000.0;

void countOne(std::atomic<std::uint64_t>& counter) noexcept {
  counter.fetch_add(1, std::memory_order_relaxed);
}

bool isFinite(const glm::dvec3& v) noexcept {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

ExchangeSlots::ExchangeSlots() {
  sem_init(&work_, 0, 0);
}

ExchangeSlots::~ExchangeSlots() {
  sem_destroy(&work_);
}

DeviceInput ExchangeSlots::read() noexcept {
  input_.take();
  DeviceInput input = input_.latest();
  input.output_pending = published_ns_ != sent_ns_.load(std::memory_order_relaxed);
  // Without a device nothing waits for it: what was written meanwhile is not held against it when it comes.
  if (input.link == LinkState::kDisconnected)
    waiting_since_ns_ = engine::steadyNs();
  else if (input.output_pending)
    input.output_waits_ns = std::max<std::int64_t>(engine::steadyNs() - waiting_since_ns_, 0);
  return input;
}

void ExchangeSlots::write(const glm::dvec3& force_n) noexcept {
  const std::int64_t now = engine::steadyNs();
  if (published_ns_ == sent_ns_.load(std::memory_order_relaxed)) waiting_since_ns_ = now;
  published_ns_ = now;
  output_.publish({isFinite(force_n) ? force_n : glm::dvec3{0.0}, published_ns_});
  // One futex call at most, and only when the link sleeps; never waits.
  sem_post(&work_);
}

void ExchangeSlots::opened(LinkState state, double max_force_n) noexcept {
  max_force_n_ = std::isfinite(max_force_n) ? std::max(max_force_n, 0.0) : 0.0;
  calibration_requested_.store(false, std::memory_order_relaxed);  // requested before there was a device
  newest_.link = state;
  newest_.buttons = 0;
  countOne(connects_);
  zero_when_held_.arm();
  input_.publish(newest_);
}

void ExchangeSlots::setState(LinkState state) noexcept {
  newest_.link = state;
}

void ExchangeSlots::lost() noexcept {
  exchange_since_.store(0, std::memory_order_relaxed);
  zero_when_held_.disarm();
  if (newest_.link == LinkState::kDisconnected) return;
  newest_.link = LinkState::kDisconnected;
  newest_.buttons = 0;
  if (!stopping()) countOne(disconnects_);
  input_.publish(newest_);
}

glm::dvec3 ExchangeSlots::forceToSend() noexcept {
  const std::int64_t now = engine::steadyNs();
  exchange_since_.store(now, std::memory_order_relaxed);
  output_.take();
  const Output& output = output_.latest();
  sending_ns_ = output.written_ns;
  const bool stale = now - output.written_ns >= kForceStaleNs;
  const bool allowed = newest_.link == LinkState::kConnected && !stopping() && !devicesHeldAtZero();
  sending_forced_zero_ = stale;
  sending_zero_ = true;
  if (stale || !allowed) return glm::dvec3{0.0};
  sending_zero_ = false;
  const double length = glm::length(output.force_n);
  if (length <= max_force_n_) return output.force_n;
  countOne(scaled_forces_);
  return output.force_n * (max_force_n_ / length);
}

void ExchangeSlots::sent() noexcept {
  const std::int64_t took = engine::steadyNs() - exchange_since_.load(std::memory_order_relaxed);
  exchange_since_.store(0, std::memory_order_relaxed);
  // No compare-and-swap: only the link writes it.
  longest_output_ns_.store(std::max(took, longest_output_ns_.load(std::memory_order_relaxed)),
                           std::memory_order_relaxed);
  sent_ns_.store(sending_ns_, std::memory_order_relaxed);
  countOne(outputs_);
  if (sending_forced_zero_) countOne(forced_zeros_);
  if (sending_zero_) zero_when_held_.zeroSent();
}

void ExchangeSlots::notSent() noexcept {
  exchange_since_.store(0, std::memory_order_relaxed);
  countOne(failed_outputs_);
}

void ExchangeSlots::takeInput(const glm::dvec3& position_mm, std::uint32_t buttons,
                              const std::optional<glm::dquat>& orientation) noexcept {
  if (!isFinite(position_mm) || glm::length(position_mm) > kFarthestMm) {
    badInput();
    return;
  }
  newest_.position_mm = position_mm;
  newest_.buttons = buttons;
  newest_.orientation = orientation;
  newest_.sequence = inputs_.fetch_add(1, std::memory_order_relaxed) + 1;
  newest_.arrival_ns = engine::steadyNs();
  input_.publish(newest_);
}

void ExchangeSlots::badInput() noexcept {
  countOne(bad_inputs_);
}

void ExchangeSlots::fault() noexcept {
  countOne(faults_);
}

void ExchangeSlots::waitForForce(std::int64_t until_ns) noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const timespec at{.tv_sec = until_ns / kSecond, .tv_nsec = until_ns % kSecond};
  if (sem_clockwait(&work_, CLOCK_MONOTONIC, &at) != 0) return;
  while (sem_trywait(&work_) == 0) {  // several wake-ups are handled at once
  }
}

bool ExchangeSlots::waitWhileRunning(std::int64_t for_ns) noexcept {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::nanoseconds(for_ns), [this] { return stopping(); });
  return !stopping();
}

void ExchangeSlots::start() noexcept {
  const std::lock_guard lock(mutex_);
  stopping_.store(false, std::memory_order_relaxed);
  ended_ = false;
}

void ExchangeSlots::requestStop() noexcept {
  {
    const std::lock_guard lock(mutex_);
    stopping_.store(true, std::memory_order_relaxed);
  }
  changed_.notify_all();
  sem_post(&work_);
}

void ExchangeSlots::ended() noexcept {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
}

bool ExchangeSlots::waitEnded(std::int64_t for_ns) noexcept {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::nanoseconds(for_ns), [this] { return ended_; });
}

DeviceCounters ExchangeSlots::counters() const noexcept {
  DeviceCounters c;
  c.inputs = inputs_.load(std::memory_order_relaxed);
  c.bad_inputs = bad_inputs_.load(std::memory_order_relaxed);
  c.outputs = outputs_.load(std::memory_order_relaxed);
  c.forced_zeros = forced_zeros_.load(std::memory_order_relaxed);
  c.failed_outputs = failed_outputs_.load(std::memory_order_relaxed);
  c.scaled_forces = scaled_forces_.load(std::memory_order_relaxed);
  c.faults = faults_.load(std::memory_order_relaxed);
  c.connects = connects_.load(std::memory_order_relaxed);
  c.disconnects = disconnects_.load(std::memory_order_relaxed);
  c.longest_output_ns = longest_output_ns_.load(std::memory_order_relaxed);
  return c;
}

}  // namespace fettle::haptic
