#pragma once

#include <memory>

#include "engine/filter/block.h"
#include "engine/filter/box_strip.h"
#include "engine/filter/pass.h"
#include "engine/filter/tile_window.h"

namespace fettle::engine {

/// Side of the blocks that a field is cut into [samples]: so many times two windows, a multiple of kTileSide.
/// Large enough that the halo does not dominate, small enough that the scratch stays near the core.
struct BlockSide {
  int double_windows = 1;
  int least = 256, most = 1024;
};

/// Squares, on a grid that begins at the field's first sample, each of which is worked out as a whole with the
/// samples around it. They are part of what such a filter makes, whatever the tuning.
struct FixedSquares {
  std::int32_t side = 0;  ///< [samples], a multiple of kTileSide; 0: there are none
  std::int32_t halo = 0;  ///< samples around a square that its results depend on
};

/// A filter each of whose results depends on the samples within Filter::reach alone.
struct WindowFilter {
  using Maker = std::unique_ptr<BlockFilter>(const FilterSpec& spec, CpuLevel level);

  Maker* make;
  BlockSide columns{}, rows{};
  /// A fast path with the same bits: of a radius, null where the processor has none.
  std::unique_ptr<BoxStrip> (*strip)(int radius, CpuLevel level) = nullptr;
  FixedSquares squares{};
  /// Another one, for tiles far from borders and holes: null where there is none.
  std::unique_ptr<TileWindow> (*tile)(const FilterSpec& spec, CpuLevel level) = nullptr;
};

/// A FilterPass that cuts the field into blocks.
[[nodiscard]] Result<PassResult> passInBlocks(const WindowFilter& filter, const Version& input,
                                              const Version& original, const FilterSpec& spec,
                                              const FilterTuning& tuning, JobControl& job);

template <const WindowFilter& kFilter>
Result<PassResult> windowPass(const Version& input, const Version& original, const FilterSpec& spec,
                              const FilterTuning& tuning, JobControl& job) {
  return passInBlocks(kFilter, input, original, spec, tuning, job);
}

}  // namespace fettle::engine
