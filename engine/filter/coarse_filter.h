#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/node_pool.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::engine {

/// What a filter makes of means of `step` x `step` samples: an approximation of its results that costs `step` squared times
/// less, for a picture that shows no more. How far it is off is measured, never assumed: filter_view.h.
///
/// Threading: any number of readers.
class CoarseFilter {
 public:
  /// Of the samples of `rect`, which lies in the field. A filter that needs the whole field knows no more than the rectangle;
  /// edge lines have no influence. Every cell is the mean of four of its rows at most. Errors as applyFilter.
  [[nodiscard]] static Result<CoarseFilter> make(const Version& input, const Version& original,
                                                 const FilterSpec& spec, const SampleRect& rect,
                                                 std::int32_t step, JobControl& job);

  [[nodiscard]] std::int32_t step() const noexcept { return step_; }
  /// The cells as a field of their own, `step` times as far apart.
  [[nodiscard]] const Version& cells() const noexcept { return means_; }

  /// The tile of `input` with the approximation between its cells (bilinear) where the filter may change it: holes and marks
  /// stay, no sample changes by more than the spec allows. The tile overlaps the rectangle. Empty: no memory.
  [[nodiscard]] TileRef tile(const Version& input, const Version& original, const FilterSpec& spec,
                             std::int32_t tc, std::int32_t tr) const;

  /// At a sample of the field [height_unit], with the sign of the input; NaN where all cells around it are holes.
  [[nodiscard]] float heightAt(std::int32_t column, std::int32_t row) const noexcept;

 private:
  CoarseFilter() = default;
  [[nodiscard]] const float* rowOfCells(std::int32_t row) const noexcept {
    return heights_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
  }

  Version means_;
  SampleRect rect_;
  std::int32_t step_ = 1;
  std::int32_t columns_ = 0, rows_ = 0;  // cells
  std::vector<float> heights_;           // row-major
};

/// The spec for means of `step` x `step` samples, each of `counted` of them, whose larger spacing is `spacing_mm`: sizes in
/// samples shrink, and so does what counts as noise. Nothing: the filter works within a cell, so that the means are all
/// there is to see of it.
[[nodiscard]] std::optional<FilterSpec> coarseSpec(const FilterSpec& spec, std::int32_t step,
                                                   std::int32_t counted, double spacing_mm) noexcept;

}  // namespace fettle::engine
