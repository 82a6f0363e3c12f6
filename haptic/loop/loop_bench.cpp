#include "haptic/loop/loop_bench.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <deque>
#include <fstream>
#include <memory>
#include <new>
#include <system_error>
#include <thread>

#include <sched.h>
#include <unistd.h>

#include "engine/base/stopwatch.h"
#include "engine/field/builder.h"
#include "haptic/devices/enumerate.h"
#include "haptic/loop/cyclictest.h"
#include "haptic/loop/haptic_loop.h"
#include "haptic/loop/pacer.h"

namespace fettle::haptic {

namespace {

constexpr std::int32_t kSide = 1024;
constexpr double kSpacing_mm = 0.1;
constexpr double kSlice_s = 5.0;
constexpr double kShortestCyclictest_s = 0.5;  // it takes some 10 ms to start

// A noisy plate, on which smoothing always changes samples.
engine::Version benchField() {
  engine::Grid grid;
  grid.width = grid.height = kSide;
  grid.spacing_x = grid.spacing_y = kSpacing_mm;
  std::vector<float> heights(static_cast<std::size_t>(kSide) * kSide);
  std::uint32_t state = 1;
  for (float& z : heights) {
    state = state * 1664525U + 1013904223U;  // Numerical Recipes' generator: the same field everywhere
    z = 0.05F * static_cast<float>(state >> 8U) / 16777216.0F;
  }
  return engine::makeField(grid, heights);
}

// A hand that presses and sweeps, one input per tick.
class SimulatedPress : public Device {
 public:
  SimulatedPress() {
    profile_.name = "simulated press";
    profile_.space = DeviceSpace::kField;
    profile_.gives_force = true;
    input_.link = LinkState::kConnected;
    input_.buttons = kPrimaryButton;
  }
  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] DeviceInput read() noexcept override {
    const std::int64_t now = engine::steadyNs();
    const double t = 1e-9 * static_cast<double>(now);
    constexpr double kMiddle = 0.5 * kSide * kSpacing_mm;
    input_.position_mm = {kMiddle + 0.9 * kMiddle * std::sin(0.7 * t),
                          kMiddle + 0.9 * kMiddle * std::sin(0.9 * t), -0.3 + 0.4 * std::sin(5.0 * t)};
    input_.arrival_ns = now;
    ++input_.sequence;
    return input_;
  }
  void write(const glm::dvec3& force_n) noexcept override { force_ = force_n; }
  engine::Status start() override { return {}; }
  void stop() noexcept override {}

 private:
  DeviceProfile profile_;
  DeviceInput input_;
  glm::dvec3 force_{0.0};
};

// What cyclictest measures: how late an absolute sleep ends.
class PlainThread {
 public:
  PlainThread(double rate_hz, const RealTimeRequest& request, LoopTiming& timing)
      : thread_([this, rate_hz, request, &timing] {
          const RealTimeScope real_time(request);
          report_ = real_time.report();
          Pacer pacer(rate_hz);
          while (!stop_.load(std::memory_order_relaxed)) {
            const Pacer::Tick tick = pacer.wait();
            timing.lateness.add(tick.lateness_ns);
            if (tick.skipped > 0) timing.addMissed(tick.skipped);
          }
        }) {}
  ~PlainThread() { static_cast<void>(stop()); }
  PlainThread& operator=(PlainThread&&) = delete;

  RealTimeReport stop() {
    // Relaxed: seen within a tick; the join orders the report.
    stop_.store(true, std::memory_order_relaxed);
    if (thread_.joinable()) thread_.join();
    return report_;
  }

 private:
  std::atomic<bool> stop_{false};
  RealTimeReport report_;
  std::thread thread_;
};

std::vector<int> usableCores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> cores;
  if (sched_getaffinity(0, sizeof set, &set) == 0)
    for (int core = 0; core < CPU_SETSIZE; ++core)
      if (CPU_ISSET(core, &set)) cores.push_back(core);
  return cores;
}

std::string machineName() {
  std::ifstream file("/proc/cpuinfo");
  std::string processor = "unknown processor";
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name") && line.find(": ") != std::string::npos) {
      processor = line.substr(line.find(": ") + 2);
      break;
    }
  return processor + ", " + std::to_string(usableCores().size()) + " cores";
}

