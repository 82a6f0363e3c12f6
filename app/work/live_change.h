#pragma once

#include <memory>
#include <optional>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "engine/compare/live_deviation.h"

namespace fettle::app {

/// Figures of the change since the scan, during a stroke: computed repeatedly in the background, each time
/// for the newest version. Threading: main.
class LiveChange {
 public:
  /// Another field: first reads all of `original`.
  void begin(const engine::Version& original);
  /// Takes over computed figures, starts on a new version. True when figures changed.
  [[nodiscard]] bool poll(const LoopClient& client);

  /// Of a version at most one or two frames old; empty until the first is available.
  [[nodiscard]] const std::optional<engine::LiveFigures>& figures() const noexcept { return figures_; }
  /// Time for computing the last figures [ms].
  [[nodiscard]] double tookMs() const noexcept { return took_ms_; }

 private:
  struct Work {
    std::shared_ptr<engine::LiveDeviation> deviation;
    std::optional<engine::LiveFigures> figures;
    double ms = 0.0;
  };
  std::shared_ptr<engine::LiveDeviation> deviation_;  // not while working_
  engine::Version measured_;                          // upright
  std::optional<engine::LiveFigures> figures_;
  double took_ms_ = 0.0;
  Background<Work> working_;
};

}  // namespace fettle::app
