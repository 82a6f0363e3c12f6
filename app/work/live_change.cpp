#include "app/work/live_change.h"

#include "engine/base/stopwatch.h"

namespace fettle::app {

void LiveChange::begin(const engine::Version& original) {
  deviation_.reset();
  figures_.reset();
  measured_ = {};
  working_.replace([original](engine::JobControl& job) -> engine::Result<Work> {
    auto deviation = engine::LiveDeviation::create(original, job);
    if (!deviation) return tl::unexpected(deviation.error());
    return Work{std::make_shared<engine::LiveDeviation>(std::move(*deviation)), std::nullopt, 0.0};
  });
}

bool LiveChange::poll(const LoopClient& client) {
  bool changed = false;
  if (auto done = working_.take(); done && *done) {
    deviation_ = std::move((*done)->deviation);
    if ((*done)->figures) {
      figures_ = (*done)->figures;
      took_ms_ = (*done)->ms;
      changed = true;
    }
  }
  if (working_.busy() || !deviation_) return changed;
  engine::Version now = client.upright();
  if (now == measured_) return changed;
  measured_ = now;
  working_.replace([deviation = std::move(deviation_), now](engine::JobControl& job) -> engine::Result<Work> {
    const engine::Stopwatch watch;
    auto figures = deviation->update(now, job);
    // Without memory the figures do not change; the next computation may succeed.
    const double ms = watch.ms();
    return Work{deviation, figures ? std::optional(*figures) : std::nullopt, ms};
  });
  return changed;
}

}  // namespace fettle::app
