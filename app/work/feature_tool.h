#pragma once

#include <string>
#include <vector>

#include "app/work/beside_the_field.h"
#include "app/work/field_features.h"

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
  void cancel() noexcept { work_.cancel(); }
  /// Takes over results. True when something visible changed.
  [[nodiscard]] bool poll(const LoopClient& client, std::vector<Notice>& notices) {
    return work_.poll(client, notices).changed;
  }

  [[nodiscard]] bool busy() const noexcept { return work_.busy(); }
  [[nodiscard]] WorkProgress progress() const { return work_.progress(); }
  /// The report of the features found last; null before, and of another document.
  [[nodiscard]] const Report* found() const noexcept { return work_.get() ? &work_.get()->report : nullptr; }
  /// Whether the field has changed since.
  [[nodiscard]] bool outdated() const noexcept { return work_.outdated(); }
  /// What the colours show the difference from: the saddle of each sample's feature, holes where it does not stand out. Null without features,
  /// and where a form lies over the field that did not then.
  [[nodiscard]] const engine::Version* saddles(const engine::Version& field) const noexcept {
    const Work* const work = work_.under(field);
    return work != nullptr ? &work->saddles : nullptr;
  }
  /// Forgets them.
  void clear() { work_.clear(); }

 private:
  struct Work {
    engine::Version field;
    Report report;
    engine::Version saddles;
  };
  BesideTheField<Work> work_;
};

/// Writes the table of `fettle features --csv`, the whole file or none. Errors: those of writing.
[[nodiscard]] engine::Status writeFeatures(const Report& report, const std::string& path);

}  // namespace fettle::app
