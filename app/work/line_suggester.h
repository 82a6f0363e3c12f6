#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "engine/field/version.h"
#include "engine/measure/line_suggestion.h"

namespace fettle::app {

/// The way of levelling that leaves the lines of the newest field closest together, measured in the background
/// (engine::suggestLevelling). Threading: main.
class LineSuggester {
 public:
  /// Measures it for the direction, region and form of `lines`. What was found before stays until there is another result.
  void search(const LoopClient& client, const engine::LineOptions& lines);
  void cancel() { working_.cancel(); }
  /// Forgets all of a document that is closed.
  void clear();
  /// Takes over a result. True when something visible changed.
  [[nodiscard]] bool poll(const LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] bool busy() const noexcept { return working_.busy() && !working_.cancelling(); }
  [[nodiscard]] WorkProgress progress() const { return working_.progress(); }
  /// What was found, in sentences; empty before.
  [[nodiscard]] const std::string& says() const noexcept { return says_; }
  /// The way that is suggested, with direction, region and form as they were; nothing before, and where lines are best left.
  [[nodiscard]] const std::optional<engine::LineOptions>& suggested() const noexcept { return suggested_; }
  /// Whether the field has changed since.
  [[nodiscard]] bool outdated() const noexcept { return outdated_; }

 private:
  engine::Version on_trial_, tried_;  // of working_, of says_
  engine::LineOptions asked_;
  std::optional<engine::LineOptions> suggested_;
  std::string says_;
  bool outdated_ = false;
  Background<engine::LineSuggestion> working_;
};

/// "median", "straight line", "matching": a way of levelling as panels call it.
[[nodiscard]] const char* lineWayName(engine::LineMethod method, int degree) noexcept;

}  // namespace fettle::app
