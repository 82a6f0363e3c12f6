#include "bench/large_bench.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "bench/large_picture.h"
#include "bench/large_scan.h"
#include "bench/machine.h"
#include "bench/repeats.h"
#include "bench/temporary_folder.h"
#include "engine/base/memory.h"
#include "engine/base/stopwatch.h"
#include "engine/field/live_field.h"
#include "engine/field/tile_store.h"
#include "engine/filter/filter.h"
#include "engine/formats/formats.h"
#include "engine/history/history.h"
#include "haptic/base/rt_thread.h"
#include "haptic/devices/virtual/replay_device.h"
#include "haptic/loop/haptic_loop.h"
#include "haptic/scene/scene.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::bench {

namespace {

namespace fs = std::filesystem;

constexpr std::int32_t kSmallSide = 1024;
constexpr double kLargeTicks = 200'000;
constexpr int kStrokeTicks = 2000;
constexpr double kLoopSeconds = 10.0;

std::uint64_t diskReads() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_majflt);
}

std::uint64_t diskReadsOfAll() noexcept {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_majflt);
}

// Runs one stage and records its time and memory.
class Stages {
 public:
  explicit Stages(LargeReport& report) : report_(report) {}

  LargeStage& run(const std::string& name, double samples, const std::function<void()>& work) {
    engine::resetPeak();
    const std::uint64_t reads = diskReadsOfAll();
    LargeStage stage;
    stage.name = name;
    stage.samples = samples;
    stage.seconds = secondsOf(work);
    const engine::ResidentMemory memory = engine::residentMemory();
    stage.resident = memory.now;
    stage.peak = memory.peak;
    stage.own = memory.own;
    stage.disk_reads = diskReadsOfAll() - reads;
    report_.peak = std::max(report_.peak, stage.peak);
    report_.stages.push_back(std::move(stage));
    return report_.stages.back();
  }

  // As run, for a stage that can fail.
  engine::Result<LargeStage*> tried(const std::string& name, double samples,
                                    const std::function<engine::Status()>& work) {
    engine::Status status;
    LargeStage& stage = run(name, samples, [&] { status = work(); });
    if (!status) return tl::unexpected(status.error());
    return &stage;
  }

 private:
  LargeReport& report_;
};

// Seconds for plain reading of a file, and, with a target, for writing the data and flushing it.
engine::Result<double> plainly(const std::string& from, const std::string& to) {
  const auto cannot = [](const std::string& path) {
    return engine::inputError("the file cannot be read or written plainly", path, "the disk may be full");
  };
  const int in = open(from.c_str(), O_RDONLY | O_CLOEXEC);
  if (in < 0) return cannot(from);
  int out = -1;
  if (!to.empty()) {
    out = open(to.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, S_IRUSR | S_IWUSR);
    if (out < 0) {
      close(in);
      return cannot(to);
    }
  }
  std::vector<char> buffer(std::size_t{1} << 20);
  bool good = true;
  const double seconds = secondsOf([&] {
    ssize_t got = 0;
    while (good && (got = read(in, buffer.data(), buffer.size())) > 0)
      if (out >= 0) good = write(out, buffer.data(), static_cast<std::size_t>(got)) == got;
    good = good && got == 0 && (out < 0 || fsync(out) == 0);
  });
  close(in);
  if (out >= 0) close(out);
  if (!good) return cannot(to.empty() ? from : to);
  return seconds;
}

// Ticks on both fields in turn, so that a change of the machine's speed affects both; then timed one by one.
LargeTicks ticks(const engine::Version& large, const engine::Version& small, haptic::Tool tool,
                 const std::string& name, double effort) {
  const haptic::Scene scene = haptic::defaultScene();
  trials::HandMotion motion;
  motion.ticks = std::llround(kLargeTicks * effort);
  motion.speed_mm_s = 20.0;
  motion.tool = tool;
  const std::vector<haptic::StrokeSample> on_large = trials::handStroke(large, motion);
  const std::vector<haptic::StrokeSample> on_small = trials::handStroke(small, motion);
  const haptic::DenormalScope as_in_the_loop;
  const auto time = [&](const engine::Version& field, const std::vector<haptic::StrokeSample>& strokes) {
    engine::LiveField live(field, engine::Growth::kAllowed);
    haptic::Tick tick(scene, live, field);
    return 1e9 / static_cast<double>(strokes.size()) * secondsOf([&] {
             for (const haptic::StrokeSample& s : strokes) (void)tick.run(s);
           });
  };
  LargeTicks result;
  result.name = name;
  result.ticks = motion.ticks;
  std::vector<double> large_ns, small_ns;
  for (int i = 0; i < 5; ++i) {
    small_ns.push_back(time(small, on_small));
    large_ns.push_back(time(large, on_large));
  }
  result.ns = median(large_ns);
  result.small_ns = median(small_ns);

  engine::LiveField live(large, engine::Growth::kAllowed);
  haptic::Tick tick(scene, live, large);
  std::vector<double> single;
  single.reserve(on_large.size());
  for (const haptic::StrokeSample& s : on_large) {
    const std::uint64_t before = diskReads();
    const engine::Stopwatch watch;
    (void)tick.run(s);
    single.push_back(watch.ns());
    if (diskReads() != before) ++result.waited;
  }
  std::sort(single.begin(), single.end());
  result.p999_ns = single[single.size() * 999 / 1000];
  result.worst_ns = single.back();
  return result;
}

