#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/edges/polyline.h"
#include "engine/field/reader.h"

namespace fettle::engine {

/// The samples of a field within a distance of some lines, in square blocks, with what the search notes about
/// each. Memory follows the length of the lines. One thread at a time, except where stated.
class SampleWindow {
 public:
  /// A sample, by its place in the window.
  using Index = std::uint32_t;
  static constexpr float kNoFit = 1e9F;
  /// Distance of the samples that decide whether one is a spike, along columns and rows.
  static constexpr int kSpikeReach = 2;

  /// What is known about a sample.
  struct Sample {
    float height = 0.0F;  ///< NaN: a hole, or outside the field
    bool kept = false;    ///< false: a hole, or fits no surface
    /// Least distance from the surfaces at the lines next to it, in standard deviations of the noise; 0: not
    /// known at one of them; kNoFit: not next to any.
    float misfit = kNoFit;
    /// Scratch of the strip that is being built: nearest point of the line and its squared distance.
    std::int32_t nearest = 0;
    float nearest_distance = kNoFit;
  };

  /// Reads all blocks that lie within `margin` of a point of `lines`, along columns and rows. Positions are
  /// relative to the sample `origin` of the field, which may lie outside of it, and the blocks are aligned to
  /// it: the window is the same for every cut of a field. Samples with fewer than three of their 24 neighbours
  /// within 4 `noise` are spikes and not kept.
  SampleWindow(const FieldReader& field, glm::ivec2 origin, const std::vector<Polyline>& lines, double margin,
               double noise);

  [[nodiscard]] Sample& at(Index i) noexcept { return samples_[i]; }
  [[nodiscard]] const Sample& at(Index i) const noexcept { return samples_[i]; }

  /// Calls visit(Index, column, row) for each sample within `reach` columns and rows of the sample nearest to
  /// `centre`, row by row within each block, blocks in order of rows.
  template <class Visit>
  void forEachAround(glm::dvec2 centre, int reach, Visit&& visit) const;

  /// After a round: samples that no surface explains are not kept, others are again. Clears the misfits.
  void applyMisfits();

 private:
  static constexpr int kShift = 5;
  static constexpr int kSide = 1 << kShift;
  static constexpr std::size_t kBlock = static_cast<std::size_t>(kSide) * kSide;

  static std::uint64_t key(int across, int up) noexcept {
    return (std::uint64_t{static_cast<std::uint32_t>(up)} << 32) | static_cast<std::uint32_t>(across);
  }
  void readBlock(const FieldReader& field, glm::ivec2 origin, glm::ivec2 block, double noise, Sample* out);

  std::unordered_map<std::uint64_t, std::size_t> blocks_;  // number of each block
  std::vector<Sample> samples_;                            // of all blocks
};

template <class Visit>
void SampleWindow::forEachAround(glm::dvec2 centre, int reach, Visit&& visit) const {
  const glm::ivec2 middle{static_cast<int>(std::lround(centre.x)), static_cast<int>(std::lround(centre.y))};
  const glm::ivec2 low = middle - reach, high = middle + reach;
  for (int up = low.y >> kShift; up <= high.y >> kShift; ++up)
    for (int across = low.x >> kShift; across <= high.x >> kShift; ++across) {
      const auto block = blocks_.find(key(across, up));
      if (block == blocks_.end()) continue;
      const int left = across << kShift, bottom = up << kShift;
      for (int row = std::max(low.y, bottom); row <= std::min(high.y, bottom + kSide - 1); ++row) {
        const std::size_t first = block->second * kBlock + static_cast<std::size_t>(row - bottom) * kSide;
        for (int column = std::max(low.x, left); column <= std::min(high.x, left + kSide - 1); ++column)
          visit(static_cast<Index>(first + static_cast<std::size_t>(column - left)), column, row);
      }
    }
}

}  // namespace fettle::engine
