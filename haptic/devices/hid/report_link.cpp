#include "haptic/devices/hid/report_link.h"

#include <array>
#include <chrono>
#include <ctime>
#include <system_error>
#include <utility>

#include "engine/base/stopwatch.h"
#include "haptic/devices/link_thread.h"

namespace fettle::haptic {

namespace {

constexpr std::chrono::milliseconds kReadWait{5};
constexpr std::chrono::milliseconds kPlugWait{200};
constexpr std::size_t kLongestReport = 256;
// hidraw buffers 64 reports for a late reader; more than twice that at once means a source that never pauses,
// and then the newest one must still reach the loop.
constexpr int kDrainLimit = 128;

void add(std::atomic<std::uint64_t>& counter) noexcept {
  counter.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

ReportLink::ReportLink(std::unique_ptr<ReportSource> source, ReportHandler& handler, const OutputTimes& times)
    : source_(std::move(source)), handler_(handler), times_(times) {
  sem_init(&work_, 0, 0);
}

ReportLink::~ReportLink() {
  stop();
  sem_destroy(&work_);
}

engine::Status ReportLink::start() {
  if (reader_.joinable()) return {};
  stopping_ = false;
  try {
    reader_ = std::thread([this] { runReader(); });
    writer_ = std::thread([this] { runWriter(); });
  } catch (const std::system_error&) {
    stop();
    return engine::failure("no thread can be started for the device", "", "free memory or raise ulimit -u");
  }
  return {};
}

void ReportLink::stop() noexcept {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stopped_.notify_all();
  if (reader_.joinable()) reader_.join();
  sem_post(&work_);
  if (writer_.joinable()) writer_.join();
  new_port_.reset();
}

void ReportLink::write(const glm::dvec3& output) noexcept {
  published_ns_ = engine::steadyNs();
  output_.publish({output, published_ns_});
  // Increments a counter and, if the writer sleeps, makes one futex call that wakes it; never waits. It fails
  // only when the counter is full, and then the writer is awake anyway.
  sem_post(&work_);
}

DeviceCounters ReportLink::counters() const noexcept {
  DeviceCounters c;
  c.inputs = inputs_.load(std::memory_order_relaxed);
  c.skipped = skipped_.load(std::memory_order_relaxed);
  c.bad_inputs = bad_inputs_.load(std::memory_order_relaxed);
  c.outputs = outputs_.load(std::memory_order_relaxed);
  c.forced_zeros = forced_zeros_.load(std::memory_order_relaxed);
  c.failed_outputs = failed_outputs_.load(std::memory_order_relaxed);
  c.connects = connects_.load(std::memory_order_relaxed);
  c.disconnects = disconnects_.load(std::memory_order_relaxed);
  c.longest_output_ns = longest_output_ns_.load(std::memory_order_relaxed);
  return c;
}

void ReportLink::passToWriter(std::unique_ptr<ReportPort> port, Pacing pacing) noexcept {
  {
    const std::lock_guard lock(mutex_);
    new_port_ = std::move(port);
    replace_port_ = true;
    pacing_ = pacing;
    inputs_at_open_ = inputs_.load(std::memory_order_relaxed);
    ++generation_;
  }
  sem_post(&work_);
}

void ReportLink::setPacing(Pacing pacing) noexcept {
  {
    const std::lock_guard lock(mutex_);
    if (pacing_ == pacing) return;
    pacing_ = pacing;
    ++generation_;
  }
  sem_post(&work_);
}

bool ReportLink::waitForPlug() noexcept {
  std::unique_lock lock(mutex_);
  stopped_.wait_for(lock, kPlugWait, [this] { return stopping_; });
  return !stopping_;
}

void ReportLink::runReader() noexcept {
  becomeLinkThread("fettle-hid-in");
  do {
    std::optional<OpenedPorts> ports = source_->open();
    if (!ports || !ports->reading) continue;
    add(connects_);
    const Pacing pacing = handler_.onOpen(ports->input_bytes);
    passToWriter(std::move(ports->writing), pacing);
    const Ended ended = readWhileConnected(*ports->reading);
    handler_.onLost();
    // On a stop the writer keeps its port: it sends a last zero.
    if (ended == Ended::kStopping) return;
    add(disconnects_);
    passToWriter(nullptr, Pacing::kNone);
  } while (waitForPlug());
}

ReportLink::Ended ReportLink::readWhileConnected(ReportPort& port) noexcept {
  std::array<std::uint8_t, kLongestReport> buffer;
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) return Ended::kStopping;
    }
    std::uint64_t good = 0;
    std::chrono::milliseconds wait = kReadWait;
    ReadOutcome outcome;
    for (int i = 0; i < kDrainLimit; ++i) {
      outcome = port.read(buffer, wait);
      if (outcome.kind != PortRead::kReport) break;
      wait = std::chrono::milliseconds{0};
      if (handler_.onReport({buffer.data(), outcome.size}, engine::steadyNs()))
        ++good;
      else
        add(bad_inputs_);
    }
    if (good > 0) {
      skipped_.fetch_add(good - 1, std::memory_order_relaxed);
      const std::uint64_t inputs = inputs_.fetch_add(good, std::memory_order_relaxed) + good;
      setPacing(handler_.onCaughtUp(inputs));
      sem_post(&work_);
    }
    if (outcome.kind == PortRead::kGone) return Ended::kGone;
  }
}