// In real time, as in the window: contact and waits of the loop.
engine::Status liveLoop(const engine::Version& field, double effort, Stages& stages, LargeLoop& result,
                        engine::JobControl& job) {
  trials::HandMotion motion;
  motion.ticks = std::llround(kLoopSeconds * effort * 1000.0);
  motion.tool = haptic::Tool::kSmooth;
  haptic::ReplayDevice device(trials::handStroke(field, motion));
  // All other samples, so that those under the hand are evicted if memory is smaller than the field.
  stages.run("read every sample", static_cast<double>(field.grid().samples()),
             [&] { static_cast<void>(engine::summarize(field)); });
  haptic::HapticLoop::Settings settings;
  settings.options.limits = haptic::limitsFor(device.profile());
  settings.options.record_capacity = 1 << 12;
  haptic::Scene scene = haptic::defaultScene();
  scene.brush_radius_samples = 2.0;
  auto created = haptic::HapticLoop::create(field, field, scene, device, settings);
  if (!created) return tl::unexpected(created.error());
  haptic::HapticLoop& loop = **created;
  const auto target = static_cast<std::uint64_t>(motion.ticks);
  const auto takeRecords = [&] {
    for (haptic::LoopEvent event; loop.poll(event);) {
    }
    for (haptic::TickRecord record; loop.pollRecord(record);) result.contact_ticks += record.contact ? 1 : 0;
  };
  engine::Status status;
  LargeStage& stage = stages.run("live loop", 0.0, [&] {
    status = loop.start();
    while (status && loop.state().tick < target && !job.cancelled()) {
      takeRecords();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    static_cast<void>(loop.stop());
    takeRecords();
  });
  if (!status) return status;
  if (job.cancelled()) return engine::cancelled();
  const haptic::LoopState& state = loop.state();
  const haptic::TimingFigures compute = loop.timing().compute.figures();
  result.ticks = state.tick;
  result.not_prefetched = state.not_prefetched;
  result.disk_waits = loop.diskWaits();
  result.prefetched = loop.tilePrefetcher() != nullptr ? loop.tilePrefetcher()->prefetched() : 0;
  result.not_locked = loop.tilePrefetcher() != nullptr ? loop.tilePrefetcher()->notLocked() : 0;
  result.compute_p50_us = 1e-3 * static_cast<double>(compute.p50_ns);
  result.compute_p999_us = 1e-3 * static_cast<double>(compute.p999_ns);
  result.compute_worst_us = 1e-3 * static_cast<double>(compute.worst_ns);
  stage.note = fmt::format("{} ticks at 1 kHz", state.tick);
  return {};
}

engine::Status enoughRoom(const LargeOptions& options, const fs::path& folder, std::uint64_t& store_bytes) {
  const auto side = static_cast<std::uint64_t>(options.side);
  const std::uint64_t field = engine::fieldBytes(side, side);
  // The scan and the filtered one; the small field, buffers and the program.
  constexpr std::uint64_t kReserve = std::uint64_t{200} << 20;
  const auto place = engine::placeOf(side, side, kReserve, "bench large");
  if (!place) return tl::unexpected(place.error());
  const bool stored = *place == engine::Place::kStore;
  store_bytes = stored ? field * 2 + field / 10 : 0;
  const std::uint64_t available = engine::availableMemory();
  if (!stored && available != 0 && 2 * field + kReserve > available)
    return engine::inputError(fmt::format("the run needs {} MB of memory, {} MB are free",
                                          (2 * field + kReserve) >> 20, available >> 20),
                              "bench large",
                              "take a smaller --side, or put the tiles on a disk with --store");
  std::error_code error;
  const auto needs = [&](const fs::path& where, std::uint64_t bytes, const char* what) -> engine::Status {
    const std::uint64_t free_bytes = fs::space(where, error).available;
    if (error || free_bytes >= bytes) return {};
    return engine::inputError(
        fmt::format("{} need {} MB of the disk, {} MB are free", what, bytes >> 20, free_bytes >> 20),
        where.string(), "make room, take a smaller --side or another folder");
  };
  // The scan, the saved one and its plain copy. A store needs additional space.
  const std::uint64_t files = 3 * largeScanBytes(options.side);
  if (engine::Status ok = needs(folder, files, "the files"); !ok) return ok;
  if (stored) {
    const std::string where = engine::storePolicy().folder;
    if (engine::Status ok = needs(where, store_bytes + files, "tiles and files"); !ok) return ok;
  }
  return {};
}

engine::Result<engine::Version> filtered(const engine::Version& field, engine::FilterKind kind, int window,
                                         engine::JobControl& job) {
  engine::FilterSpec spec;
  spec.kind = kind;
  spec.window = window;
  auto done = engine::applyFilter(field, field, spec, job);
  if (!done) return tl::unexpected(done.error());
  return std::move(done->field);
}

// The first picture, then the cost of undoing a filter for the window.
engine::Status draw(const engine::History& history, Stages& stages, double samples, engine::JobControl& job) {
  auto picture = LargePicture::create();
  if (!picture) return tl::unexpected(picture.error());
  const auto show = [&](const std::string& name, const engine::Version& version) -> engine::Status {
    PictureSteps steps;
    auto drawn = stages.tried(name, samples, [&]() -> engine::Status {
      const auto shown = picture->show(version, job);
      if (!shown) return tl::unexpected(shown.error());
      steps = *shown;
      return {};
    });
    if (!drawn) return tl::unexpected(drawn.error());
    (*drawn)->note = fmt::format("first frame after {:.0f} ms, {} frames; the window held {:.0f} ms at most",
                                 1e3 * steps.first_s, steps.frames, 1e3 * steps.longest_s);
    return {};
  };
  if (auto ok = show("draw it, 1280 x 800, until sharp", history.current()); !ok) return ok;
  return show("another state of every tile", history.state(history.number() - 1));
}

}  // namespace

