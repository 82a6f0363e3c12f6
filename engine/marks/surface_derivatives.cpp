#include "engine/marks/surface_derivatives.h"

#include "engine/simd/kernel.h"

namespace fettle::engine {

namespace {

#define FETTLE_KERNEL "engine/marks/surface_derivatives-inl.h"
#include "engine/simd/each_cpu-inl.h"

const auto kSlide = FETTLE_AT_LEVEL(bestCpuLevel(), slide);
const auto kSlideUp = FETTLE_AT_LEVEL(bestCpuLevel(), slideUp);

}  // namespace

void SurfaceDerivatives::take(const WholeSurface& surface, const EdgeKernels& kernels, int columns,
                              int rows) {
  const int taps = 2 * kernels.radius + 1, n = columns - 2 * kernels.radius;
  const auto at = [columns](int c, int r) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(c);
  };
  const std::size_t size = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  for (std::vector<float>* v : {&smooth_rows_, &first_rows_, &second_rows_, &gx, &gy, &hxx, &hxy, &hyy})
    v->resize(size);
  for (int r = 0; r < rows; ++r) {
    const std::size_t i = at(0, r), o = at(kernels.radius, r);
    kSlide(&surface.heights[i], kernels.smooth.data(), taps, n, &smooth_rows_[o]);
    kSlide(&surface.heights[i], kernels.first.data(), taps, n, &first_rows_[o]);
    kSlide(&surface.heights[i], kernels.second.data(), taps, n, &second_rows_[o]);
  }
  for (int r = kernels.radius; r < rows - kernels.radius; ++r) {
    const std::size_t i = at(kernels.radius, r - kernels.radius), o = at(kernels.radius, r);
    kSlideUp(&first_rows_[i], columns, kernels.smooth.data(), taps, n, &gx[o]);
    kSlideUp(&smooth_rows_[i], columns, kernels.first.data(), taps, n, &gy[o]);
    kSlideUp(&second_rows_[i], columns, kernels.smooth.data(), taps, n, &hxx[o]);
    kSlideUp(&first_rows_[i], columns, kernels.first.data(), taps, n, &hxy[o]);
    kSlideUp(&smooth_rows_[i], columns, kernels.second.data(), taps, n, &hyy[o]);
  }
  if (!surface.holes) return;
  share.resize(size);
  valid_.assign(surface.valid.begin(), surface.valid.end());
  for (int r = 0; r < rows; ++r)
    kSlide(&valid_[at(0, r)], kernels.smooth.data(), taps, n, &smooth_rows_[at(kernels.radius, r)]);
  for (int r = kernels.radius; r < rows - kernels.radius; ++r)
    kSlideUp(&smooth_rows_[at(kernels.radius, r - kernels.radius)], columns, kernels.smooth.data(), taps, n,
             &share[at(kernels.radius, r)]);
}

}  // namespace fettle::engine
