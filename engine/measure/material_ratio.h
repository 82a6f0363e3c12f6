#pragma once

#include <span>

namespace fettle::engine {

/// Functional parameters of a surface by its material ratio (Abbott) curve: ISO 25178-2:2021, 4.4, and for the
/// equivalent straight line ISO 13565-2. Heights [height_unit], volumes per area [height_unit], ratios 0 .. 1.
struct MaterialRatio {
  double sk = 0.0;     ///< core height
  double spk = 0.0;    ///< reduced peak height
  double svk = 0.0;    ///< reduced dale height
  double smrk1 = 0.0;  ///< material ratio where the peaks end; NaN, as smrk2, where the core has no height
  double smrk2 = 0.0;  ///< where the dales begin
  double vmp = 0.0;    ///< material volume of the peaks, above VolumeRatios::peaks
  double vmc = 0.0;    ///< of the core, from there to VolumeRatios::dales
  double vvc = 0.0;    ///< void volume of the core
  double vvv = 0.0;    ///< of the dales, below VolumeRatios::dales
  double sxp = 0.0;    ///< peak extreme height: from 2.5 to 50 %
};

/// Where peaks end and dales begin in volumes: ISO 25178-3 has 10 % and 80 % where no others are given. 0 <= peaks <= dales <= 1.
struct VolumeRatios {
  double peaks = 0.1, dales = 0.8;

  friend bool operator==(const VolumeRatios&, const VolumeRatios&) = default;
};

/// Two material ratios, 0 <= first <= second <= 1: the height of the first is the higher one.
struct RatioPair {
  double first = 0.0, second = 1.0;
};

/// `sorted`: heights from the lowest to the highest, at least one. The curve goes through the middles of the samples'
/// shares and is straight between them; it begins at the highest and ends at the lowest height. The equivalent
/// line is fitted by least squares of heights to the 40 % with the smallest difference of heights, the first from the
/// top of equal ones. Linear time; any thread.
[[nodiscard]] MaterialRatio materialRatio(std::span<const float> sorted,
                                          const VolumeRatios& volumes = {}) noexcept;

/// Vm(p), the material volume per area above the height of a ratio 0 .. 1, and Vv(p), the void volume below it: ISO 25178-2:2021, 4.4
/// [height_unit]. `sorted` as there; any thread.
[[nodiscard]] double materialVolume(std::span<const float> sorted, double ratio) noexcept;
[[nodiscard]] double voidVolume(std::span<const float> sorted, double ratio) noexcept;

/// Smr(c), the share of samples at or above a height, and its inverse Smc(mr), the height of a ratio 0 .. 1 on the curve
/// of materialRatio(): ISO 25178-2:2021, 4.4. `sorted` as there; any thread.
[[nodiscard]] double ratioAtHeight(std::span<const float> sorted, double height) noexcept;
[[nodiscard]] double heightAtRatio(std::span<const float> sorted, double ratio) noexcept;

}  // namespace fettle::engine
