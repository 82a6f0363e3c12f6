#include "bench/commit_times.h"

#include <cstdint>
#include <string>
#include <utility>

#include "bench/temporary_folder.h"
#include "engine/base/stopwatch.h"
#include "engine/field/live_field.h"
#include "engine/field/tile_store.h"
#include "engine/history/history.h"
#include "engine/session/session_writer.h"
#include "haptic/base/rt_thread.h"
#include "haptic/journal/recorder.h"
#include "haptic/scene/scene.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::bench {

constexpr std::int64_t kTicksOfStroke = 1000;

engine::Result<CommitTimes> commitTimes(const engine::Version& field, int strokes, engine::JobControl& job) {
  const auto folder = TemporaryFolder::create(engine::storePolicy().folder);
  if (!folder) return tl::unexpected(folder.error());
  engine::Session session;
  session.original = field;
  session.history = engine::History(field);
  auto writer = engine::SessionWriter::create(session, (folder->path() / "strokes.fettle").string(), {}, job);
  if (!writer) return tl::unexpected(writer.error());

  haptic::Scene scene = haptic::defaultScene();
  scene.brush_radius_samples = 8.0;
  trials::HandMotion motion;
  motion.ticks = kTicksOfStroke * strokes;
  motion.tool = haptic::Tool::kSmooth;
  const std::vector<haptic::StrokeSample> ticks = trials::handStroke(field, motion);
  engine::LiveField live(field, engine::Growth::kAllowed);
  haptic::Tick tick(scene, live, field);
  haptic::Recorder recorder;
  engine::History& history = session.history;
  CommitTimes times;
  for (std::int64_t stroke = 0; stroke < strokes; ++stroke) {
    {
      const haptic::DenormalScope as_in_the_loop;
      for (std::int64_t i = stroke * kTicksOfStroke; i < (stroke + 1) * kTicksOfStroke; ++i) {
        (void)tick.run(ticks[static_cast<std::size_t>(i)]);
        recorder.tick(ticks[static_cast<std::size_t>(i)]);
      }
    }
    const engine::Stopwatch since_end;
    engine::StepInfo info;
    info.name = "smoothing";
    info.time = engine::stepTimeNow();
    if (!history.push(std::move(info), live.snapshot())) continue;  // no sample was changed
    const std::int64_t number = history.number();
    recorder.add(haptic::journal::StepMade{number,
                                           "smoothing",
                                           engine::StepKind::kStroke,
                                           {static_cast<std::uint64_t>((stroke + 1) * kTicksOfStroke), false},
                                           false});
    (*writer)->commit(number, history.step(number), recorder.take());
    const double waited = since_end.ms();
    if (engine::Status flushed = (*writer)->flush(job); !flushed) return tl::unexpected(flushed.error());
    times.durable_ms.push_back(since_end.ms());
    times.waits_ms.push_back(waited);
    const auto change = engine::measureChange(history.state(number - 1), history.current());
    times.tiles.push_back(static_cast<double>(change.tiles));
  }
  if (times.durable_ms.empty()) return engine::failure("no stroke changed the field", "bench growth");
  if (engine::Status closed = (*writer)->close(job); !closed) return tl::unexpected(closed.error());
  return times;
}

}  // namespace fettle::bench