engine::Result<LargeReport> benchLarge(const LargeOptions& options, engine::JobControl& job) {
  if (options.side < 256 || options.side > 131072)
    return engine::inputError("the side is out of range", "bench large", "256 to 131072");
  if (!(options.effort >= 0.01 && options.effort <= 1.0))
    return engine::inputError("the effort is out of range", "bench large", "0.01 to 1");
  const auto folder =
      options.folder.empty() ? TemporaryFolder::create() : TemporaryFolder::create(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  std::uint64_t store_bytes = 0;
  if (engine::Status room = enoughRoom(options, folder->path(), store_bytes); !room)
    return tl::unexpected(room.error());

  LargeReport report;
  report.machine = machine();
  report.side = options.side;
  report.copy_bytes_per_s = copyBytesPerSecond();
  Stages stages(report);
  const double samples = static_cast<double>(options.side) * options.side;
  const double copy_s = samples * sizeof(float) / report.copy_bytes_per_s;
  const std::string scan = (folder->path() / "scan.tif").string();
  const std::string saved = (folder->path() / "filtered.tif").string();

  if (auto made =
          stages.tried("make the scan", samples, [&] { return writeLargeScan(scan, options.side, job); });
      !made)
    return tl::unexpected(made.error());
  report.file_bytes = fs::file_size(scan);

  const auto read_plainly = plainly(scan, {});
  if (!read_plainly) return tl::unexpected(read_plainly.error());
  engine::Version field;
  auto opened = stages.tried("open", samples, [&]() -> engine::Status {
    engine::ImportOptions import;
    import.unit = engine::LengthUnit{};
    auto imported = engine::importField(scan, import, job);
    if (!imported) return tl::unexpected(imported.error());
    field = std::move(imported->field);
    return {};
  });
  if (!opened) return tl::unexpected(opened.error());
  (*opened)->plain_seconds = *read_plainly;
  (*opened)->plain = "read the file";

  {
    const engine::Version small = trials::workpiece(kSmallSide, kSpacingMm);
    stages.run("feel", 0.0, [&] {
      report.ticks.push_back(ticks(field, small, haptic::Tool::kFeel, "feel", options.effort));
      report.ticks.push_back(ticks(field, small, haptic::Tool::kSmooth, "3 x 3 smoothing", options.effort));
    });
  }
  if (engine::Status looped = liveLoop(field, options.effort, stages, report.loop, job); !looped)
    return tl::unexpected(looped.error());

  engine::LiveField live(field, engine::Growth::kAllowed);
  engine::History history(std::exchange(field, {}));
  {
    haptic::Scene scene = haptic::defaultScene();
    scene.brush_radius_samples = 8.0;
    trials::HandMotion motion;
    motion.ticks = kStrokeTicks;
    motion.tool = haptic::Tool::kSmooth;
    const std::vector<haptic::StrokeSample> stroke = trials::handStroke(history.current(), motion);
    haptic::Tick tick(scene, live, history.current());
    LargeStage& edited = stages.run("brush stroke", 0.0, [&] {
      for (const haptic::StrokeSample& s : stroke) (void)tick.run(s);
    });
    edited.note = fmt::format("{} ticks, radius 8", stroke.size());
  }
  const int rounds = std::max(10, static_cast<int>(1000 * options.effort));
  engine::Version snapshot;
  stages
      .run("snapshot", 0.0,
           [&] {
             for (int i = 0; i < rounds; ++i) snapshot = live.snapshot();
           })
      .seconds /= rounds;
  stages.run("keep the stroke in the history", 0.0, [&] { (void)history.push({}, std::move(snapshot)); });
  report.stroke_tiles = engine::measureChange(history.state(0), history.current()).tiles;
  stages.run("undo the stroke", 0.0, [&] { (void)live.adopt(*history.undo()); });
  stages.run("redo the stroke", 0.0, [&] { (void)live.adopt(*history.redo()); });

  const auto filter = [&](const std::string& name, engine::FilterKind kind,
                          int window) -> engine::Result<LargeStage*> {
    auto stage = stages.tried(name, samples, [&]() -> engine::Status {
      auto result = filtered(history.current(), kind, window, job);
      if (!result) return tl::unexpected(result.error());
      (void)history.push({}, *result);
      (void)live.adopt(*std::move(result));
      return {};
    });
    if (!stage) return stage;
    (*stage)->plain_seconds = copy_s;
    (*stage)->plain = "copy as much, one thread";
    return stage;
  };
  if (auto ok = filter("median 3 x 3", engine::FilterKind::kMedian, 3); !ok)
    return tl::unexpected(ok.error());
  stages.run("undo the filter", 0.0, [&] { (void)live.adopt(*history.undo()); });
  // A new history of the same states: no version then holds the filter's result.
  stages.run("free what it made", 0.0, [&] {
    engine::Version now = history.current();
    history = engine::History(history.state(0));
    (void)history.push({}, std::move(now));
  });
  if (auto ok = filter("box 11 x 11", engine::FilterKind::kBox, 11); !ok) return tl::unexpected(ok.error());

  if (options.picture)
    if (auto drawn = draw(history, stages, samples, job); !drawn) return tl::unexpected(drawn.error());

  auto wrote = stages.tried("save", samples, [&]() -> engine::Status {
    engine::ExportOptions packed;
    packed.tiff_compression = engine::TiffCompression::kDeflate;
    const auto exported = engine::exportField(history.current(), saved, packed, job);
    if (!exported) return tl::unexpected(exported.error());
    return {};
  });
  if (!wrote) return tl::unexpected(wrote.error());
  report.saved_bytes = fs::file_size(saved);
  const auto copied = plainly(saved, (folder->path() / "plain_copy.tif").string());
  if (!copied) return tl::unexpected(copied.error());
  (*wrote)->plain_seconds = *copied;
  (*wrote)->plain = "copy the saved file, flushed";
  (*wrote)->note = fmt::format("{:.2f} GB", static_cast<double>(report.saved_bytes) * 1e-9);

  stages.run("hash of what was saved", samples,
             [&] { report.hash = engine::contentHash(history.current()); });
  stages.run("undo the filter and the stroke", 0.0, [&] {
    (void)history.undo();
    (void)live.adopt(*history.undo());
  });
  const auto& store = history.current().memory()->store;
  report.stored_bytes = store ? store->bytes() : 0;
  return report;
}

}  // namespace fettle::bench
