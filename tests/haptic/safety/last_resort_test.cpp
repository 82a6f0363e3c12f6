#include "haptic/safety/last_resort.h"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace fettle::haptic {
namespace {

// A device at the far end of a pipe: one letter a report, 'F' a force, '0' zero.
struct FakeDevice {
  int write_end = -1;
  static void zero(void* self) noexcept {
    const ssize_t n = write(static_cast<FakeDevice*>(self)->write_end, "0", 1);
    static_cast<void>(n);
  }
};

struct Ended {
  std::string reports;
  int status = 0;
};

// Runs `child` in a process of its own that holds the device, and collects what the device got until the
// process is gone. `when_running` is called with the process after the first report.
Ended inAnotherProcess(const std::function<void(FakeDevice&)>& child,
                       const std::function<void(pid_t)>& when_running = {}) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  std::fflush(nullptr);  // or a child that exits writes it again
  const pid_t pid = fork();
  if (pid == 0) {
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    close(ends[0]);
    FakeDevice device{ends[1]};
    child(device);
    std::_Exit(77);
  }
  close(ends[1]);
  Ended ended;
  bool called = false;
  char buffer[256];
  for (ssize_t n; (n = read(ends[0], buffer, sizeof buffer)) > 0;) {
    ended.reports.append(buffer, static_cast<std::size_t>(n));
    if (!called && when_running) when_running(pid);
    called = true;
  }
  close(ends[0]);
  waitpid(pid, &ended.status, 0);
  return ended;
}

[[noreturn]] void pushForever(FakeDevice& device) {
  for (;;) {
    const ssize_t n = write(device.write_end, "F", 1);
    static_cast<void>(n);
    const timespec pause{0, 1'000'000};
    nanosleep(&pause, nullptr);
  }
}

// Without a signal, in this process: what the handlers call.
TEST(LastResort, EveryRegisteredDeviceIsSentItsZeroAndThoseThatLeftAreNot) {
  struct Counted {
    int zeros = 0;
    static void zero(void* device) noexcept { ++static_cast<Counted*>(device)->zeros; }
  };
  Counted first, second;
  ASSERT_FALSE(LastResort::fired());
  {
    const ZeroOnLastResort a(&Counted::zero, &first);
    ASSERT_TRUE(a.registered());
    {
      const ZeroOnLastResort b(&Counted::zero, &second);
      ASSERT_TRUE(b.registered());
      LastResort::fire();
      EXPECT_TRUE(LastResort::fired());
      EXPECT_EQ(first.zeros, 1);
      EXPECT_EQ(second.zeros, 1);
    }
    LastResort::fire();  // again: more than once is allowed
    EXPECT_EQ(first.zeros, 2);
    EXPECT_EQ(second.zeros, 1);
  }
  LastResort::fire();
  EXPECT_EQ(first.zeros, 2);
  LastResort::reset();
  EXPECT_FALSE(LastResort::fired());
  // Its place is free for others.
  std::vector<std::unique_ptr<ZeroOnLastResort>> all;
  for (int i = 0; i < ZeroOnLastResort::kMost; ++i)
    all.push_back(std::make_unique<ZeroOnLastResort>(&Counted::zero, &first));
  EXPECT_TRUE(all.back()->registered());
  EXPECT_FALSE(ZeroOnLastResort(&Counted::zero, &second).registered());
  LastResort::fire();
  EXPECT_EQ(first.zeros, 2 + ZeroOnLastResort::kMost);
  LastResort::reset();
}

class LastResortSignals : public ::testing::TestWithParam<int> {};

TEST_P(LastResortSignals, ZeroReachesTheDeviceAndTheProgramDiesByThatSignal) {
  const int signal = GetParam();
  const Ended ended = inAnotherProcess([signal](FakeDevice& device) {
    std::signal(signal, SIG_DFL);  // a sanitizer's own handler would end the program in its own way
    if (!LastResort::install()) std::_Exit(78);
    const ZeroOnLastResort zero(&FakeDevice::zero, &device);
    if (!zero.registered()) std::_Exit(79);
    const ssize_t n = write(device.write_end, "F", 1);
    static_cast<void>(n);
    raise(signal);
    pushForever(device);
  });
  EXPECT_EQ(ended.reports, "F0");
  ASSERT_TRUE(WIFSIGNALED(ended.status)) << ended.status;
  EXPECT_EQ(WTERMSIG(ended.status), signal);
}

INSTANTIATE_TEST_SUITE_P(All, LastResortSignals,
                         ::testing::Values(SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGINT, SIGHUP,
                                           SIGQUIT),
                         [](const auto& i) { return std::string(sigabbrev_np(i.param)); });

