#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/edges/offsets.h"
#include "engine/edges/strip.h"
#include "engine/edges/surface_fit.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// The surfaces on both sides of a break reach from `low` to the break and from there to `high`. [samples]
struct Extent {
  float low = 0.0F, high = 0.0F;
};

/// How a short strip around one point of a line is divided across into planes.
///
///     d   -depth        low        own       high    depth
///          +--- plane ---+-- plane -+-- plane --+-- plane --+
///          free or absent    the offset that         a neighbour's break, at its offset
///          breaks: a price   is asked for            or absent: a price
///
/// For each offset of the own break, the least sum of squared residuals over all divisions that keep the order
/// of the breaks, over the noise's variance, plus the prices; found by dynamic programming from both ends
/// (Bellman 1961, On the approximation of curves by line segments). In place of the two planes at the own break
/// also a hinge.
///
/// The squares are tempered: divided by what the best division leaves per sample, where that is more than the
/// noise. Where the surfaces are no planes, nothing is located with false certainty by what the model lacks.
///
/// One object serves one thread at a time; it keeps its buffers.
class AcrossSearch {
 public:
  struct Model {
    double depth = 12.0;     ///< half the width of the strip [samples], a multiple of a half
    Offsets offsets;         ///< of the own break, within the depth
    double variance = 0.0;   ///< of the noise [height_unit^2]
    double deviation = 1.2;  ///< of the breaks from where their lines are now [samples]
  };
  /// `level`: of vector instructions; no bit of a result depends on it.
  explicit AcrossSearch(const Model& model, CpuLevel level = bestCpuLevel());

  void clear();
  /// A sample of the strip; s counts from the point.
  void add(const StripSample& sample, double s) noexcept;

  /// `breaks`: where the lines are expected, in ascending order, the own one is breaks[own] = 0. Fills, for
  /// each offset of the model, its cost (chi-square, 0 or more) and the extent of its surfaces.
  void solve(std::span<const double> breaks, std::size_t own, std::span<float> costs,
             std::span<Extent> extents);

 private:
  static constexpr std::size_t kMoments = 10;

  [[nodiscard]] double offsetOf(std::size_t edge) const noexcept {
    return static_cast<double>(edge) * Offsets::kStep - model_.depth;
  }
  [[nodiscard]] float pull(double expected, std::size_t edge) const noexcept;
  void sumBins();
  void fitSegments();
  void sweep(bool mirrored, std::span<const double> breaks, std::size_t levels, double temper,
             bool free_breaks);
  [[nodiscard]] Moments between(std::size_t low, std::size_t high) const noexcept;

  Model model_;
  void (*fit_from_)(const double* const* sums, std::size_t low, std::size_t first, std::size_t end,
                    double weight, float* residuals) noexcept;
  std::size_t bins_;                    // across the strip
  std::vector<Moments> bin_;            // moments of each
  std::vector<double> sums_[kMoments];  // of all bins before an edge between bins, bins_ + 1 each
  // Residual of the plane between two edges, over the variance: [low][high], and mirrored at the middle.
  std::vector<float> segments_, mirrored_;
  // Least costs with as many breaks used as the level, up to an edge: where a segment begins, where it ends.
  struct Levels {
    std::vector<float> begin, end;
  };
  Levels left_, right_;
};

}  // namespace fettle::engine
