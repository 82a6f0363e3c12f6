#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/filter/filter.h"
#include "engine/filter/patch.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// A flat element on a grid: the samples within a disk or rectangle around each sample.
struct FlatElement {
  /// `radius_mm` of the disk, or half of the square's side.
  FlatElement(Element element, double radius_mm, const Grid& grid);

  std::int32_t columns = 0, rows = 0;  ///< to each side [samples]
  /// Of a disk: how far it reaches along a row, by the distance of that row, 0 .. rows [samples]. Empty: a rectangle.
  std::vector<std::int32_t> half;
};

/// What the erosions of one thread take beside their patches.
struct ErosionScratch {
  std::vector<float> line, part;
};

/// The least of `from` within the element around each sample of to.rect; +infinity where there is no sample. from.rect holds
/// all samples of the field that the element reaches. `parallel`: on all workers of the arena. False when cancelled: then
/// `to` means nothing. Exact: the same for any rectangle and level. Throws std::bad_alloc.
[[nodiscard]] bool erode(const FlatElement& element, const Patch<float>& from, Patch<float>& to,
                         bool parallel, CpuLevel level, ErosionScratch& scratch, const JobControl& job);

}  // namespace fettle::engine
