#include "haptic/safety/last_resort.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include <sched.h>

#include "haptic/devices/emergency_zero.h"

namespace fettle::haptic {

namespace {

enum class SlotState : std::uint8_t { kFree, kFilling, kReady, kRunning };

struct Slot {
  std::atomic<SlotState> state{SlotState::kFree};
  LastResort::ZeroReport report = nullptr;
  void* device = nullptr;
};
static_assert(std::atomic<SlotState>::is_always_lock_free, "a signal handler may use no lock");

std::array<Slot, ZeroOnLastResort::kMost> g_slots;
std::atomic<bool> g_fired{false};

struct Covered {
  int signal;
  bool own_fault;  // raised by the program itself: returning from the handler does not continue
};
constexpr std::array<Covered, 9> kCovered{{{SIGSEGV, true},
                                           {SIGBUS, true},
                                           {SIGFPE, true},
                                           {SIGILL, true},
                                           {SIGABRT, true},
                                           {SIGTERM, false},
                                           {SIGINT, false},
                                           {SIGHUP, false},
                                           {SIGQUIT, false}}};
std::array<struct sigaction, kCovered.size()> g_before;

void restoreAndRaise(std::size_t i) noexcept {
  sigaction(kCovered[i].signal, &g_before[i], nullptr);
  // Blocked until this handler returns; then it has its previous effect.
  raise(kCovered[i].signal);
}

void onSignal(int signal, siginfo_t* info, void* context) {
  const int saved_errno = errno;
  LastResort::fire();
  for (std::size_t i = 0; i < kCovered.size(); ++i) {
    if (kCovered[i].signal != signal) continue;
    const struct sigaction& before = g_before[i];
    if (kCovered[i].own_fault)
      restoreAndRaise(i);
    else if ((before.sa_flags & SA_SIGINFO) != 0)
      before.sa_sigaction(signal, info, context);
    else if (before.sa_handler != SIG_DFL && before.sa_handler != SIG_IGN)
      before.sa_handler(signal);
    else
      restoreAndRaise(i);
  }
  errno = saved_errno;
}

}  // namespace

engine::Status LastResort::install() {
  static const bool at_exit = std::atexit([] { fire(); }) == 0;
  if (!at_exit) return engine::failure("no room to act at exit", "last resort");
  for (std::size_t i = 0; i < kCovered.size(); ++i) {
    struct sigaction now {};
    if (sigaction(kCovered[i].signal, nullptr, &now) != 0)
      return engine::failure(std::strerror(errno), "last resort");
    const bool ours = (now.sa_flags & SA_SIGINFO) != 0 && now.sa_sigaction == &onSignal;
    const bool ignored = (now.sa_flags & SA_SIGINFO) == 0 && now.sa_handler == SIG_IGN;
    if (ours || (ignored && !kCovered[i].own_fault)) continue;
    g_before[i] = now;
    struct sigaction action {};
    action.sa_sigaction = &onSignal;
    // Keeps the program's setting for interrupted system calls.
    action.sa_flags = SA_SIGINFO | SA_ONSTACK | (now.sa_flags & SA_RESTART);
    sigemptyset(&action.sa_mask);
    if (sigaction(kCovered[i].signal, &action, nullptr) != 0)
      return engine::failure(std::strerror(errno), "last resort");
  }
  return {};
}

bool LastResort::fired() noexcept {
  return g_fired.load(std::memory_order_relaxed);
}

void LastResort::reset() noexcept {
  g_fired.store(false, std::memory_order_relaxed);
  holdDevicesAtZero(HeldAtZero::kNo);
}

void LastResort::fire() noexcept {
  // Relaxed: the loop may write one more force in the tick that is running; no atomic orders the reports
  // below and the program's end after it, only the drivers' renewal rule (a force that is not renewed for 10
  // ms is replaced by zero).
  g_fired.store(true, std::memory_order_relaxed);
  for (Slot& slot : g_slots) {
    SlotState ready = SlotState::kReady;
    // Acquire: report and device are as the registration wrote them. A slot in use by another thread's
    // handler is skipped, also one in which this thread itself crashed.
    if (!slot.state.compare_exchange_strong(ready, SlotState::kRunning, std::memory_order_acquire)) continue;
    slot.report(slot.device);
    // Release: the destructor that sees kReady again may free the device.
    slot.state.store(SlotState::kReady, std::memory_order_release);
  }
  // Devices with drivers come last, since a device that accepts no reports can block for seconds. Twice: a
  // writer thread may have been about to send a force at the first zeros; it has sent it by the second round,
  // and sends only zeros from then on.
  holdDevicesAtZero(HeldAtZero::kYes);
  const int written = zeroAllDevices();
  waitForHeldZeros();
  if (written == 0) return;
  const timespec writer_delay{0, 2'000'000};
  nanosleep(&writer_delay, nullptr);
  zeroAllDevices();
}

ZeroOnLastResort::ZeroOnLastResort(LastResort::ZeroReport report, void* device) noexcept {
  for (int i = 0; i < kMost; ++i) {
    Slot& slot = g_slots[static_cast<std::size_t>(i)];
    SlotState free = SlotState::kFree;
    // Acquire: the previous holder has finished with it.
    if (!slot.state.compare_exchange_strong(free, SlotState::kFilling, std::memory_order_acquire)) continue;
    slot.report = report;
    slot.device = device;
    // Release publishes both to a handler.
    slot.state.store(SlotState::kReady, std::memory_order_release);
    slot_ = i;
    return;
  }
}

ZeroOnLastResort::~ZeroOnLastResort() {
  if (slot_ < 0) return;
  Slot& slot = g_slots[static_cast<std::size_t>(slot_)];
  SlotState ready = SlotState::kReady;
  // Acquire: a handler's last use of the device is complete. Release: so is this one, for the next holder.
  while (!slot.state.compare_exchange_weak(ready, SlotState::kFree, std::memory_order_acq_rel)) {
    ready = SlotState::kReady;
    sched_yield();
  }
}

HandlerStack::HandlerStack() : memory_(new std::byte[kBytes]) {
  stack_t stack{};
  stack.ss_sp = memory_.get();
  stack.ss_size = kBytes;
  sigaltstack(&stack, nullptr);
}

HandlerStack::~HandlerStack() {
  stack_t off{};
  off.ss_flags = SS_DISABLE;
  sigaltstack(&off, nullptr);
}

}  // namespace fettle::haptic
