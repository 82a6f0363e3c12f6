#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/scanner/counter_random.h"

namespace fettle::engine {

/// The geometry and the errors of the simulated scanner, per unit of ScannerSpec::noise. The angle and the
/// ratios were taken from a real scan of an industrial laser-triangulation camera (a plate with steps, 0.21
/// mm spacing, 0.02 mm per count, sigma 0.04 mm): its shadows lie behind steps along the direction of travel
/// and are 0.39 times as long as the step is high.
struct LaserModel {
  double standoff_mm = 150.0;   ///< from the laser to the reference height 0
  double camera_tangent = 0.4;  ///< of the angle between laser sheet and camera, 22 degrees
  double sigma_mm = 0.02;       ///< sensor noise at the reference height
  double speckle_ratio = 0.5;   ///< speckle against sigma_mm
  double speckle_length_mm =
      0.07;                      ///< standard deviation of speckle's correlation kernel along the laser line
  double line_ratio = 0.25;      ///< line-to-line offset against sigma_mm
  double count_ratio = 0.5;      ///< height of one count against sigma_mm
  double mixed_step_mm = 0.2;    ///< least step next to which pixels mix
  double steep_from_deg = 45.0;  ///< faces steeper than this begin to lose samples
  double steep_all_deg = 80.0;   ///< and faces steeper than this lose all of them
};

/// A square of samples during the simulation: the truth with one sample of margin, and the scanned heights.
/// At most kSide on a side.
struct ScanBlock {
  static constexpr int kSide = 64;
  static constexpr int kStride = kSide + 2;

  std::int32_t column = 0;  ///< of the first sample in the field
  std::int32_t row = 0;
  int columns = 0;
  int rows = 0;
  double spacing_mm = 1.0;
  std::array<float, kStride * kStride> truth;  ///< [mm], row-major; NaN: through hole or outside the field
  std::array<double, kSide * kSide> height;    ///< [mm], row-major, stride kSide; NaN: lost

  /// Truth at column c, row r of the block; -1 .. columns, -1 .. rows.
  [[nodiscard]] double truthAt(int c, int r) const noexcept {
    return static_cast<double>(truth[static_cast<std::size_t>((r + 1) * kStride + c + 1)]);
  }
  [[nodiscard]] double& heightAt(int c, int r) noexcept {
    return height[static_cast<std::size_t>(r * kSide + c)];
  }
};

// An effect is called only when its amplitude is not zero. Each uses its own stream of random numbers.

/// Pixels next to a step receive light from both levels: with probability `share` a sample whose 3 x 3
/// neighbourhood in the truth spans a step (more than mixed_step_mm and more than a 70 degree face would)
/// gets a random height between the two levels. Curless and Levoy, Better optical triangulation through
/// spacetime analysis (1995), section 2: discontinuities shift the imaged spot's centre.
void mixPixels(ScanBlock& block, const LaserModel& model, double share, const CounterRandom& random);

/// Independent normal noise of each sample. Its sigma is proportional to the square of the distance, as both
/// the camera's aperture and the triangulation angle shrink with it: Dorsch, Haeusler and Herrmann, Laser
/// triangulation: fundamental uncertainty in distance measurement (1994), eq. 8:
/// dz = C lambda / (2 pi sin u sin theta).
void addSensorNoise(ScanBlock& block, const LaserModel& model, double scale, const CounterRandom& random);

/// Noise correlated along the laser line: neighbouring pixels image overlapping speckles of one laser spot
/// (same source, sections 2 and 3). White noise through a Gaussian kernel of unit power, sigma as above.
void addSpeckle(ScanBlock& block, const LaserModel& model, double scale, std::span<const double> kernel,
                const CounterRandom& random);

/// The kernel of addSpeckle: odd length, sum of squares 1; one tap where the spacing is far above the
/// speckle's length.
[[nodiscard]] std::vector<double> speckleKernel(const LaserModel& model, double spacing_mm);

/// One offset per laser line: the part's carriage vibrates and the laser's direction drifts between
/// exposures.
void addLineOffset(ScanBlock& block, const LaserModel& model, double scale, const CounterRandom& random);

/// Heights are whole counts of the sensor (nearest; ties to even).
void quantise(ScanBlock& block, const LaserModel& model, double scale);

/// Steep faces reflect too little light: from steep_from_deg on the probability of losing the sample grows
/// with the square of the angle, to 1 at steep_all_deg; times `scale`. The angle is that of the flatter side
/// in x and in y, so that a flat sample next to a wall is not steep. After Feng, Liu and Xi, Analysis of
/// digitizing errors of a laser scanning system (2001): errors grow with the projected angle.
void dropSteep(ScanBlock& block, const LaserModel& model, double scale, const CounterRandom& random);

/// Samples the camera cannot see are lost. The camera looks from +y, so the sample (x, y, z) is hidden when
/// some (x, y + t, z') has z' > z + t / camera_tangent. Going down the rows, `horizon` (one per column, start
/// at -infinity) is the highest z' - y' / camera_tangent so far: the test along each ray in O(1) per sample,
/// exact for the sampled truth. Blocks must be passed from the highest rows down.
void dropShadowed(ScanBlock& block, const LaserModel& model, std::span<double> horizon);

/// Fine samples per sample along each axis, of which the heights under the spot are averaged: the place of a wall in
/// the scan is exact to half of one, 0.07 samples.
inline constexpr int kSpotFineness = 7;

/// What the scanner measures through a spot of light: the mean height under a Gaussian of standard deviation `spot`
/// [samples, > 0], cut at three of them, which rounds walls and creases. Through holes reflect nothing: what remains of
/// the spot counts, and a sample in a hole stays one. `height(column, row)`: of the true surface, at any place [mm].
/// The lateral resolution of triangulation: Curless and Levoy 1995 (laser_effects.h), section 2.
void averageUnderSpot(ScanBlock& block, double spot, const std::function<double(double, double)>& height);

}  // namespace fettle::engine
