#include "app/work/behind_the_window.h"

#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

namespace fettle::app {

namespace {

// On Linux the number is of a thread, not of its process.
bool setNice(int nice) noexcept {
  return setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), nice) == 0;
}

// Of the process: it has one window.
std::atomic<bool> window_is_before{false};

}  // namespace

void goBehindTheWindow() noexcept {
  const int behind = window_is_before.load(std::memory_order_relaxed) ? 0 : 10;
  // Where it is refused all threads are as before. Who was started as less important stays that.
  if (getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())) < behind) static_cast<void>(setNice(behind));
}

bool comeBeforeOtherWork() noexcept {
  const bool allowed = setNice(-10);
  if (allowed) window_is_before.store(true, std::memory_order_relaxed);
  return allowed;
}

int putWorkersBehindTheWindow() {
  // A worker that waits takes no second part, so each of them gets one; a limit of the system may leave fewer.
  constexpr std::chrono::seconds kLongest{1};
  const int all = tbb::info::default_concurrency();
  std::mutex mutex;
  std::condition_variable came;
  int here = 0;
  const auto deadline = std::chrono::steady_clock::now() + kLongest;
  std::thread([&] {
    tbb::task_arena(all).execute([&] {
      tbb::parallel_for(
          0, all,
          [&](int) {
            goBehindTheWindow();
            std::unique_lock lock(mutex);
            ++here;
            came.notify_all();
            came.wait_until(lock, deadline, [&] { return here == all; });
          },
          tbb::simple_partitioner());
    });
  }).join();
  return here - 1;
}

}  // namespace fettle::app