class Measurement {
 public:
  Measurement(const LoopBenchOptions& options, engine::JobControl& job) : options_(options), job_(job) {}

  engine::Result<LoopBenchReport> run() {
    const std::vector<int> cores = usableCores();
    const bool together = cores.size() > 1;
    const int first = cores.empty() ? -1 : cores.front();
    const int last = cores.empty() ? -1 : cores.back();
    const engine::Stopwatch watch;
    job_.begin("measuring", static_cast<std::uint64_t>(1000.0 * options_.seconds));
    std::unique_ptr<BusyProcesses> load;
    if (options_.load == BenchLoad::kBusy)
      load = std::make_unique<BusyProcesses>(std::max(1U, static_cast<unsigned>(cores.size())));
    // An even number, so that both run on each core for the same time.
    const int slices = 2 * std::max(1, static_cast<int>(std::lround(options_.seconds / (2.0 * kSlice_s))));
    const double slice_s = options_.seconds / slices;
    chooseReference(slice_s);
    for (int slice = 0; slice < slices; ++slice) {
      const bool even = slice % 2 == 0;
      if (even) rounds_.emplace_back();
      const engine::Status done =
          together ? measure(even ? last : first, even ? first : last, Which::kBoth, slice_s)
                   : measure(first, first, even ? Which::kLoop : Which::kReference, slice_s);
      if (!done) return tl::unexpected(done.error());
    }
    report_.seconds = watch.seconds();
    report_.rate_hz = options_.rate_hz;
    report_.load = options_.load;
    report_.machine = machineName();
    if (!was_connected_)
      return engine::failure("nothing came from the device", options_.device,
                             "see fettle devices for what is missing");
    fill(report_.loop, options_.device.empty() ? "haptic loop" : "haptic loop, " + options_.device,
         loop_timing_);
    fill(report_.reference, report_.no_cyclictest.empty() ? "cyclictest" : "plain thread", reference_timing_);
    report_.p99_ratio = ratio(report_.loop.lateness.p99_ns, report_.reference.lateness.p99_ns);
    report_.p999_ratio = ratio(report_.loop.lateness.p999_ns, report_.reference.lateness.p999_ns);
    report_.within = ratioIntervals(rounds_);
    return report_;
  }

 private:
  enum class Which : std::uint8_t { kBoth, kLoop, kReference };

  RealTimeRequest requestFor(int core) const {
    RealTimeRequest request;
    request.core = core;
    request.priority = options_.priority;
    return request;
  }

  void chooseReference(double slice_s) {
    if (!Cyclictest::installed())
      report_.no_cyclictest =
          "cyclictest is not installed (package rt-tests): a plain thread is used instead";
    else if (slice_s < kShortestCyclictest_s)
      report_.no_cyclictest = "the time is too short for cyclictest: a plain thread is used instead";
    else
      report_.reference.latency_held =
          ::access("/dev/cpu_dma_latency", W_OK) == 0;  // it reports that and continues
  }

  engine::Status measure(int loop_core, int reference_core, Which which, double seconds) {
    if (which == Which::kLoop) return withLoop(loop_core, seconds);
    const auto alongside = [&] {
      return which == Which::kReference ? wait(seconds, nullptr) : withLoop(loop_core, seconds);
    };
    if (!report_.no_cyclictest.empty()) {
      LoopTiming timing;
      PlainThread plain(options_.rate_hz, requestFor(reference_core), timing);
      engine::Status done = alongside();
      const RealTimeReport granted = plain.stop();
      reference_timing_.addMissed(static_cast<std::int64_t>(timing.missed.load(std::memory_order_relaxed)));
      addReference(timing.lateness);
      report_.reference.missing = granted.missing;
      report_.reference.latency_held = granted.latency_held;
      return done;
    }
    auto cyclictest = Cyclictest::start({reference_core, options_.priority, options_.rate_hz, seconds});
    if (!cyclictest) return tl::unexpected(cyclictest.error());
    if (engine::Status done = alongside(); !done) return done;
    TimingHistogram lateness;
    engine::Status done = cyclictest->finish(lateness);
    if (done) addReference(lateness);
    return done;
  }

  void addReference(const TimingHistogram& lateness) {
    reference_timing_.lateness.add(lateness);
    rounds_.back().other.add(lateness);
  }

