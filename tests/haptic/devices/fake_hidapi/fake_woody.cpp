#include "tests/haptic/devices/fake_hidapi/fake_woody.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <pthread.h>
#include <sched.h>

namespace fettle::fake {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kWatchdog{500};
constexpr int kPriority = 90;

std::int16_t int16At(std::span<const std::uint8_t> b, std::size_t at) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(b[at] | (b[at + 1] << 8)));
}

void put(std::vector<std::uint8_t>& b, std::int32_t value) {
  b.push_back(static_cast<std::uint8_t>(value & 0xFF));
  b.push_back(static_cast<std::uint8_t>((value >> 8) & 0xFF));
}

Description describe(std::string serial) {
  Description d;
  d.product_name = "WoodenHaptics";
  d.serial = std::move(serial);
  return d;
}

}  // namespace

FakeWoody::FakeWoody(std::string folder, std::string name, Firmware firmware, std::string serial)
    : firmware_(firmware),
      hid_(std::move(folder), std::move(name), describe(std::move(serial))),
      thread_([this] { run(); }) {}

FakeWoody::~FakeWoody() {
  stop_ = true;
  thread_.join();
}

void FakeWoody::plug() {
  const std::lock_guard lock(mutex_);
  want_plugged_ = true;
}

void FakeWoody::unplug() {
  const std::lock_guard lock(mutex_);
  want_plugged_ = false;
}

void FakeWoody::pause(std::chrono::milliseconds length) {
  const std::lock_guard lock(mutex_);
  paused_until_ = Clock::now() + length;
}

void FakeWoody::sendRaw(std::vector<std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  raw_.push_back(std::move(bytes));
}

void FakeWoody::turnTo(std::array<std::int32_t, 3> counts) {
  const std::lock_guard lock(mutex_);
  counts_ = from_ = to_ = counts;
}

void FakeWoody::moveTo(std::array<std::int32_t, 3> counts, std::chrono::milliseconds length) {
  const std::lock_guard lock(mutex_);
  from_ = counts_;
  to_ = counts;
  from_at_ = Clock::now();
  to_at_ = from_at_ + length;
}

std::vector<WoodyCurrents> FakeWoody::history() const {
  const std::lock_guard lock(mutex_);
  return history_;
}

void FakeWoody::note(WoodyCurrents::By by) {
  history_.push_back({Clock::now(), log_.ma, counts_, by});
}

void FakeWoody::move(Clock::time_point now) {
  if (counts_ == to_) return;
  const double share = std::min(1.0, std::chrono::duration<double>(now - from_at_).count() /
                                         std::chrono::duration<double>(to_at_ - from_at_).count());
  for (std::size_t i = 0; i < 3; ++i)
    counts_[i] = from_[i] + static_cast<std::int32_t>(std::lround(share * (to_[i] - from_[i])));
}

void FakeWoody::forgetMost() {
  const std::lock_guard lock(mutex_);
  log_.most_ma = 0;
}

WoodyLog FakeWoody::log() const {
  const std::lock_guard lock(mutex_);
  return log_;
}

void FakeWoody::input() {
  std::vector<std::uint8_t> report;
  for (std::size_t i = 0; i < 3; ++i) put(report, counts_[i] + preset_offset_[i]);
  if (firmware_ == Firmware::kW8) {
    put(report, ++counter_);
  } else {
    put(report, stylus_ ? 10000 : 0);
    put(report, 0);
    put(report, 0);
    put(report, latch_ ? 1 : 0);
  }
  hid_.send(report);
  for (const auto& raw : raw_) hid_.send(raw);
  raw_.clear();
  ++log_.inputs;
  waits_for_reply_ = firmware_ == Firmware::kP14;
}

void FakeWoody::output(std::span<const std::uint8_t> report) {
  const std::lock_guard lock(mutex_);
  if (report.size() != (firmware_ == Firmware::kW8 ? 8U : 14U)) {
    ++log_.odd_outputs;
    return;
  }
  ++log_.outputs;
  last_output_ = Clock::now();
  waits_for_reply_ = false;
  if (firmware_ == Firmware::kP14 && int16At(report, 6) == 1) {
    ++log_.presets;
    latch_ = false;
    for (std::size_t i = 0; i < 3; ++i) preset_offset_[i] = int16At(report, 8 + 2 * i) - counts_[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    log_.ma[i] = int16At(report, 2 * i);
    log_.most_ma = std::max(log_.most_ma, std::abs(log_.ma[i]));
  }
  note(WoodyCurrents::By::kOutput);
}

void FakeWoody::run() {
  // Hardware is not held up by a busy machine: above everything, where that is allowed.
  const sched_param priority{.sched_priority = kPriority};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority));
  Clock::time_point next = Clock::now();
  while (!stop_) {
    const auto out = stalled_ ? FakeHid::Out::kStalled : FakeHid::Out::kTaken;
    // Without a plug there is no next report to be in time for: at this priority a thread that does not sleep takes its
    // processor from the loop that may be pinned to it.
    hid_.serve(hid_.plugged() && Clock::now() >= next ? 0 : 1, out, [this](auto report) { output(report); });
    const Clock::time_point now = Clock::now();
    const std::lock_guard lock(mutex_);
    if (want_plugged_ != hid_.plugged()) {
      if (want_plugged_) {
        // Power: all that the firmware knew is gone.
        preset_offset_ = {};
        for (std::size_t i = 0; i < 3; ++i) preset_offset_[i] = -counts_[i];
        waits_for_reply_ = false;
        log_.most_ma = 0;
        hid_.plug();
      } else {
        hid_.unplug();
      }
      log_.ma = {};
      note(WoodyCurrents::By::kPower);
    }
    move(now);
    if (!hid_.plugged()) continue;
    for (const auto& bytes : hid_.directWrites(firmware_ == Firmware::kW8 ? 9 : 15)) {
      if (std::any_of(bytes.begin(), bytes.end(), [](std::uint8_t b) { return b != 0; })) continue;
      ++log_.direct_zeros;
      log_.ma = {};
      note(WoodyCurrents::By::kDirect);
    }
    if (now - last_output_ > kWatchdog) {
      if (log_.ma != std::array<std::int16_t, 3>{}) {
        ++log_.watchdog_fired;
        log_.ma = {};
        note(WoodyCurrents::By::kWatchdog);
      }
    }
    if (now < next) continue;
    next = std::max(next + std::chrono::milliseconds(1), now - std::chrono::milliseconds(1));
    if (now < paused_until_ || waits_for_reply_) continue;
    input();
  }
}

}  // namespace fettle::fake
