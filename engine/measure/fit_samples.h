#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/field/version.h"
#include "engine/measure/fit_regions.h"

namespace fettle::engine {

/// The points of a region for fits, in millimetres from a point in its middle, in blocks whose size does not depend on the
/// number of threads. 4 bytes per sample, 16 per run. Immutable; any thread.
class FitSamples {
 public:
  static constexpr int kBlock = 256;
  struct Block {
    std::array<glm::dvec3, kBlock> points;
    int count = 0;
    std::int32_t row = 0,
                 column =
                     0;  ///< of the first, in every stride()-th row and column; the others follow in its row
  };

  FitSamples() = default;
  /// Every `stride`-th sample of every `stride`-th row of a region. Throws std::bad_alloc.
  FitSamples(const Version& field, const FitRegion& region, std::int32_t stride = 1);
  /// Points as they are, from a middle of their own.
  FitSamples(std::vector<glm::dvec3> points, const glm::dvec3& middle);

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t blocks() const noexcept { return blocks_.size(); }
  /// The points of a block: sample first() of all is its first.
  void read(std::size_t block, Block& out) const noexcept;
  [[nodiscard]] std::size_t first(std::size_t block) const noexcept { return blocks_[block].first; }
  /// Field coordinates of the middle [mm]: means of columns and rows, the median height.
  [[nodiscard]] const glm::dvec3& middle() const noexcept { return middle_; }
  /// Half the diagonal of the region's rectangle [mm].
  [[nodiscard]] double reach() const noexcept { return reach_; }
  /// Corners of the region's rectangle, from the middle [mm].
  [[nodiscard]] const glm::dvec2& low() const noexcept { return low_; }
  [[nodiscard]] const glm::dvec2& high() const noexcept { return high_; }
  /// The rows and columns of Block that there are, from the first; none of points as they are.
  struct Lattice {
    std::int32_t row = 0, column = 0, rows = 0, columns = 0;
  };
  [[nodiscard]] const Lattice& lattice() const noexcept { return lattice_; }
  /// From the middle [mm]: the first point of a block, and a column by its number in lattice().
  [[nodiscard]] glm::dvec2 along(std::size_t block) const noexcept;
  [[nodiscard]] double xOf(std::int32_t column) const noexcept;
  /// Samples of the field from one to the next.
  [[nodiscard]] std::int32_t stride() const noexcept { return stride_; }
  /// What rounding to float makes of a height, as a standard deviation [mm].
  [[nodiscard]] double rounding() const noexcept { return rounding_; }

  /// Points of at most `most` blocks of the region, each the mean place and the median height: few enough to try what
  /// shape they have, and unmoved by spikes. By row, then column of blocks; `columns` of them in a row of the grid.
  struct Coarse {
    std::vector<glm::dvec3> points;
    std::vector<std::int32_t> column, row;  ///< of the block
    std::int32_t columns = 1, rows = 1;
  };
  [[nodiscard]] Coarse coarse(std::size_t most) const;

 private:
  struct Place {
    std::size_t first = 0;
    std::int32_t row = 0, column = 0, count = 0;
  };
  std::vector<Place> blocks_;
  std::vector<float> heights_;
  std::vector<glm::dvec3> points_;
  std::size_t size_ = 0;
  glm::dvec3 middle_{0.0};
  glm::dvec2 low_{0.0}, high_{0.0};
  double spacing_x_ = 1.0, spacing_y_ = 1.0, unit_ = 1.0, reach_ = 0.0, rounding_ = 0.0;
  std::int32_t stride_ = 1;
  Lattice lattice_;
};

}  // namespace fettle::engine
