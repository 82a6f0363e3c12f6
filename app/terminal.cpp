#include "app/terminal.h"

#include <cassert>
#include <csignal>
#include <cstdio>

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

namespace fettle::app {

namespace {

// Read by the signal handler: a handler may only access an atomic pointer.
std::atomic<engine::JobControl*> interrupted_job{nullptr};
static_assert(std::atomic<engine::JobControl*>::is_always_lock_free);

void onSignal(int signal) {
  // Sequentially consistent by default: executed once per process, not time critical.
  if (engine::JobControl* job = interrupted_job.load()) job->cancel();
  std::signal(signal, SIG_DFL);
}

Voice chosen_voice;

thread_local KeptMessages* thread_messages = nullptr;

std::mutex kept_mutex;
std::vector<std::string> kept_warnings;  // guarded by kept_mutex

const char* nameOf(engine::ErrorKind kind) {
  switch (kind) {
    case engine::ErrorKind::kInput:
      return "input";
    case engine::ErrorKind::kCancelled:
      return "cancelled";
    case engine::ErrorKind::kFailed:
      break;
  }
  return "failed";
}

// A closed or full terminal must not end the work: text that cannot be written is dropped.
void toStderr(const std::string& text) {
  std::fputs(text.c_str(), stderr);
}

// A separate line, also while a progress line is shown.
void lineToStderr(const std::string& text) {
  toStderr((isatty(STDERR_FILENO) != 0 ? "\r\x1b[K" : "") + text + "\n");
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

std::string durationText(double seconds) {
  if (seconds < 100.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 6000.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

std::optional<double> RemainingTime::at(double seconds, const engine::JobControl& job,
                                        const BatchState* batch) {
  constexpr double kFirstSeconds = 3.0;
  if (first_ < 0.0) first_ = seconds;
  if (batch != nullptr) {
    const std::size_t files = std::min(batch->done.load(std::memory_order_relaxed), batch->count);
    if (files != files_) last_file_ = seconds;
    files_ = files;
    if (files == 0 || seconds - first_ < kFirstSeconds) return std::nullopt;
    const double each = (last_file_ - first_) / static_cast<double>(files);
    return std::max(0.0, each * static_cast<double>(batch->count - files) - (seconds - last_file_));
  }
  const std::uint64_t total = job.total();
  const std::uint64_t done = std::min(job.done(), total);
  if (stage_ != job.stage() || done < done_) {
    stage_ = job.stage();
    begun_ = seconds;
    from_ = done;
  }
  done_ = done;
  const double taken = seconds - begun_;
  if (taken < kFirstSeconds || total == 0 || done - from_ < total / 100 + 1) return std::nullopt;
  return taken * static_cast<double>(total - done) / static_cast<double>(done - from_);
}

std::string progressText(const engine::JobControl& job, const BatchState* batch, std::optional<double> left) {
  const auto bar = [](std::uint64_t done, std::uint64_t total) {
    constexpr std::uint64_t kWidth = 30;
    const std::uint64_t filled = total == 0 ? 0 : done * kWidth / total;
    return std::string(filled, '#') + std::string(kWidth - filled, '.');
  };
  const std::uint64_t total = job.total();
  const std::uint64_t done = std::min(job.done(), total);
  const std::uint64_t percent = total == 0 ? 0 : 100 * done / total;
  const std::string stopping = job.cancelled() ? "  stopping"
                               : left          ? fmt::format(", about {} left", durationText(*left))
                                               : "";
  if (batch == nullptr)
    return fmt::format("{} [{}] {:3d} %{}", job.stage(), bar(done, total), percent, stopping);
  // Relaxed, as the job's own numbers: they are only shown in this line.
  const std::uint64_t behind = std::min(batch->done.load(std::memory_order_relaxed), batch->count);
  return fmt::format("[{}] {} of {}, {} {:3d} %{}", bar(behind, batch->count),
                     std::min(behind + 1, std::uint64_t{batch->count}), batch->count, job.stage(), percent,
                     stopping);
}

ProgressLine::ProgressLine(const engine::JobControl& job, const BatchState* batch)
    : job_(job), batch_(batch) {
  if (thread_messages == nullptr && !voice().quiet && isatty(STDERR_FILENO) != 0)
    thread_ = std::thread([this] { show(); });
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
  const auto begun = std::chrono::steady_clock::now();
  RemainingTime remaining;
  do {
    const std::chrono::duration<double> now = std::chrono::steady_clock::now() - begun;
    toStderr("\r\x1b[K" + progressText(job_, batch_, remaining.at(now.count(), job_, batch_)));
    std::fflush(stderr);
  } while (!wake_.wait_for(lock, 100ms, [this] { return ended_; }));
  toStderr("\r\x1b[K");
  std::fflush(stderr);
}

void setVoice(const Voice& voice) {
  chosen_voice = voice;
}

const Voice& voice() noexcept {
  return chosen_voice;
}

int report(const engine::Error& error) {
  const int status = error.kind == engine::ErrorKind::kInput ? 2 : 1;
  if (voice().json) {
    const nlohmann::ordered_json object{{"schema", "fettle.error/1"}, {"error", error.line()},
                                        {"kind", nameOf(error.kind)}, {"what", error.what},
                                        {"where", error.where},       {"remedy", error.remedy},
                                        {"status", status},           {"warnings", takeWarnings()}};
    lineToStderr(object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  } else {
    lineToStderr("fettle: error: " + error.line());
  }
  return status;
}

KeptMessages::KeptMessages() : before_(thread_messages) {
  thread_messages = this;
}

KeptMessages::~KeptMessages() {
  assert(thread_messages == this);
  thread_messages = before_;
}

void warn(const std::string& text) {
  if (thread_messages != nullptr) {
    thread_messages->warnings.push_back(text);
  } else if (voice().json) {
    const std::scoped_lock lock(kept_mutex);
    kept_warnings.push_back(text);
  } else if (!voice().quiet) {
    lineToStderr("fettle: warning: " + text);
  }
}

void note(const std::string& text) {
  if (thread_messages == nullptr && !voice().json && !voice().quiet) lineToStderr("fettle: " + text);
}

std::vector<std::string> takeWarnings() {
  const std::scoped_lock lock(kept_mutex);
  return std::exchange(kept_warnings, {});
}

}  // namespace fettle::app
