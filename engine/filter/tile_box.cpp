// Means of small windows inside the field, straight from the tiles: the bits of box.cpp. Sums that run on from row to row, which save
// work with larger windows, would cost more here.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "engine/filter/exact_sum.h"
#include "engine/filter/tile_window.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

#ifdef FETTLE_CPU_LEVELS

namespace {

// Bits of floats.
struct Magnitudes {
  std::uint32_t least, largest;
};

// In how many lanes sums over a window are exact, 1 or 2, and how samples are cut into two; 0: in no two.
struct BoxCuts {
  int lanes;
  double first;
};

BoxCuts cutsOf(const Magnitudes& of, int window) noexcept {
  const SumLanes cuts = cutsFor(std::bit_cast<float>(of.largest), window * window);
  // The last binary place of the smallest sample, which the last bit of a lane must not be above.
  constexpr int kFraction = 23, kBias = 127, kLeastPlace = -149;
  const int place = std::max(static_cast<int>(of.least >> kFraction) - kBias - kFraction, kLeastPlace);
  const auto holds = [&](int lane) { return std::ilogb(cuts.cut[lane]) - 52 <= place; };
  return {of.largest == 0 || holds(0) ? 1 : holds(1) ? 2 : 0, cuts.cut[0]};
}

#define FETTLE_KERNEL "engine/filter/tile_box-inl.h"
#include "engine/simd/each_cpu-inl.h"

template <bool (*kRun)(const TileAround&, float*) noexcept>
class TileBox final : public TileWindow {
 public:
  bool run(const TileAround& around, float* out) const noexcept override { return kRun(around, out); }
};

}  // namespace

std::unique_ptr<TileWindow> makeTileBox(const FilterSpec& spec, CpuLevel level) {
  if (level != CpuLevel::kAvx2) return nullptr;
  if (spec.window == 3) return std::make_unique<TileBox<avx2::boxTileOf<1>>>();
  if (spec.window == 5) return std::make_unique<TileBox<avx2::boxTileOf<2>>>();
  return nullptr;
}

#else

std::unique_ptr<TileWindow> makeTileBox(const FilterSpec&, CpuLevel) {
  return nullptr;
}

#endif

}  // namespace fettle::engine
