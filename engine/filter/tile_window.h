#pragma once

#include <array>
#include <memory>

#include "engine/field/tile.h"
#include "engine/filter/filter.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// Samples of a tile and of the eight around it: [row][column] of the three by three tiles, in the order of the field's
/// rows and columns. All lie in the field, and no sample that a window reaches is a hole.
using TileAround = std::array<std::array<const float*, 3>, 3>;

/// A small window over one tile, whose samples are read where they lie: the fast path of a BlockFilter, with the same bits,
/// for a tile that neither a border nor a hole is near. Nothing is gathered, and what is between two steps stays in
/// registers.
///
/// Samples are taken as they are stored, without the version's sign: means and medians of negated samples are the negated
/// ones.
///
/// Threading: any number of threads.
class TileWindow {
 public:
  TileWindow& operator=(TileWindow&&) = delete;
  virtual ~TileWindow() = default;

  /// kTileSide x kTileSide results, row-major, at a multiple of 64 bytes. False where these samples are not for it: `out` is
  /// unspecified then.
  [[nodiscard]] virtual bool run(const TileAround& around, float* out) const noexcept = 0;
};

/// Of means, medians and Gaussians; null where the window is too large or the processor has no such path. makeTileStrips: medians by
/// the strips of median_small.cpp.
[[nodiscard]] std::unique_ptr<TileWindow> makeTileBox(const FilterSpec& spec, CpuLevel level);
[[nodiscard]] std::unique_ptr<TileWindow> makeTileMedian(const FilterSpec& spec, CpuLevel level);
[[nodiscard]] std::unique_ptr<TileWindow> makeTileStrips(int window, CpuLevel level);
[[nodiscard]] std::unique_ptr<TileWindow> makeTileGaussian(const FilterSpec& spec, CpuLevel level);

}  // namespace fettle::engine
