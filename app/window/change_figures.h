#pragma once

#include <optional>

#include "app/work/background.h"
#include "app/work/live_change.h"
#include "engine/compare/compare.h"

namespace fettle::app {

/// Figures of the change since the scan: those of a moment ago while a hand works, and exact ones of the whole
/// field when it rests. Threading: main.
class ChangeFigures {
 public:
  /// Another scan.
  void begin(const engine::Version& original);
  /// Takes in what was worked out, starts on what is new; `working`: a stroke runs. True when something to be
  /// seen changed.
  [[nodiscard]] bool poll(const LoopClient& touch, bool working);
  void cancel() { measuring_.cancel(); }

  [[nodiscard]] const std::optional<engine::LiveFigures>& live() const noexcept { return live_.figures(); }
  /// Of this state, the right way up; null: not measured yet.
  [[nodiscard]] const engine::Deviation* exact(const engine::Version& upright) const;

 private:
  LiveChange live_;
  Background<engine::Deviation> measuring_;
  engine::Version measured_;  // what measuring_ works on, or exact_ is of
  std::optional<engine::Deviation> exact_;
};

}  // namespace fettle::app