void ReportLink::waitForWork(std::int64_t until_ns) noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;
  // steady_clock is CLOCK_MONOTONIC, which changes of the wall clock do not affect.
  const timespec at{.tv_sec = until_ns / kSecond, .tv_nsec = until_ns % kSecond};
  if (sem_clockwait(&work_, CLOCK_MONOTONIC, &at) != 0) return;
  while (sem_trywait(&work_) == 0) {  // several wake-ups are handled at once
  }
}

PortWrite ReportLink::send(ReportPort& port, OutputRule::Send what, const glm::dvec3& value) noexcept {
  std::array<std::uint8_t, kLongestReport> report;
  const bool zero = what == OutputRule::Send::kZero;
  const std::size_t size = handler_.encode(zero ? glm::dvec3{0.0} : value, report);
  if (size == 0) return PortWrite::kFailed;
  const std::int64_t start = engine::steadyNs();
  writing_since_ns_.store(start, std::memory_order_relaxed);
  const PortWrite outcome = port.write({report.data(), size});
  writing_since_ns_.store(0, std::memory_order_relaxed);
  const std::int64_t took = engine::steadyNs() - start;
  // Relaxed, no compare-and-swap: only this thread writes it.
  if (took > longest_output_ns_.load(std::memory_order_relaxed))
    longest_output_ns_.store(took, std::memory_order_relaxed);
  add(outcome == PortWrite::kDone ? outputs_ : failed_outputs_);
  if (zero && outcome == PortWrite::kDone) add(forced_zeros_);
  return outcome;
}

void ReportLink::runWriter() noexcept {
  becomeLinkThread("fettle-hid-out");
  std::unique_ptr<ReportPort> port;
  OutputRule rule(Pacing::kNone, times_);
  std::uint64_t generation = 0;
  for (;;) {
    const std::int64_t now = engine::steadyNs();
    waitForWork(port ? rule.deadline(now) : now + 1'000'000'000);
    bool stopping = false;
    {
      const std::lock_guard lock(mutex_);
      stopping = stopping_;
      if (generation != generation_) {
        generation = generation_;
        if (replace_port_) port = std::move(new_port_);
        replace_port_ = false;
        rule = OutputRule(pacing_, times_);
        // From the opening on: the input that determined the pacing needs its reply too.
        rule.open(engine::steadyNs(), inputs_at_open_);
      }
    }
    if (stopping) break;
    if (!port) continue;
    if (output_.take()) rule.force(output_.latest().written_ns);
    const auto what = rule.decide(engine::steadyNs(), inputs_.load(std::memory_order_relaxed));
    if (what == OutputRule::Send::kNothing) continue;
    const PortWrite outcome = send(*port, what, output_.latest().value);
    if (outcome == PortWrite::kDone) sent_ns_.store(output_.latest().written_ns, std::memory_order_relaxed);
    if (outcome == PortWrite::kGone) port.reset();
  }
  if (port) static_cast<void>(send(*port, OutputRule::Send::kZero, glm::dvec3{0.0}));
}

}  // namespace fettle::haptic