  engine::Status withLoop(int core, double seconds) {
    const engine::Version field = benchField();
    auto opened = openMeasured();
    if (!opened) return tl::unexpected(opened.error());
    Device& device = **opened;
    HapticLoop::Settings settings;
    settings.options.tool = Tool::kSmooth;
    settings.options.limits = limitsFor(device.profile());
    settings.rate_hz = options_.rate_hz;
    settings.real_time = requestFor(core);
    Scene scene = defaultScene();
    scene.brush_radius_samples = 2.0;
    auto created = HapticLoop::create(field, field, scene, device, settings);
    if (!created) return tl::unexpected(created.error());
    HapticLoop& loop = **created;
    if (engine::Status started = device.start(); !started) return started;
    if (engine::Status started = loop.start(); !started) return started;
    // Somebody may hold a device: a benchmark pushes nobody's hand.
    if (options_.device.empty()) static_cast<void>(loop.send(loop.armCommand()));
    engine::Status done = wait(seconds, &loop);
    static_cast<void>(loop.stop());
    device.stop();
    was_connected_ = was_connected_ || loop.state().link == LinkState::kConnected;
    report_.device_inputs += device.counters().inputs;
    report_.loop.missing = loop.realTime().missing;
    report_.loop.latency_held = loop.realTime().latency_held;
    report_.refused_edits += loop.state().refused_edits;
    loop_timing_.lateness.add(loop.timing().lateness);
    rounds_.back().mine.add(loop.timing().lateness);
    loop_timing_.compute.add(loop.timing().compute);
    loop_timing_.addMissed(static_cast<std::int64_t>(loop.timing().missed.load(std::memory_order_relaxed)));
    return done;
  }

  [[nodiscard]] engine::Result<std::unique_ptr<Device>> openMeasured() const {
    if (options_.device.empty()) return std::make_unique<SimulatedPress>();
    return openDevice(options_.device, options_.rate_hz);
  }

  // The main thread's part: takes events and reads the state as a display would.
  engine::Status wait(double seconds, HapticLoop* loop) {
    const engine::Stopwatch watch;
    while (watch.seconds() < seconds) {
      if (job_.cancelled()) return engine::cancelled();
      std::this_thread::sleep_for(std::chrono::milliseconds(8));
      job_.advance(8);
      if (loop == nullptr) continue;
      for (LoopEvent event; loop->poll(event);) ++report_.events;
    }
    return {};
  }

  static void fill(LoopBenchRow& row, const std::string& name, const LoopTiming& timing) {
    row.name = name;
    row.lateness = timing.lateness.figures();
    row.compute = timing.compute.figures();
    row.missed = timing.missed.load(std::memory_order_relaxed);
    row.over_1_ms = timing.lateness.countAbove(1'000'000);
  }
  static double ratio(std::int64_t mine, std::int64_t plain) {
    return plain > 0 ? static_cast<double>(mine) / static_cast<double>(plain) : 0.0;
  }

  LoopBenchOptions options_;
  engine::JobControl& job_;
  LoopBenchReport report_;
  LoopTiming loop_timing_, reference_timing_;
  std::deque<TimingRound> rounds_;  // of two slices, in which both change cores
  bool was_connected_ = false;      // the device, in a slice
};

}  // namespace

engine::Result<LoopBenchReport> benchLoop(const LoopBenchOptions& options, engine::JobControl& job) {
  if (!(options.seconds > 0.0 && options.seconds <= 3600.0))
    return engine::inputError("the time to measure is not within 0 and 3600 s", "--seconds",
                              "give a time between");
  if (!(options.rate_hz >= Pacer::kLowestRate_hz && options.rate_hz <= Pacer::kHighestRate_hz))
    return engine::inputError("a loop runs at 1000 to 10000 ticks per second", "--rate",
                              "give a rate between");
  if (options.priority < 0 || options.priority > 99)
    return engine::inputError("a priority is within 0 and 99", "priority");
  try {
    return Measurement(options, job).run();
  } catch (const std::bad_alloc&) {
    return engine::failure("memory for the measurement could not be allocated", "bench loop");
  } catch (const std::system_error& e) {
    return engine::failure(e.what(), "bench loop");
  }
}

}  // namespace fettle::haptic
