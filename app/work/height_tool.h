#pragma once

#include <optional>
#include <string>
#include <variant>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "haptic/journal/computed_heights.h"

namespace fettle::app {

/// Fills holes of the field that is worked on and levels the lines of a line scanner, as `fettle fill` and `fettle level --rows` do: each a step,
/// worked out in the background while the hand goes on. A stroke meanwhile is kept: it is worked out again with it. Threading: main.
class HeightTool {
 public:
  /// Edited by the panel.
  engine::FillOptions fill;
  engine::LineOptions lines;

  void fillHoles() { ask(fill); }
  void levelLines() { ask(lines); }
  void cancel() noexcept;
  /// Takes over results as steps. True when something visible changed.
  [[nodiscard]] bool poll(LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] bool busy() const noexcept { return working_.busy() || asked_ || done_; }
  [[nodiscard]] WorkProgress progress() const { return working_.progress(); }
  [[nodiscard]] const char* stage() const noexcept { return working_.stage(); }
  /// What the last one found, in a sentence; empty before.
  [[nodiscard]] const std::string& found() const noexcept { return found_; }
  /// Whether the last one filled holes instead of levelling lines.
  [[nodiscard]] bool filledLast() const noexcept {
    return std::holds_alternative<engine::FillOptions>(maker_);
  }
  /// Forgets all of a document that is closed.
  void clear();

 private:
  struct Work {
    engine::Version base;
    haptic::ComputedHeights heights;
  };
  void ask(const haptic::HeightsMaker& maker);

  std::optional<haptic::HeightsMaker> asked_;  // to be worked out
  haptic::HeightsMaker maker_;                 // that is worked out
  std::optional<Work> done_;                   // waits for the end of a stroke
  std::string found_;
  Background<Work> working_;
};

/// "Fill holes: curvature", "Level rows: median": the step in the list of steps.
[[nodiscard]] std::string makerName(const haptic::HeightsMaker& maker);

}  // namespace fettle::app
