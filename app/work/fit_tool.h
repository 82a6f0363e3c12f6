#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/work/beside_the_field.h"
#include "app/work/field_fits.h"

namespace fettle::app {

/// Shapes fitted to the field that is worked on, as `fettle fit` does: to all samples that count, or between its edge lines. The field stays
/// as it is, so that this is no step; it is worked out in the background while the hand goes on. Threading: main.
class FitTool {
 public:
  /// Edited by the panel.
  struct Options {
    std::optional<engine::ShapeKind> shape;  ///< none: the simplest that the samples do not contradict
    std::optional<engine::Region>
        region;                 ///< samples that count; none: marked ones where there are any, else all
    bool between_lines = true;  ///< where there are edge lines: each region between them by itself
    bool robust = false;
    bool vertical = false;  ///< distances along z
  };
  Options options;
  bool shown = true;  ///< colours are the distances from the shapes

  /// Fits `options` to the newest field.
  void fit(const LoopClient& client);
  void cancel() noexcept { work_.cancel(); }
  /// Takes over results. True when something visible changed.
  [[nodiscard]] bool poll(const LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] bool busy() const noexcept { return work_.busy(); }
  [[nodiscard]] WorkProgress progress() const { return work_.progress(); }
  /// The last fits; null before, and of another document.
  [[nodiscard]] const FieldFits* fits() const noexcept { return work_.get() ? &work_.get()->fits : nullptr; }
  /// The field that they are of.
  [[nodiscard]] const engine::Version& field() const noexcept { return work_.get()->field; }
  /// The samples that counted for them.
  [[nodiscard]] engine::Region region() const noexcept { return work_.get()->region; }
  /// Whether samples with a height were not fitted to.
  [[nodiscard]] bool leavesOut() const noexcept { return work_.get()->leaves_out; }
  /// Whether the field has changed since.
  [[nodiscard]] bool outdated() const noexcept { return work_.outdated(); }
  /// What the colours show the difference from: heights less their distances from the shapes, holes where nothing was fitted. Null
  /// without fits, and where a form lies over the field that did not then.
  [[nodiscard]] const engine::Version* surface(const engine::Version& field) const noexcept {
    const Work* const work = work_.under(field);
    return work != nullptr ? &work->surface : nullptr;
  }

  /// The two fits, by their places in the list, between which angle and distance are stated; none: there are not two.
  [[nodiscard]] const std::optional<std::pair<std::size_t, std::size_t>>& pair() const noexcept {
    return pair_;
  }
  /// Both within the list, and different.
  void setPair(std::size_t first, std::size_t second);
  /// Forgets the fits.
  void clear();

 private:
  struct Work {
    engine::Version field;
    FieldFits fits;
    engine::Version surface;
    engine::Region region = engine::Region::kAll;
    bool leaves_out = false;
  };
  BesideTheField<Work> work_;
  std::optional<std::pair<std::size_t, std::size_t>> pair_;
};

/// Writes fits of a field as `fettle fit` does, by the ending of `path`: .csv, .step, .stp, or .json, its report; the whole file or none.
/// Errors: another ending (kInput); those of writing.
[[nodiscard]] engine::Status writeFits(const FieldFits& fits, const engine::Version& field,
                                       const std::string& path);

}  // namespace fettle::app
