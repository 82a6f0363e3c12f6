// Medians of small windows inside the field, straight from the tiles.

#include "engine/filter/sorting_network.h"
#include "engine/filter/tile_window.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

#ifdef FETTLE_CPU_LEVELS

namespace {

#define FETTLE_KERNEL "engine/filter/tile_median-inl.h"
#include "engine/simd/each_cpu-inl.h"

template <void (*kRun)(const TileAround&, float*) noexcept>
class TileMedian final : public TileWindow {
 public:
  bool run(const TileAround& around, float* out) const noexcept override {
    kRun(around, out);
    return true;
  }
};

}  // namespace

std::unique_ptr<TileWindow> makeTileMedian(const FilterSpec& spec, CpuLevel level) {
  if (spec.window == 3 && level == CpuLevel::kAvx512)
    return std::make_unique<TileMedian<avx512::medianTile3>>();
  if (spec.window == 3 && level == CpuLevel::kAvx2) return std::make_unique<TileMedian<avx2::medianTile3>>();
  return makeTileStrips(spec.window, level);
}

#else

std::unique_ptr<TileWindow> makeTileMedian(const FilterSpec& spec, CpuLevel level) {
  return makeTileStrips(spec.window, level);
}

#endif

}  // namespace fettle::engine
