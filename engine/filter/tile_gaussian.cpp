// Gaussians of small windows inside the field, straight from the tiles: the operations of gaussian.cpp, in its order.

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/filter/gaussian_weights.h"
#include "engine/filter/tile_window.h"
#include "engine/simd/kernel.h"

namespace fettle::engine {

#ifdef FETTLE_CPU_LEVELS

namespace {

#define FETTLE_KERNEL "engine/filter/tile_gaussian-inl.h"
#include "engine/simd/each_cpu-inl.h"

class TileGaussian final : public TileWindow {
 public:
  using Kernel = void (*)(const TileAround&, const double* weights, double inverse, float* out) noexcept;

  TileGaussian(std::vector<double> weights, Kernel kernel) : weights_(std::move(weights)), kernel_(kernel) {
    const int radius = static_cast<int>(weights_.size()) - 1;
    const auto sumOf = [&](double each) {
      double sum = 0.0;
      for (int k = -radius; k <= radius; ++k)
        sum = std::fma(weights_[static_cast<std::size_t>(std::abs(k))], each, sum);
      return sum;
    };
    inverse_ = 1.0 / sumOf(sumOf(1.0));
  }

  bool run(const TileAround& around, float* out) const noexcept override {
    kernel_(around, weights_.data(), inverse_, out);
    return true;
  }

 private:
  std::vector<double> weights_;
  Kernel kernel_;
  double inverse_;  // of the weights of a whole window
};

}  // namespace

std::unique_ptr<TileWindow> makeTileGaussian(const FilterSpec& spec, CpuLevel level) {
  if (level == CpuLevel::kPlain) return nullptr;
  std::vector<double> weights = gaussianHalfWeights(spec);
  // Beyond these the turned kernels of gaussian.cpp are faster.
  using Kernels = std::array<TileGaussian::Kernel, 4>;
  constexpr Kernels kWide = {nullptr, avx512::gaussianTile<1>, avx512::gaussianTile<2>,
                             avx512::gaussianTile<3>};
  constexpr Kernels kNarrow = {nullptr, avx2::gaussianTile<1>, avx2::gaussianTile<2>, avx2::gaussianTile<3>};
  const std::size_t radius = weights.size() - 1;
  if (radius == 0 || radius >= kWide.size()) return nullptr;
  return std::make_unique<TileGaussian>(std::move(weights),
                                        (level == CpuLevel::kAvx512 ? kWide : kNarrow)[radius]);
}

#else

std::unique_ptr<TileWindow> makeTileGaussian(const FilterSpec&, CpuLevel) {
  return nullptr;
}

#endif

}  // namespace fettle::engine
