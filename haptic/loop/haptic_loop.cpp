#include "haptic/loop/haptic_loop.h"

#include <bit>
#include <new>
#include <system_error>

#include <sys/resource.h>

#include "engine/base/stopwatch.h"
#include "engine/field/tile_store.h"
#include "haptic/loop/pacer.h"
#include "haptic/safety/last_resort.h"

namespace fettle::haptic {

namespace {

std::uint64_t diskWaitsOfThisThread() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_majflt);
}

}  // namespace

engine::Result<std::unique_ptr<HapticLoop>> HapticLoop::create(const engine::Version& start,
                                                               const engine::Version& original,
                                                               const Scene& scene, Device& device,
                                                               const Settings& settings) {
  if (const auto problem = sceneProblem(scene)) return engine::inputError(*problem, "scene");
  if (const auto problem = limitsProblem(settings.options.limits))
    return engine::inputError(*problem, "safety limits of " + device.profile().name);
  if (!(settings.rate_hz >= Pacer::kLowestRate_hz && settings.rate_hz <= Pacer::kHighestRate_hz))
    return engine::inputError("a loop runs at 1000 to 10000 ticks per second", "rate");
  if (!std::has_single_bit(settings.options.command_capacity) ||
      !std::has_single_bit(settings.options.event_capacity) || settings.options.event_capacity < 8 ||
      (settings.options.record_capacity != 0 && !std::has_single_bit(settings.options.record_capacity)))
    return engine::inputError("ring capacities are powers of two, that of events 8 or more", "loop options");
  if (start.grid().width != original.grid().width || start.grid().height != original.grid().height)
    return engine::inputError("the original field has another size than the field", "loop",
                              "give the scan that the field was made from");
  try {
    auto prepared = std::make_unique<PreparedScene>(scene, original, settings.sounds);
    return std::unique_ptr<HapticLoop>(new HapticLoop(start, std::move(prepared), device, settings));
  } catch (const std::bad_alloc&) {
    return engine::failure("memory for the loop could not be allocated", "loop", "close other programs");
  }
}

HapticLoop::HapticLoop(const engine::Version& start, std::unique_ptr<PreparedScene> scene, Device& device,
                       const Settings& settings)
    : settings_(settings),
      memory_(start.memory()),
      channels_(settings.options),
      tile_prefetcher_(memory_->store ? std::make_unique<TilePrefetcher>() : nullptr),
      tick_(std::move(scene), start, device, channels_, settings.options, tile_prefetcher_.get()) {}

HapticLoop::~HapticLoop() {
  static_cast<void>(stop());
}

engine::Status HapticLoop::start() {
  try {
    keeper_.emplace(memory_, settings_.pool);
    thread_ = std::thread([this] { main(); });
  } catch (const std::system_error& e) {
    return engine::failure(e.what(), "starting the haptic loop");
  } catch (const std::bad_alloc&) {
    return engine::failure("memory for the haptic loop could not be allocated", "starting the haptic loop");
  }
  // Acquire pairs with the release in main: the report is complete.
  ready_.wait(false, std::memory_order_acquire);
  try {
    if (tile_prefetcher_) tile_prefetcher_->start();
  } catch (const std::system_error& e) {
    static_cast<void>(stop());
    return engine::failure(e.what(), "starting the thread that reads the field from the disk");
  }
  return {};
}

engine::Version HapticLoop::stop() {
  if (thread_.joinable()) {
    // Relaxed: the loop sees it within a tick or two; the join orders everything else.
    stop_.store(true, std::memory_order_relaxed);
    thread_.join();
    keeper_.reset();
  }
  return tick_.scene().field.snapshot();
}

void HapticLoop::main() noexcept {
  const RealTimeScope real_time(settings_.real_time);
  const HandlerStack handler_stack;
  const DenormalScope denormals;
  // All pages are locked now; those of a field in a store must not be.
  if (memory_->store) memory_->store->unlock();
  const std::uint64_t waits_before = diskWaitsOfThisThread();
  const auto noteDiskWaits = [&] {
    disk_waits_.store(diskWaitsOfThisThread() - waits_before, std::memory_order_relaxed);
  };
  real_time_ = real_time.report();
  ready_.store(true, std::memory_order_release);
  ready_.notify_one();

  Pacer pacer(settings_.rate_hz);
  while (!stop_.load(std::memory_order_relaxed)) {
    const Pacer::Tick tick = pacer.wait();
    tick_.run(tick.woke_ns, tick.since_ns);
    timing_.lateness.add(tick.lateness_ns);
    timing_.compute.add(engine::steadyNs() - tick.woke_ns);
    if (tick.skipped > 0) timing_.addMissed(tick.skipped);
    if (tick_.state().tick % 1024 == 0) noteDiskWaits();
  }
  tick_.stop();
  noteDiskWaits();
}

}  // namespace fettle::haptic
