#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "engine/field/version.h"
#include "engine/suggest/filter_suggestion.h"

namespace fettle::app {

/// A filter suggested for the newest field, with its marks, as `fettle filter --suggest` finds it: tried in the background,
/// then listed. Threading: main.
class FilterSuggester {
 public:
  /// Of the noise: the error that may be left unless one is given.
  static constexpr double kShareOfNoise = 0.5;

  double tolerance = 0.0;  ///< error that may be left [height_unit], 0: kShareOfNoise of the noise
  double budget_s = 0.0;   ///< that the filter may take for the whole scan [s], 0: any

  struct Found {
    engine::SuggestionRequest asked;  ///< with the tolerance that was used
    engine::FilterSuggestion suggestion;
  };

  /// Tries filters. What was found before stays until there is another result.
  void search(const LoopClient& client);
  /// Ends the trying, if it runs: at the latest after the filter at work, two seconds.
  void cancel() { trying_.cancel(); }
  /// Forgets all of a document that is closed.
  void clear();
  /// Takes a result, and looks whether it is still of the newest field. True when something visible changed.
  [[nodiscard]] bool poll(const LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] bool busy() const noexcept { return trying_.busy() && !trying_.cancelling(); }
  [[nodiscard]] WorkProgress progress() const { return trying_.progress(); }
  /// Null when nothing was found.
  [[nodiscard]] const Found* found() const noexcept { return found_ ? &*found_ : nullptr; }
  /// Why no filter could be suggested at all; empty: that is not so.
  [[nodiscard]] const std::string& nothing() const noexcept { return nothing_; }
  /// Whether heights, marks or form have changed since what is found was tried. Undoing that makes it valid again.
  [[nodiscard]] bool outdated() const noexcept { return outdated_; }

 private:
  Background<Found> trying_;
  std::optional<Found> found_;
  std::string nothing_;
  engine::Version on_trial_;          // of trying_
  engine::Version tried_, compared_;  // of found_ or nothing_; compared_: with tried_, for outdated_
  bool outdated_ = false;
};

}  // namespace fettle::app
