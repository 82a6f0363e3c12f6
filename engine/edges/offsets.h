#pragma once

#include <cmath>

namespace fettle::engine {

/// The offsets across a line that are tried: -reach .. reach in quarters of a sample.
struct Offsets {
  static constexpr double kStep = 0.25;  ///< [samples]

  double reach = 0.0;  ///< [samples], a multiple of kStep

  [[nodiscard]] int count() const noexcept { return 2 * static_cast<int>(std::lround(reach / kStep)) + 1; }
  [[nodiscard]] double at(int k) const noexcept { return k * kStep - reach; }
};

}  // namespace fettle::engine
