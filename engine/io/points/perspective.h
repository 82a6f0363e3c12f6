#pragma once

#include <cstdint>
#include <string>

#include "engine/io/import.h"
#include "engine/io/points/gridding.h"

namespace fettle::engine {

/// Gives a depth image the grid of its camera: samples stay pixels, heights stay distances along the camera's
/// axis, bit-identical. Spacing is the pitch of the pixels at the median distance, exact there and wrong in
/// proportion to the distance elsewhere; origin: the axis is at 0, 0. A warning states this. `image` has
/// heights; camera as ImportOptions::depth_camera.
void placeInPerspective(Imported& image, const DepthCamera& camera);

/// Makes a field of an organised cloud: `width` * `height` points row by row from the top, those that are not
/// finite as NaN (PointCloud::organized). Where the points lie on a raster, or no camera fits within half a
/// pixel, or the user requests cells: gridPoints. Otherwise its camera is fitted and the samples are its
/// pixels, as by placeInPerspective; z is bit-identical. Errors: as gridPoints.
[[nodiscard]] Result<Imported> gridOrganized(PointCloud&& cloud, std::uint64_t width, std::uint64_t height,
                                             const ImportOptions& options, std::string format,
                                             const std::string& path, JobControl& job);

}  // namespace fettle::engine
