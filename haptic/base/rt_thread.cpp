#include "haptic/base/rt_thread.h"

#include <cerrno>
#include <cstdint>
#include <cstring>

#include <alloca.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace fettle::haptic {

namespace {

constexpr std::size_t kPage = 4096;

// Touches the stack below, page by page, so that no tick takes a page fault there. Out of line: the frame
// must end before the ticks begin.
[[gnu::noinline]] void touchStack(std::size_t bytes) {
  auto* stack = static_cast<volatile char*>(alloca(bytes));
  for (std::size_t i = 0; i < bytes; i += kPage) stack[i] = 0;
}

// Negative where none is allowed.
int lastCore(const cpu_set_t& allowed) {
  int core = CPU_SETSIZE - 1;
  while (core >= 0 && !CPU_ISSET(core, &allowed)) --core;
  return core;
}

}  // namespace

struct RealTimeScope::Before {
  cpu_set_t cores{};
  int policy = SCHED_OTHER;
  sched_param parameters{};
  int latency_file = -1;
};

RealTimeScope::RealTimeScope(const RealTimeRequest& request) : before_(std::make_unique<Before>()) {
  pthread_getaffinity_np(pthread_self(), sizeof before_->cores, &before_->cores);
  pthread_getschedparam(pthread_self(), &before_->policy, &before_->parameters);
  pin(request.core >= 0 ? request.core : lastCore(before_->cores));
  if (request.lock_memory) lockMemory();
  touchStack(request.stack_bytes);
  if (request.hold_latency) holdLatency();
  // Last: the steps before it may take long.
  if (request.priority > 0) schedule(request.priority);
}

RealTimeScope::~RealTimeScope() {
  pthread_setschedparam(pthread_self(), before_->policy, &before_->parameters);
  pthread_setaffinity_np(pthread_self(), sizeof before_->cores, &before_->cores);
  if (before_->latency_file >= 0) close(before_->latency_file);
  if (report_.memory_locked) munlockall();
}

void RealTimeScope::pin(int core) {
  cpu_set_t one;
  CPU_ZERO(&one);
  int problem = EINVAL;
  if (core >= 0 && core < CPU_SETSIZE) {
    CPU_SET(core, &one);
    problem = pthread_setaffinity_np(pthread_self(), sizeof one, &one);
  }
  if (problem == 0)
    report_.core = core;
  else
    report_.missing.push_back("not pinned to core " + std::to_string(core) + " (" + std::strerror(problem) +
                              "): allow the core with taskset or the container's cpuset");
}

void RealTimeScope::schedule(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int problem = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (problem == 0)
    report_.priority = priority;
  else
    report_.missing.push_back("no SCHED_FIFO priority " + std::to_string(priority) + " (" +
                              std::strerror(problem) +
                              "): add '@audio - rtprio 95' to /etc/security/limits.d/ and the user to that "
                              "group, or run with CAP_SYS_NICE");
}

void RealTimeScope::lockMemory() {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  int problem = 0;
  if (limit.rlim_cur != RLIM_INFINITY && geteuid() != 0)
    problem = EPERM;
  else if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0)
    problem = errno;
  if (problem == 0)
    report_.memory_locked = true;
  else
    report_.missing.push_back("pages not locked in memory (" + std::string(std::strerror(problem)) +
                              "): add '@audio - memlock unlimited' to /etc/security/limits.d/ and the user "
                              "to that group");
}

void RealTimeScope::holdLatency() {
  const int file = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
  const std::int32_t none_us = 0;
  // Held as long as the file is open.
  if (file >= 0 && write(file, &none_us, sizeof none_us) == sizeof none_us) {
    before_->latency_file = file;
    report_.latency_held = true;
    return;
  }
  report_.missing.push_back(
      "processor sleep states not held off (/dev/cpu_dma_latency: " + std::string(std::strerror(errno)) +
      "): allow writing to it with a udev rule for the user's group");
  if (file >= 0) close(file);
}

#if defined(__x86_64__)
DenormalScope::DenormalScope() noexcept : before_(_mm_getcsr()) {
  constexpr unsigned kFlushToZero = 0x8000;
  constexpr unsigned kDenormalsAreZero = 0x0040;
  _mm_setcsr(static_cast<unsigned>(before_) | kFlushToZero | kDenormalsAreZero);
}
DenormalScope::~DenormalScope() {
  _mm_setcsr(static_cast<unsigned>(before_));
}
#elif defined(__aarch64__)
DenormalScope::DenormalScope() noexcept {
  asm volatile("mrs %0, fpcr" : "=r"(before_));
  const unsigned long flush = before_ | (1UL << 24);
  asm volatile("msr fpcr, %0" : : "r"(flush));
}
DenormalScope::~DenormalScope() {
  asm volatile("msr fpcr, %0" : : "r"(before_));
}
#else
DenormalScope::DenormalScope() noexcept = default;
DenormalScope::~DenormalScope() = default;
#endif

}  // namespace fettle::haptic