TEST(LastResort, WildPointerOnAnotherThreadStillSaysZero) {
  const Ended ended = inAnotherProcess([](FakeDevice& device) {
    std::signal(SIGSEGV, SIG_DFL);
    if (!LastResort::install()) std::_Exit(78);
    const ZeroOnLastResort zero(&FakeDevice::zero, &device);
    std::thread([] {
      const HandlerStack stack;
      void* forbidden = mmap(nullptr, 4096, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
      *static_cast<volatile char*>(forbidden) = 1;
    }).join();
  });
  EXPECT_EQ(ended.reports, "0");
  EXPECT_TRUE(WIFSIGNALED(ended.status));
}

TEST(LastResort, ProgramsOwnHandlerForInterruptIsCalledAfterTheZero) {
  const Ended ended = inAnotherProcess([](FakeDevice& device) {
    static volatile std::sig_atomic_t seen;
    static bool fired_before;
    seen = 0;
    std::signal(SIGINT, [](int) {
      seen = 1;
      fired_before = LastResort::fired();
    });
    if (!LastResort::install()) std::_Exit(78);
    const ZeroOnLastResort zero(&FakeDevice::zero, &device);
    raise(SIGINT);
    std::_Exit(seen == 1 && fired_before ? 5 : 6);
  });
  EXPECT_EQ(ended.reports, "0");
  EXPECT_TRUE(WIFEXITED(ended.status));
  EXPECT_EQ(WEXITSTATUS(ended.status), 5);
}

TEST(LastResort, ExitSaysZeroAndIgnoredSignalsDoNot) {
  const Ended ended = inAnotherProcess([](FakeDevice& device) {
    std::signal(SIGHUP, SIG_IGN);
    if (!LastResort::install()) std::_Exit(78);
    static ZeroOnLastResort zero(&FakeDevice::zero, new FakeDevice(device));
    raise(SIGHUP);
    if (LastResort::fired()) std::_Exit(6);
    LastResort::fire();
    std::_Exit(5);
  });
  EXPECT_EQ(ended.reports, "0");
  EXPECT_EQ(WEXITSTATUS(ended.status), 5);
}

TEST(LastResort, AProgramThatEndsByItselfSaysZeroToDevicesThatAreStillRegistered) {
  const Ended ended = inAnotherProcess([](FakeDevice& device) {
    if (!LastResort::install()) std::_Exit(78);
    const auto* const zero =
        new ZeroOnLastResort(&FakeDevice::zero, &device);  // as of a thread that still runs
    const ssize_t n = write(device.write_end, "F", 1);
    std::exit(n == 1 && zero->registered() ? 5 : 6);
  });
  EXPECT_EQ(ended.reports, "F0");
  ASSERT_TRUE(WIFEXITED(ended.status));
  EXPECT_EQ(WEXITSTATUS(ended.status), 5);
}

TEST(LastResort, RegistrationThatEndedIsNotCalledAndPlacesComeBack) {
  FakeDevice nowhere;
  for (int round = 0; round < 3; ++round) {
    std::vector<std::unique_ptr<ZeroOnLastResort>> all;
    for (int i = 0; i < ZeroOnLastResort::kMost; ++i) {
      all.push_back(std::make_unique<ZeroOnLastResort>([](void*) noexcept {}, &nowhere));
      EXPECT_TRUE(all.back()->registered());
    }
    EXPECT_FALSE(ZeroOnLastResort(&FakeDevice::zero, &nowhere).registered());
  }
}

// SIGKILL leaves no last word: the device hears nothing more, and its watchdog (500 ms for HID boards, 100 ms
// for serial ones) is what lets go. This shows that silence, and that a watchdog sees it in time.
TEST(LastResort, KilledProgramFallsSilentAndTheDevicesWatchdogLetsGo) {
  using Clock = std::chrono::steady_clock;
  Clock::time_point killed;
  const Ended ended = inAnotherProcess(
      [](FakeDevice& device) {
        if (!LastResort::install()) std::_Exit(78);
        const ZeroOnLastResort zero(&FakeDevice::zero, &device);
        pushForever(device);
      },
      [&killed](pid_t pid) {
        kill(pid, SIGKILL);
        killed = Clock::now();
      });
  const auto silent_after = Clock::now() - killed;
  EXPECT_EQ(ended.reports.find('0'), std::string::npos);
  EXPECT_TRUE(WIFSIGNALED(ended.status));
  EXPECT_EQ(WTERMSIG(ended.status), SIGKILL);
  // The watchdog counts from the last report: 100 ms later at the latest the force is off.
  EXPECT_LT(silent_after, std::chrono::milliseconds(500));
}

}  // namespace
}  // namespace fettle::haptic
