#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/filter/block.h"
#include "engine/filter/lone_samples.h"

namespace fettle::engine {

/// On which side of the edge lines the samples of a block lie: which links between samples next to each other the
/// lines of steps cut. A located line is some tenths of a sample off, and at a tall wall one sample on the wrong
/// side costs the wall's height. So heights decide where they can, and lines where they cannot: at low steps, and for
/// samples that belong to no surface.
///
/// One object serves one thread; it keeps its buffer.
class LineSides {
 public:
  /// Takes the cuts of a block; false where there are none, and then nothing else may be called.
  [[nodiscard]] bool take(const Block& block);

  /// Changes sides by `heights`, in noises, NaN for none; `lone` is what findLoneSamples() found in them.
  ///
  /// A sample fits a side where it is within 6 of one of the side's samples within 2 of it, or two of these lead to
  /// it. Samples next to a line that only fit the other side are put there, in three rounds. But where the scan has
  /// lone samples, it also has some with the height of the wrong side: one whose neighbours all fit, and that is
  /// farther from the line than that may be off or stands out of a smooth line, is added to `lone` and stays.
  /// A lone sample is where the line puts it and gets the median height of that side; where the line is nearer than it
  /// may be off, the sample is joined to both sides.
  void settle(const float* heights, std::ptrdiff_t stride, std::vector<LoneSample>& lone);

  /// visit(column, row, links) for each sample with a cut link, row by row.
  void forEachCut(auto&& visit) const {
    for (std::int32_t r = 0; r < rows_; ++r)
      for (std::int32_t c = 0; c < columns_; ++c)
        if (const std::uint8_t links = at(c, r); links != 0) visit(c, r, links);
  }

 private:
  struct Around;
  // How near the line runs to a sample, before any change of sides, and its standard deviation. [samples]
  struct Passage {
    float distance = 0.0F, deviation = 0.0F;
  };

  [[nodiscard]] std::uint32_t placeOf(std::int32_t c, std::int32_t r) const noexcept {
    return static_cast<std::uint32_t>(r * columns_ + c);
  }
  [[nodiscard]] std::int32_t columnOf(std::uint32_t place) const noexcept {
    return static_cast<std::int32_t>(place) % columns_;
  }
  [[nodiscard]] std::int32_t rowOf(std::uint32_t place) const noexcept {
    return static_cast<std::int32_t>(place) / columns_;
  }
  [[nodiscard]] std::uint8_t at(std::int32_t c, std::int32_t r) const noexcept { return cut_[placeOf(c, r)]; }
  [[nodiscard]] bool has(std::int32_t c, std::int32_t r) const noexcept {
    return c >= 0 && r >= 0 && c < columns_ && r < rows_;
  }
  [[nodiscard]] bool joined(std::int32_t c, std::int32_t r, std::int32_t dx, std::int32_t dy) const noexcept;
  [[nodiscard]] bool isAtCut(std::int32_t c, std::int32_t r) const noexcept;
  [[nodiscard]] Around sidesAround(std::int32_t c, std::int32_t r) const noexcept;
  [[nodiscard]] int inside(std::int32_t c, std::int32_t r) const noexcept;
  [[nodiscard]] Passage passageAt(std::int32_t c, std::int32_t r) const noexcept;
  [[nodiscard]] std::vector<std::uint32_t> misfits(const float* heights, std::ptrdiff_t stride) const;
  [[nodiscard]] bool isAlone(std::uint32_t place, const std::vector<std::uint32_t>& among) const noexcept;
  [[nodiscard]] bool hasWrongHeight(std::int32_t c, std::int32_t r) const noexcept;
  [[nodiscard]] float sideHeight(const float* heights, std::ptrdiff_t stride, std::int32_t column,
                                 std::int32_t row) const;
  void flip(std::uint32_t place) noexcept;
  void join(std::int32_t c, std::int32_t r) noexcept;

  const LineCuts* cuts_ = nullptr;
  std::int32_t left_ = 0, low_ = 0;  // of the block in the field
  std::int32_t columns_ = 0, rows_ = 0;
  std::vector<std::uint8_t> cut_;  // LineCut's bits of each sample
};

}  // namespace fettle::engine
