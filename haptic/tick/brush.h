#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/field/line_cuts.h"
#include "engine/field/live_field.h"
#include "engine/field/version.h"
#include "haptic/contact/disc.h"
#include "haptic/scene/falloff.h"

namespace fettle::haptic {

/// The seed paper's local smoothing: each sample within the brush becomes
///   (1 - s) * Gaussian + s * box,   s = strength, 0 .. 1 (light press = Gaussian, hard press = box)
/// over its 3 x 3 window, weights 1 2 1 / 2 4 2 / 1 2 1 and all 1, in double, rounded to float once. All
/// samples read the heights from before the tick, so their order does not matter.
///
/// Holes and samples outside the field have no weight, the rest is renormalised. A hole stays a hole. A
/// marked sample keeps its bits but counts as a neighbour. With `max_change` the result is clamped to within
/// that of the original's sample, exactly, without rounding error; where the original has a hole there is no
/// reference, and the sample is kept.
///
/// The window never reaches over an edge line of the field (engine::LineCuts): a sample counts as a neighbour where a
/// way of one link, or of one along the row and one along the column, leads to it over no cut link. No other edge stops
/// the window: a sample next to a step that is not marked itself is blended with both sides.
///
/// With a falloff a sample takes its share of that change (Scene::brush_falloff); without one there is no such step.
///
/// A sample whose original is a denormal is kept, too, with `max_change`: the haptic thread flushes
/// denormals, so that they count as zero there. They keep their bits where they are not smoothed.
///
/// Source: Potter, Johnson, Cohen, DETC2004-57539, "Haptically Driven Filtering" and figure 5.
/// Threading: made anywhere (allocates); apply() on the field's thread: wait-free, noexcept, allocates
/// nothing.
class Brush {
 public:
  /// `radius` [samples]; `original` with the same sign as the live field, same size, used only with
  /// max_change [height unit].
  Brush(double radius, std::optional<double> max_change, const engine::Version& original,
        Falloff falloff = Falloff::kFlat);

  /// Smooths around sample (column, row) of the field. False when the pool is empty: nothing changed.
  [[nodiscard]] bool apply(engine::LiveField& field, std::int32_t column, std::int32_t row,
                           double strength) noexcept;

  /// Memory apart from the object itself; the tiles of `original`, shared with others, do not count.
  [[nodiscard]] std::size_t bytesHeld() const noexcept {
    return (before_.capacity() + after_.capacity()) * sizeof(float) + marked_.capacity() + cut_.capacity() +
           disc_.half_width.capacity() * sizeof(std::int32_t) + weights_.capacity() * sizeof(double);
  }

 private:
  /// Fills after_ around sample (column, row); kFades: by weights_.
  template <bool kFades>
  void smoothRows(const engine::LineCuts* cuts, std::int32_t column, std::int32_t row,
                  double strength) noexcept;
  [[nodiscard]] bool applyToOne(engine::LiveField& field, std::int32_t column, std::int32_t row,
                                double strength) noexcept;
  /// Fills cut_ for `side` x `side` samples from (column, row) on; false when no link of theirs is cut.
  [[nodiscard]] bool findCuts(const engine::LineCuts* cuts, std::int32_t column, std::int32_t row,
                              std::int32_t side) noexcept;
  [[nodiscard]] float limited(double height, float old, std::int32_t column, std::int32_t row) const noexcept;

  Disc disc_;
  std::optional<double> max_change_;
  engine::Version original_;          // empty without max_change
  std::vector<float> before_;         // (2 reach + 3)^2, row-major
  std::vector<float> after_;          // (2 reach + 1)^2
  std::vector<std::uint8_t> marked_;  // (2 reach + 1)^2
  std::vector<double> weights_;       // as after_: shares of the change; empty: all of it
  std::vector<std::uint8_t> cut_;     // as before_: LineCut's links; only valid where a field has lines
};

}  // namespace fettle::haptic
