#include "haptic/loop/pacer.h"

#include <algorithm>
#include <cerrno>
#include <ctime>

#include "engine/base/stopwatch.h"

namespace fettle::haptic {

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t periodOf(double rate_hz) noexcept {
  // Negated, so that NaN becomes the lowest rate.
  const double rate =
      !(rate_hz > Pacer::kLowestRate_hz) ? Pacer::kLowestRate_hz : std::min(rate_hz, Pacer::kHighestRate_hz);
  return static_cast<std::int64_t>(static_cast<double>(kSecond_ns) / rate);
}

}  // namespace

Pacer::Pacer(double rate_hz) noexcept
    : schedule_(engine::steadyNs() + periodOf(rate_hz), periodOf(rate_hz)), last_ns_(engine::steadyNs()) {}

Pacer::Tick Pacer::wait() noexcept {
  const timespec due{static_cast<time_t>(schedule_.due() / kSecond_ns),
                     static_cast<long>(schedule_.due() % kSecond_ns)};
  // A signal handled on this thread interrupts the sleep; the due time is absolute, so it is resumed.
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
  }
  const std::int64_t now = engine::steadyNs();
  const Schedule::Wake wake = schedule_.wake(now);
  const Tick tick{now, wake.lateness_ns, wake.skipped, now - last_ns_};
  last_ns_ = now;
  return tick;
}

}  // namespace fettle::haptic
