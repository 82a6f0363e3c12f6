#include "bench/instructions.h"

#include <cerrno>
#include <csignal>
#include <cstring>

#if defined(__linux__)
#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

namespace fettle::bench {

std::string_view countedByName(CountedBy by) noexcept {
  switch (by) {
    case CountedBy::kCounter:
      return "processor counter";
    case CountedBy::kSteps:
      return "single steps";
    case CountedBy::kNothing:
      break;
  }
  return "not available";
}

#if defined(__linux__)

namespace {

// Not inlined and not empty: the call between two markers must be the same with and without work.
[[gnu::noinline]] void callMarked(const std::function<void()>& work) {
  work();
}

std::optional<std::int64_t> counted(const std::function<void()>& work) {
  perf_event_attr attributes;
  std::memset(&attributes, 0, sizeof attributes);
  attributes.size = sizeof attributes;
  attributes.type = PERF_TYPE_HARDWARE;
  attributes.config = PERF_COUNT_HW_INSTRUCTIONS;
  attributes.disabled = 1;
  attributes.exclude_kernel = 1;
  attributes.exclude_hv = 1;
  const long fd = syscall(SYS_perf_event_open, &attributes, 0, -1, -1, PERF_FLAG_FD_CLOEXEC);
  if (fd < 0) return std::nullopt;
  const int counter = static_cast<int>(fd);
  const auto count = [&](const std::function<void()>& f) -> std::int64_t {
    ioctl(counter, PERF_EVENT_IOC_RESET, 0);
    ioctl(counter, PERF_EVENT_IOC_ENABLE, 0);
    callMarked(f);
    ioctl(counter, PERF_EVENT_IOC_DISABLE, 0);
    std::int64_t value = 0;
    return read(counter, &value, sizeof value) == sizeof value ? value : -1;
  };
  const std::int64_t nothing = count([] {});
  const std::int64_t all = count(work);
  close(counter);
  // A virtual machine may offer a counter that does not count.
  if (nothing <= 0 || all < nothing) return std::nullopt;
  return all - nothing;
}

// Waits for the next stop of the child; false when it ended.
bool nextStop(pid_t child, int& signal) {
  int status = 0;
  while (waitpid(child, &status, 0) != child)
    if (errno != EINTR) return false;
  if (!WIFSTOPPED(status)) return false;
  signal = WSTOPSIG(status);
  return true;
}

void endChild(pid_t child) {
  kill(child, SIGKILL);
  while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
}

// The child stops itself before the empty call, between it and the work, and after the work.
std::optional<std::int64_t> stepped(const std::function<void()>& work) {
  const std::function<void()> nothing = [] {};
  const pid_t child = fork();
  if (child < 0) return std::nullopt;
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(1);
    // Not before the work has run once: its pages are the parent's, copied at the first write.
    raise(SIGSTOP);
    callMarked(nothing);
    raise(SIGSTOP);
    callMarked(work);
    raise(SIGSTOP);
    _exit(0);
  }
  int signal = 0;
  if (!nextStop(child, signal)) return std::nullopt;  // it has ended, and was waited for
  std::int64_t counts[2] = {0, 0};
  for (std::int64_t& count : counts) {
    do {
      if (ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr) != 0) {
        endChild(child);
        return std::nullopt;
      }
      if (!nextStop(child, signal)) return std::nullopt;
      ++count;
      if (signal != SIGTRAP && signal != SIGSTOP) {  // the work crashed
        endChild(child);
        return std::nullopt;
      }
    } while (signal == SIGTRAP);
  }
  endChild(child);
  return counts[1] - counts[0];
}

}  // namespace

InstructionCount countInstructions(const std::function<void()>& work) {
  if (const auto count = counted(work)) return {count, CountedBy::kCounter};
  if (const auto count = stepped(work)) return {count, CountedBy::kSteps};
  return {};
}

#else

InstructionCount countInstructions(const std::function<void()>&) {
  return {};
}

#endif

}  // namespace fettle::bench
