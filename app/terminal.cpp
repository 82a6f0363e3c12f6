#include "app/terminal.h"

#include <csignal>
#include <cstdio>

#include <atomic>
#include <chrono>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

namespace fettle::app {

namespace {

// Read by the signal handler: an atomic pointer is all a handler may touch.
std::atomic<engine::JobControl*> interrupted_job{nullptr};
static_assert(std::atomic<engine::JobControl*>::is_always_lock_free);

void onSignal(int signal) {
  // Sequentially consistent by default: once in a process's life, and never on a fast path.
  if (engine::JobControl* job = interrupted_job.load()) job->cancel();
  std::signal(signal, SIG_DFL);
}

// A terminal that is gone or full must not end the work: what cannot be said is left unsaid.
void toStderr(const std::string& text) {
  std::fputs(text.c_str(), stderr);
}

}  // namespace

InterruptGuard::InterruptGuard(engine::JobControl& job) {
  interrupted_job.store(&job);
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
  std::signal(SIGHUP, onSignal);
}

InterruptGuard::~InterruptGuard() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  std::signal(SIGHUP, SIG_DFL);
  interrupted_job.store(nullptr);
}

ProgressLine::ProgressLine(const engine::JobControl& job) : job_(job) {
  if (isatty(STDERR_FILENO) != 0) thread_ = std::thread([this] { show(); });
}

ProgressLine::~ProgressLine() {
  if (!thread_.joinable()) return;
  {
    const std::scoped_lock lock(mutex_);
    ended_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void ProgressLine::show() {
  using namespace std::chrono_literals;
  std::unique_lock lock(mutex_);
  if (wake_.wait_for(lock, 1s, [this] { return ended_; })) return;
  do {
    const std::uint64_t total = job_.total();
    const std::uint64_t done = std::min(job_.done(), total);
    const int percent = total == 0 ? 0 : static_cast<int>(100 * done / total);
    constexpr int kWidth = 30;
    const int filled = percent * kWidth / 100;
    toStderr(fmt::format("\r\x1b[K{} [{}{}] {:3d} %{}", job_.stage(), std::string(filled, '#'),
                         std::string(kWidth - filled, '.'), percent, job_.cancelled() ? "  stopping" : ""));
    std::fflush(stderr);
  } while (!wake_.wait_for(lock, 100ms, [this] { return ended_; }));
  toStderr("\r\x1b[K");
  std::fflush(stderr);
}

int report(const engine::Error& error) {
  toStderr(fmt::format("fettle: error: {}\n", error.line()));
  return error.kind == engine::ErrorKind::kInput ? 2 : 1;
}

void warn(const std::string& text) {
  toStderr(fmt::format("fettle: warning: {}\n", text));
}

}  // namespace fettle::app
