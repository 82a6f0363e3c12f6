#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/work/background.h"
#include "app/work/field_features.h"
#include "app/work/loop_client.h"

namespace fettle::app {

/// Hills or dales of the field that is worked on, as `fettle features` finds them. The field stays as it is, so that this is no step; it is
/// worked out in the background while the hand goes on. Threading: main.
class FeatureTool {
 public:
  /// Edited by the panel.
  struct Options {
    FeatureOptions what;
    int degree = 1;  ///< of the form that is taken out
  };
  Options options;
  bool shown = true;  ///< colours are the heights above saddles

  /// Finds `options` in the newest field.
  void find(const LoopClient& client);
  void cancel() noexcept { working_.cancel(); }
  /// Takes over results. True when something visible changed.
  [[nodiscard]] bool poll(const LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] bool busy() const noexcept { return working_.busy(); }
  [[nodiscard]] WorkProgress progress() const { return working_.progress(); }
  /// The report of the features found last; null before, and of another document.
  [[nodiscard]] const Report* found() const noexcept { return work_ ? &work_->report : nullptr; }
  /// Whether the field has changed since.
  [[nodiscard]] bool outdated() const noexcept { return outdated_; }
  /// What the colours show the difference from: the saddle of each sample's feature, holes where it does not stand out. Null without features,
  /// and where a form lies over the field that did not then.
  [[nodiscard]] const engine::Version* saddles(const engine::Version& field) const noexcept;
  /// Forgets them.
  void clear();

 private:
  struct Work {
    engine::Version field;
    Report report;
    engine::Version saddles;
  };
  std::optional<Work> work_;
  bool outdated_ = false;
  Background<Work> working_;
};

/// Writes the table of `fettle features --csv`, the whole file or none. Errors: those of writing.
[[nodiscard]] engine::Status writeFeatures(const Report& report, const std::string& path);

}  // namespace fettle::app
