#include "engine/measure/material_ratio.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "engine/compare/tile_sums.h"

namespace fettle::engine {

namespace {

// Heights by the share of the samples that are at or above them.
class AbbottCurve {
 public:
  explicit AbbottCurve(std::span<const float> sorted) noexcept : sorted_(sorted) {}

  [[nodiscard]] std::size_t samples() const noexcept { return sorted_.size(); }
  // The height of rank `rank`, 0 = the highest.
  [[nodiscard]] double ranked(std::size_t rank) const noexcept { return sorted_[samples() - 1 - rank]; }
  // The share up to the middle of a rank.
  [[nodiscard]] double share(std::size_t rank) const noexcept {
    return (static_cast<double>(rank) + 0.5) / static_cast<double>(samples());
  }

  [[nodiscard]] double height(double ratio) const noexcept {
    const double rank =
        std::clamp(ratio * static_cast<double>(samples()) - 0.5, 0.0, static_cast<double>(samples() - 1));
    const auto low = static_cast<std::size_t>(rank);
    const std::size_t high = std::min(low + 1, samples() - 1);
    const double part = rank - static_cast<double>(low);
    return ranked(low) + part * (ranked(high) - ranked(low));
  }

  // The share of samples above a height.
  [[nodiscard]] double above(double height) const noexcept {
    const auto first = std::upper_bound(sorted_.begin(), sorted_.end(), height,
                                        [](double h, float sample) { return h < sample; });
    return static_cast<double>(sorted_.end() - first) / static_cast<double>(samples());
  }

  // Mean over all samples of what lies above, or below, a height.
  [[nodiscard]] double volumeAbove(double height) const noexcept {
    CompensatedSum sum;
    for (std::size_t rank = 0; rank < samples() && ranked(rank) > height; ++rank)
      sum.add(ranked(rank) - height);
    return sum.value() / static_cast<double>(samples());
  }
  [[nodiscard]] double volumeBelow(double height) const noexcept {
    CompensatedSum sum;
    for (const float sample : sorted_) {
      if (!(sample < height)) break;
      sum.add(height - sample);
    }
    return sum.value() / static_cast<double>(samples());
  }

 private:
  std::span<const float> sorted_;
};

struct Line {
  double top = 0.0, bottom = 0.0;  // heights at ratios 0 and 1
};

Line equivalentLine(const AbbottCurve& curve) noexcept {
  const std::size_t n = curve.samples();
  const std::size_t window =
      std::min(n - 1, static_cast<std::size_t>(std::llround(0.4 * static_cast<double>(n))));
  std::size_t first = 0;
  double least = curve.ranked(0) - curve.ranked(window);
  for (std::size_t i = 1; i + window < n; ++i) {
    const double fall = curve.ranked(i) - curve.ranked(i + window);
    if (fall < least) {
      least = fall;
      first = i;
    }
  }
  const double middle = 0.5 * (curve.share(first) + curve.share(first + window));
  const double base = curve.ranked(first + window / 2);
  CompensatedSum z, zx, xx;
  for (std::size_t i = first; i <= first + window; ++i) {
    const double x = curve.share(i) - middle, h = curve.ranked(i) - base;
    z.add(h);
    zx.add(h * x);
    xx.add(x * x);
  }
  const double mean = base + z.value() / static_cast<double>(window + 1);
  const double slope = xx.value() > 0.0 ? zx.value() / xx.value() : 0.0;
  return {mean - slope * middle, mean + slope * (1.0 - middle)};
}

}  // namespace

MaterialRatio materialRatio(std::span<const float> sorted, const VolumeRatios& volumes) noexcept {
  const AbbottCurve curve(sorted);
  MaterialRatio result;
  const Line line = equivalentLine(curve);
  result.sk = line.top - line.bottom;
  result.smrk1 = curve.above(line.top);
  result.smrk2 = curve.above(line.bottom);
  // Triangles of the same area on the same base.
  if (result.smrk1 > 0.0) result.spk = 2.0 * curve.volumeAbove(line.top) / result.smrk1;
  if (result.smrk2 < 1.0) result.svk = 2.0 * curve.volumeBelow(line.bottom) / (1.0 - result.smrk2);
  // A core at one height ends nowhere.
  if (!(result.sk > 0.0)) result.smrk1 = result.smrk2 = std::numeric_limits<double>::quiet_NaN();

  const double peaks = curve.height(volumes.peaks), dales = curve.height(volumes.dales);
  result.vmp = curve.volumeAbove(peaks);
  result.vmc = curve.volumeAbove(dales) - result.vmp;
  result.vvv = curve.volumeBelow(dales);
  result.vvc = curve.volumeBelow(peaks) - result.vvv;
  constexpr double kExtreme = 0.025, kMedian = 0.5;
  result.sxp = curve.height(kExtreme) - curve.height(kMedian);
  return result;
}

double materialVolume(std::span<const float> sorted, double ratio) noexcept {
  const AbbottCurve curve(sorted);
  return curve.volumeAbove(curve.height(ratio));
}

double voidVolume(std::span<const float> sorted, double ratio) noexcept {
  const AbbottCurve curve(sorted);
  return curve.volumeBelow(curve.height(ratio));
}

double ratioAtHeight(std::span<const float> sorted, double height) noexcept {
  const auto first = std::lower_bound(sorted.begin(), sorted.end(), height,
                                      [](float sample, double h) { return sample < h; });
  return static_cast<double>(sorted.end() - first) / static_cast<double>(sorted.size());
}

double heightAtRatio(std::span<const float> sorted, double ratio) noexcept {
  return AbbottCurve(sorted).height(ratio);
}

}  // namespace fettle::engine
