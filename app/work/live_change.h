#pragma once

#include <memory>
#include <optional>

#include "app/work/background.h"
#include "app/work/touch.h"
#include "engine/compare/live_deviation.h"

namespace fettle::app {

/// Figures of the change since the scan, while a stroke goes on: worked out in the background again and
/// again, each time for the newest version there is. Threading: main.
class LiveChange {
 public:
  /// Another field: looks at all of `original` first.
  void begin(const engine::Version& original);
  /// Takes in what was worked out, starts on what is new. True when figures changed.
  [[nodiscard]] bool poll(const Touch& touch);

  /// Of some version at most a frame or two ago; none until the first is there.
  [[nodiscard]] const std::optional<engine::LiveFigures>& figures() const noexcept { return figures_; }
  /// How long the last figures took [ms].
  [[nodiscard]] double tookMs() const noexcept { return took_ms_; }

 private:
  struct Work {
    std::shared_ptr<engine::LiveDeviation> deviation;
    std::optional<engine::LiveFigures> figures;
    double ms = 0.0;
  };
  std::shared_ptr<engine::LiveDeviation> deviation_;  // not while working_
  engine::Version looked_at_;                         // upright
  std::optional<engine::LiveFigures> figures_;
  double took_ms_ = 0.0;
  Background<Work> working_;
};

}  // namespace fettle::app
