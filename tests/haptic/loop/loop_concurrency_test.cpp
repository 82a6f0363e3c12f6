// The live loop on its own thread against everything at once: a display that stalls, a worker whose results
// are adopted every 50 ms, undo while touching, and a hand that never lets go. Nothing may be lost: what the
// events reported must make the field, and so must a single-threaded replay in the same order.

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/stopwatch.h"
#include "engine/field/difference.h"
#include "haptic/loop/haptic_loop.h"
#include "haptic/loop/pacer.h"
#include "tests/haptic/loop/hand_device.h"
#include "tests/haptic/loop/touched_fields.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using tests::bumpy;
using tests::kSide;

constexpr std::size_t kMostTicks = 100'000;

// A hand that stays below the surface and never lets go; keeps what it said, for the replay.
class RestlessHand : public tests::HandDevice {
 public:
  RestlessHand() { said.reserve(kMostTicks); }
  [[nodiscard]] DeviceInput read() noexcept override {
    const std::uint64_t i = said.size();
    input.position_mm = tests::sweep(i, kSide - 1.0, -0.7, 0.1);
    input.tool = i / 900 % 4 == 3 ? Tool::kMark : Tool::kSmooth;
    ++input.sequence;
    input.arrival_ns = engine::steadyNs();
    if (said.size() < kMostTicks) said.push_back({0.0, input.position_mm, *input.tool});
    return input;
  }
  std::vector<StrokeSample> said;
};

// The job: moves every unmarked sample of every other tile; follows from the content of its input alone.
engine::Version job(const engine::Version& input, std::uint64_t id) {
  engine::LiveField field(input, engine::Growth::kAllowed);
  const float step = id % 2 == 0 ? 0.01F : -0.01F;
  std::vector<float> tile(engine::kTileSamples);
  std::vector<std::uint8_t> marks(engine::kTileSamples);
  const engine::FieldReader reader = input.reader();
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = static_cast<std::int32_t>((id + static_cast<std::uint64_t>(tr)) % 2);
         tc < reader.tileColumns(); tc += 2) {
      const std::int32_t c = tc * engine::kTileSide;
      const std::int32_t r = tr * engine::kTileSide;
      const std::int32_t columns = std::min(engine::kTileSide, kSide - c);
      const std::int32_t rows = std::min(engine::kTileSide, kSide - r);
      reader.readHeights(c, r, columns, rows, tile.data(), engine::kTileSide);
      reader.readMarks(c, r, columns, rows, marks.data(), engine::kTileSide);
      for (std::size_t i = 0; i < tile.size(); ++i)
        if (marks[i] == 0) tile[i] += step;
      EXPECT_TRUE(field.writeHeights(c, r, columns, rows, tile.data(), engine::kTileSide));
    }
  return field.snapshot();
}

