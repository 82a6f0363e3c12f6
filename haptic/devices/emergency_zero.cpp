#include "haptic/devices/emergency_zero.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <ctime>

namespace fettle::haptic {

namespace {

enum State : int { kEmpty, kBusy, kArmed };

struct Entry {
  std::atomic<int> state{kEmpty};
  int file = -1;
  std::size_t size = 0;
  std::array<std::uint8_t, 96> report{};
};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may not lock");

std::array<Entry, 8> entries;
std::atomic<bool> held_at_zero{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may not lock");

enum LinkZero : int { kNoLink, kHoldsForce, kHoldsZero };
std::array<std::atomic<int>, 8> link_zeros{};

}  // namespace

int armEmergencyZero(const char* path, std::span<const std::uint8_t> report) noexcept {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    Entry& e = entries[i];
    int expected = kEmpty;
    // Acquire: the last disarm of this entry is complete. From here until it is armed only this thread uses
    // it.
    if (report.size() > e.report.size() ||
        !e.state.compare_exchange_strong(expected, kBusy, std::memory_order_acquire))
      continue;
    // Not blocking: if the path is not a device but a pipe without a reader, this must not hang.
    e.file = ::open(path, O_WRONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (e.file < 0) {
      e.state.store(kEmpty, std::memory_order_release);
      return -1;
    }
    std::copy(report.begin(), report.end(), e.report.begin());
    e.size = report.size();
    e.state.store(kArmed, std::memory_order_release);  // publishes the entry to a signal handler
    return static_cast<int>(i);
  }
  return -1;
}

void disarmEmergencyZero(int number) noexcept {
  if (number < 0) return;
  Entry& e = entries[static_cast<std::size_t>(number)];
  e.state.store(kBusy, std::memory_order_relaxed);
  // A handler running on another thread at this moment may still write to the file; closing it loses that
  // write, on a device whose driver has already sent its own zero.
  ::close(e.file);
  e.state.store(kEmpty, std::memory_order_release);
}

// Both relaxed: the second round of zeros in LastResort::fire follows any report that was encoded before the
// flag was seen.
void holdDevicesAtZero(HeldAtZero held) noexcept {
  for (std::atomic<int>& link : link_zeros) {  // a zero of an earlier hold does not count
    int zero = kHoldsZero;
    link.compare_exchange_strong(zero, kHoldsForce, std::memory_order_relaxed);
  }
  held_at_zero.store(held == HeldAtZero::kYes, std::memory_order_relaxed);
}

bool devicesHeldAtZero() noexcept {
  return held_at_zero.load(std::memory_order_relaxed);
}

void ZeroWhenHeld::arm() noexcept {
  for (std::size_t i = 0; i < link_zeros.size() && number_ < 0; ++i) {
    int free = kNoLink;
    if (link_zeros[i].compare_exchange_strong(free, kHoldsForce, std::memory_order_relaxed))
      number_ = static_cast<int>(i);
  }
}

void ZeroWhenHeld::disarm() noexcept {
  if (number_ >= 0) link_zeros[static_cast<std::size_t>(number_)].store(kNoLink, std::memory_order_relaxed);
  number_ = -1;
}

// Relaxed: the wait below reads nothing else. Only a zero after the hold counts: until then a force may follow.
void ZeroWhenHeld::zeroSent() noexcept {
  if (number_ >= 0 && devicesHeldAtZero())
    link_zeros[static_cast<std::size_t>(number_)].store(kHoldsZero, std::memory_order_relaxed);
}

int waitForHeldZeros() noexcept {
  const int kept = errno;
  int missing = 0;
  for (int ms = 0; ms <= 20; ++ms) {
    missing = 0;
    for (const std::atomic<int>& link : link_zeros)
      missing += link.load(std::memory_order_relaxed) == kHoldsForce ? 1 : 0;
    if (missing == 0 || ms == 20) break;
    const timespec a_millisecond{0, 1'000'000};
    nanosleep(&a_millisecond, nullptr);
  }
  errno = kept;
  return missing;
}

int zeroAllDevices() noexcept {
  const int kept = errno;
  int taken = 0;
  for (Entry& e : entries) {
    if (e.state.load(std::memory_order_acquire) != kArmed) continue;
    if (::write(e.file, e.report.data(), e.size) == static_cast<ssize_t>(e.size)) ++taken;
  }
  errno = kept;
  return taken;
}

}  // namespace fettle::haptic
