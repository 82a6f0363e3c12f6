#pragma once

#include <optional>

#include "app/work/background.h"
#include "app/work/live_change.h"
#include "engine/compare/compare.h"

namespace fettle::app {

/// Figures of the change since the scan: recent estimates during a stroke, and exact ones of the whole field
/// afterwards. Threading: main.
class ChangeFigures {
 public:
  /// Starts with another scan.
  void begin(const engine::Version& original);
  /// Takes results, starts on new states; `working`: a stroke is running. True when something visible
  /// changed.
  [[nodiscard]] bool poll(const LoopClient& client, bool working);
  void cancel() { measuring_.cancel(); }

  [[nodiscard]] const std::optional<engine::LiveFigures>& live() const noexcept { return live_.figures(); }
  /// Of this state, with sign +1; null: not measured yet.
  [[nodiscard]] const engine::Deviation* exact(const engine::Version& upright) const;

 private:
  engine::Version begun_;  // the original that changes are measured against
  LiveChange live_;
  Background<engine::Deviation> measuring_;
  engine::Version measured_;  // the state that measuring_ works on, or of exact_
  std::optional<engine::Deviation> exact_;
};

}  // namespace fettle::app
