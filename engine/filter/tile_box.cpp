// Means of small windows inside the field, straight from the tiles: the bits of box.cpp. Column sums, which a larger window's results
// share, would cost more here than they save.

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

// In how many lanes the sums of such a window are exact.
template <int kRadius>
struct BoxCuts {
  static constexpr int kWindow = 2 * kRadius + 1;

  explicit BoxCuts(const Magnitudes& of) noexcept
      : all(cutsFor(std::bit_cast<float>(of.largest), kWindow * kWindow)) {
    // The last binary place of the smallest sample, which the last bit of a lane must not be above.
    constexpr int kFraction = 23, kLeastPlace = -149;
    const int place = std::max((static_cast<int>(of.least >> kFraction) - 127) - kFraction, kLeastPlace);
    const auto holds = [&](int lane) { return std::ilogb(all.cut[lane]) - 52 <= place; };
    lanes = of.largest == 0 || holds(0) ? 1 : holds(1) ? 2 : SumLanes::kMaxLanes;
  }

  // The mean of at(dy, dx), in as many lanes as there are.
  [[nodiscard]] float mean(auto&& at) const noexcept {
    double sums[SumLanes::kMaxLanes] = {};
    for (int dy = -kRadius; dy <= kRadius; ++dy)
      for (int dx = -kRadius; dx <= kRadius; ++dx) {
        double rest = at(dy, dx);
        for (int l = 0; l + 1 < SumLanes::kMaxLanes; ++l) {
          const double part = (rest + all.cut[l]) - all.cut[l];
          sums[l] += part;
          rest -= part;
        }
        sums[SumLanes::kMaxLanes - 1] += rest;
      }
    return static_cast<float>(roundedSum(sums, SumLanes::kMaxLanes, 1) / (kWindow * kWindow));
  }

  SumLanes all;
  int lanes = 1;
};

#define FETTLE_KERNEL "engine/filter/tile_box-inl.h"
#include "engine/simd/each_cpu-inl.h"

template <void (*kRun)(const TileAround&, float*) noexcept>
class TileBox final : public TileWindow {
 public:
  void run(const TileAround& around, float* out) const noexcept override { kRun(around, out); }
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
