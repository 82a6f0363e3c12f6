#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/field/edge_line.h"

namespace fettle::engine {

/// Which links between a sample and the next of its row and of its column the edge lines of a field cut: the two
/// samples belong to different surfaces. Only the line of a step cuts.
struct LineCut {
  enum : std::uint8_t { kRight = 1, kUp = 2 };

  std::int32_t row = 0, column = 0;  ///< of the sample
  std::uint8_t links = 0;            ///< which, to the next column and to the next row
  /// Where on these links, 0 .. 1 from the sample; of several lines the last one's.
  float right_at = 0.0F, up_at = 0.0F;
  float deviation = 0.0F;  ///< of the line across itself [samples]
};

/// A sample that a line passes, the nearest one of each passage of a row or a column.
struct LineSample {
  std::int32_t row = 0, column = 0;
  [[nodiscard]] friend bool operator==(const LineSample&, const LineSample&) noexcept = default;
};

/// The links that lines cross between located points, each by an odd number of passages of one line (EdgeLine::id):
/// a line that goes over a link and back leaves it whole. A line through a sample passes on the side of the smaller
/// coordinate. Creases cut nothing, but have
/// samples. Immutable; any thread. 24 bytes per sample with a cut link, 8 per sample that a line passes.
class LineCuts {
 public:
  /// Those of a field of so many samples; `lines` may lead out of it. Throws std::bad_alloc.
  LineCuts(std::span<const EdgeLine> lines, std::int32_t columns, std::int32_t rows);

  /// The cuts of a row, by column.
  [[nodiscard]] std::span<const LineCut> row(std::int32_t row) const noexcept;

  /// The samples of a tile that lines pass, with a number that two tiles of different samples hardly share; 0 without
  /// any. In time that grows with the logarithm of the tiles with lines.
  struct TileSamples {
    std::span<const LineSample> samples;  ///< by row, then column
    std::uint64_t print = 0;
  };
  [[nodiscard]] TileSamples samplesOf(std::int32_t tile_column, std::int32_t tile_row) const noexcept;

 private:
  std::vector<LineCut> cuts_;        // by row, then column
  std::vector<LineSample> samples_;  // by tile, row by row
  struct TilePart {
    std::int32_t row = 0, column = 0;  // of the tile
    std::uint32_t first = 0, count = 0;
    std::uint64_t print = 0;
  };
  std::vector<TilePart> tiles_;
};

}  // namespace fettle::engine
