#pragma once

#include <vector>

#include "engine/marks/edge_kernels.h"
#include "engine/marks/whole_surface.h"

namespace fettle::engine {

/// First and second derivatives of a surface by Gaussian kernels. One thread at a time.
class SurfaceDerivatives {
 public:
  /// Of the last block of `surface`, columns x rows. Samples within the kernels' radius of its border have none.
  void take(const WholeSurface& surface, const EdgeKernels& kernels, int columns, int rows);

  // Columns x rows, row-major.
  std::vector<float> gx, gy;         ///< [height unit per sample]
  std::vector<float> hxx, hxy, hyy;  ///< [height unit per square sample]
  std::vector<float> share;          ///< of the kernel's weight that lies on samples; only where holes are

 private:
  std::vector<float> smooth_rows_, first_rows_, second_rows_, valid_;
};

}  // namespace fettle::engine
