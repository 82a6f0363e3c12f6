#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"

namespace fettle::engine {

/// The heights of a field, or of blocks of its samples, as one array in millimetres.
struct HeightMap {
  std::int32_t width = 0, height = 0;
  double x0 = 0.0, y0 = 0.0;                ///< field coordinates of the first place [mm]
  double spacing_x = 1.0, spacing_y = 1.0;  ///< [mm]
  double own_x = 0.0, own_y = 0.0;          ///< standard deviation of the blocks' own window [mm]
  std::vector<double> z;                    ///< row-major [mm]; NaN: a hole

  [[nodiscard]] std::size_t index(std::int32_t column, std::int32_t row) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
  [[nodiscard]] double at(std::int32_t column, std::int32_t row) const noexcept {
    return z[index(column, row)];
  }
};

/// The means of blocks of block_x x block_y samples of a region, without those more than twelve median distances away from
/// the block's median, signs applied; blocks
/// that stand over the upper or right border are left out, one of which fewer than half belong to the region is a hole.
/// Heights less `base` [mm]. Errors: kCancelled. Throws std::bad_alloc. Thread: any; on all workers of the calling arena.
[[nodiscard]] Result<HeightMap> heightMapOf(const Version& field, Region region, std::int32_t block_x,
                                            std::int32_t block_y, double base, JobControl& job);

/// The spacing of some `places` squares that cover a grid, no less than its own [mm].
[[nodiscard]] double spacingFor(const Grid& grid, double places) noexcept;

/// The middle height of a field, and a size that nine of ten heights do not exceed [mm]: of blocks, so that spikes of any
/// height do not move them. 0 for a field of holes. Errors and threads: as heightMapOf.
struct HeightsAround {
  double middle = 0.0, size = 0.0;
};
[[nodiscard]] Result<HeightsAround> heightsAround(const Version& field, Region region, JobControl& job);

/// Makes holes of the places that lie apart from their eight neighbours, as spikes do: by more than four times the range
/// of these without the highest and the lowest, and eight times the median of all such distances. Steps, walls and slopes
/// stay but for the corners of walls.
void dropSpikes(HeightMap& map);

/// A map through a Gaussian window that makes its blocks' own up to a standard deviation sigma [mm]: the value in the middle of the plane that fits
/// the window's heights best: holes and borders shift it by the curvature alone. Places whose window holds less than 0.8
/// of what it holds in the mean are holes, with kLeftOut also those nearer than 1.7 sigma to the border; other holes are filled where `fill` says so. Throws std::bad_alloc.
enum class AtHoles : std::uint8_t { kStay, kFill };
enum class Borders : std::uint8_t { kStay, kLeftOut };
struct SmoothMap {
  HeightMap value;
  std::vector<double> slope_x, slope_y;  ///< of the plane
};
[[nodiscard]] SmoothMap smoothed(const HeightMap& map, double sigma, AtHoles holes, Borders borders);

/// Cubic B-splines through the heights of a map (M. Unser, Splines: a perfect fit for signal and image processing, 1999):
/// smooth heights between its places, with their slopes.
class MapSpline {
 public:
  explicit MapSpline(const HeightMap& map);

  struct Place {
    double z = 0.0, slope_x = 0.0, slope_y = 0.0;  ///< [mm], [mm/mm]
    bool there = false;                            ///< false: outside, or next to a hole
  };
  [[nodiscard]] Place at(double x, double y) const noexcept;

 private:
  HeightMap coefficients_;
  std::vector<std::uint8_t> whole_;  // the four places around a cell's are no holes
};

}  // namespace fettle::engine