// A worker with one job at a time.
class Worker {
 public:
  Worker() : thread_([this] { work(); }) {}
  ~Worker() {
    {
      const std::scoped_lock lock(mutex_);
      stop_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }
  void begin(engine::Version input, std::uint64_t id) {
    {
      const std::scoped_lock lock(mutex_);
      input_ = std::move(input);
      id_ = id;
    }
    wake_.notify_one();
  }
  std::optional<engine::Version> done() {
    const std::scoped_lock lock(mutex_);
    std::optional<engine::Version> out;
    out.swap(output_);
    return out;
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      wake_.wait(lock, [this] { return stop_ || input_; });
      if (stop_) return;
      const engine::Version input = std::move(*input_);
      input_.reset();
      const std::uint64_t id = id_;
      lock.unlock();
      engine::Version output = job(input, id);
      lock.lock();
      output_ = std::move(output);
    }
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<engine::Version> input_, output_;
  std::uint64_t id_ = 0;
  bool stop_ = false;
  std::thread thread_;
};

struct Noted {
  EventKind kind;
  std::uint64_t id;
  std::uint64_t tick;
};

TEST(HapticLoop, NothingIsLostAgainstAStallingDisplayAdoptionsAndUndoWithAHandThatNeverLetsGo) {
  const engine::Version start = bumpy();
  Scene scene = defaultScene();
  scene.brush_radius_samples = 1.5;
  scene.mark_radius_samples = 1.0;
  RestlessHand hand;
  HapticLoop::Settings settings;
  settings.options = tests::testOptions(Tool::kFeel);
  settings.options.event_capacity = 16;
  settings.real_time.priority = 0;
  settings.real_time.lock_memory = settings.real_time.hold_latency = false;
  settings.pool.tiles = 100;
  auto created = HapticLoop::create(start, start, scene, hand, settings);
  ASSERT_TRUE(created);
  HapticLoop& loop = **created;
  ASSERT_TRUE(loop.start());

  std::mt19937_64 random(11);
  Worker worker;
  std::vector<Noted> noted;
  std::vector<engine::Version> history;  // of each event
  std::vector<std::uint64_t> restore_targets;
  tests::Mirror mirror(start);
  engine::Version newest = start;
  bool job_running = false;
  std::uint64_t adopted = 0, refused = 0, restored = 0;
  const auto take = [&](LoopEvent& event) {
    EXPECT_TRUE(event.before == newest) << "a state was left out";
    newest = event.version;
    mirror.take(event.version, event.rect);
    noted.push_back({event.kind, event.id, event.tick});
    history.push_back(event.version);
    if (event.kind == EventKind::kSnapshot) worker.begin(event.version, event.id);
    if (event.kind == EventKind::kAdopted || event.kind == EventKind::kAdoptRefused) job_running = false;
    adopted += event.kind == EventKind::kAdopted ? 1 : 0;
    refused += event.kind == EventKind::kAdoptRefused ? 1 : 0;
    restored += event.kind == EventKind::kRestored ? 1 : 0;
  };
  const auto send = [&](CommandKind kind, std::uint64_t id, engine::Version version) {
    LoopCommand command;
    command.kind = kind;
    command.id = id;
    command.version = std::move(version);
    EXPECT_TRUE(loop.send(std::move(command)));
  };

  std::uint64_t job_id = 0;
  auto next_job = Clock::now();
  auto next_undo = Clock::now() + milliseconds(300);
  auto next_stall = Clock::now() + milliseconds(200);
  const auto begin = Clock::now();
  // 3.5 s; as much longer as a machine with other work takes for what is counted below.
  const auto enough = [&] { return adopted > 10 && restored > 5; };
  while (Clock::now() < begin + milliseconds(enough() ? 3500 : 60'000)) {
    for (LoopEvent event; loop.poll(event);) take(event);
    const auto now = Clock::now();
    if (!job_running && now >= next_job) {
      send(CommandKind::kSnapshot, ++job_id, {});
      job_running = true;
      next_job = now + milliseconds(50);
    }
    if (auto result = worker.done()) send(CommandKind::kAdopt, job_id, std::move(*result));
    if (now >= next_undo && !history.empty()) {
      const std::uint64_t target = random() % history.size();
      send(CommandKind::kRestore, target, history[target]);
      next_undo = now + milliseconds(350);
    }
    if (now >= next_stall) {
      std::this_thread::sleep_for(milliseconds(250));
      next_stall = now + milliseconds(700);
    }
    std::this_thread::sleep_for(milliseconds(1));
  }
  while (job_running) {
    for (LoopEvent event; loop.poll(event);) take(event);
    if (auto result = worker.done()) send(CommandKind::kAdopt, job_id, std::move(*result));
    std::this_thread::sleep_for(milliseconds(1));
  }
  for (LoopEvent event; loop.poll(event);) take(event);
  const engine::Version field = loop.stop();
  for (LoopEvent event; loop.poll(event);) take(event);

  const LoopState state = loop.state();
  EXPECT_EQ(mirror.differences(field), 0U);
  EXPECT_EQ(state.refused_edits, 0U);
  EXPECT_GT(state.merged, 0U);
  EXPECT_GT(adopted, 10U);
  EXPECT_GT(state.carried, 0U);
  EXPECT_GT(restored, 5U);
  EXPECT_EQ(state.tick, hand.said.size());
  EXPECT_EQ(loop.timing().compute.figures().count, state.tick);

  // The same in the same order, on one thread.
  const DenormalScope denormals;
  engine::LiveField live(bumpy(), engine::Growth::kAllowed);
  Tick tick(scene, live, live.snapshot());
  std::vector<engine::Version> states;
  engine::Version base;
  std::size_t next = 0;
  for (std::uint64_t k = 0; k <= hand.said.size(); ++k) {
    for (; next < noted.size() && noted[next].tick == k; ++next) {
      const Noted& event = noted[next];
      if (event.kind == EventKind::kSnapshot) base = live.snapshot();
      if (event.kind == EventKind::kRestored) static_cast<void>(live.adopt(states[event.id]));
      if (event.kind == EventKind::kAdopted) {
        const engine::Version now = live.snapshot();
        static_cast<void>(live.adopt(job(base, event.id)));
        for (const engine::TileChange& edit : engine::changedTiles(base, now))
          ASSERT_TRUE(live.replaceTile(edit.tile_column, edit.tile_row, edit.after));
      }
      tick.fieldChanged();
      states.push_back(live.snapshot());
    }
    if (k < hand.said.size()) static_cast<void>(tick.run(hand.said[k]));
  }
  EXPECT_EQ(next, noted.size());
  EXPECT_EQ(engine::contentHash(live.snapshot()), engine::contentHash(field));
  std::printf(
      "%llu ticks, %zu events, %llu merged, %llu adopted, %llu refused, %llu tiles carried, %llu undone\n",
      static_cast<unsigned long long>(state.tick), noted.size(),
      static_cast<unsigned long long>(state.merged), static_cast<unsigned long long>(adopted),
      static_cast<unsigned long long>(refused), static_cast<unsigned long long>(state.carried),
      static_cast<unsigned long long>(restored));
}

TEST(HapticLoop, StateSlotIsNeverTorn) {
  const engine::Version start = bumpy();
  RestlessHand hand;
  HapticLoop::Settings settings;
  settings.options = tests::testOptions(Tool::kFeel);
  settings.rate_hz = 5000.0;
  settings.real_time.priority = 0;
  settings.real_time.lock_memory = settings.real_time.hold_latency = false;
  auto created = HapticLoop::create(start, start, defaultScene(), hand, settings);
  ASSERT_TRUE(created);
  HapticLoop& loop = **created;
  ASSERT_TRUE(loop.start());
  std::uint64_t last = 0;
  const auto end = Clock::now() + milliseconds(700);
  while (Clock::now() < end) {
    const LoopState state = loop.state();
    ASSERT_GE(state.tick, last);
    if (state.tick > 0) {
      ASSERT_EQ(state.endpoint_mm, tests::sweep(state.tick - 1, kSide - 1.0, -0.7, 0.1)) << state.tick;
    }
    last = state.tick;
    for (LoopEvent event; loop.poll(event);) {
    }
  }
  EXPECT_GT(last, 500U);
  static_cast<void>(loop.stop());
  EXPECT_EQ(hand.force, glm::dvec3(0.0));
}

TEST(HapticLoop, RefusesWhatIsOutOfRange) {
  const engine::Version start = bumpy();
  RestlessHand hand;
  HapticLoop::Settings settings;
  settings.rate_hz = 100.0;
  EXPECT_EQ(HapticLoop::create(start, start, defaultScene(), hand, settings).error().kind,
            engine::ErrorKind::kInput);
  settings = {};
  settings.options.limits.ramp_s = 0.0;
  EXPECT_FALSE(HapticLoop::create(start, start, defaultScene(), hand, settings));
  settings = {};
  settings.options.event_capacity = 100;
  EXPECT_FALSE(HapticLoop::create(start, start, defaultScene(), hand, settings));
  settings = {};
  const engine::Version other = fettle::tests::fieldOf(5, 5, [](int, int) { return 0; });
  EXPECT_FALSE(HapticLoop::create(start, other, defaultScene(), hand, settings));
}

}  // namespace
}  // namespace fettle::haptic
