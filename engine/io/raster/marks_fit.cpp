#include "engine/io/raster/marks_fit.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/io/geo/crs_text.h"

namespace fettle::engine {

namespace {

bool hasPlace(const Grid& grid) {
  return !grid.crs_wkt.empty() || grid.origin_x != 0.0 || grid.origin_y != 0.0 || grid.spacing_x != 1.0 ||
         grid.spacing_y != 1.0;
}

// Pixels counted from 0: what programs write that know no place.
bool hasPlace(const MarksPlace& marks) {
  if (!marks.transform) return false;
  const GeoTransform& gt = *marks.transform;
  return !marks.crs_wkt.empty() || gt[0] != 0.0 || gt[1] != 1.0 || std::abs(gt[5]) != 1.0 ||
         (gt[3] != 0.0 && gt[3] != marks.height);
}

// Samples along one axis, and the pixels of the marks in them; positions are of centres, ascending.
struct Axis {
  double origin, spacing;  // of the scan
  std::int32_t samples;
  double marks_origin, marks_spacing;
  std::int32_t pixels;

  // Of the pixel of lowest position and of the last one, in samples of the scan.
  [[nodiscard]] double first() const { return (marks_origin - origin) / spacing; }
  [[nodiscard]] double last() const { return first() + (pixels - 1.0) * (marks_spacing / spacing); }
  [[nodiscard]] bool samePixels() const {
    return std::abs((marks_spacing - spacing) / spacing) * (pixels - 1.0) <= kMarksTolerance ||
           (pixels == 1 && std::abs(marks_spacing - spacing) <= kMarksTolerance * spacing);
  }
  [[nodiscard]] double shift() const { return first() - std::nearbyint(first()); }
  [[nodiscard]] bool aligned() const {
    return std::abs(shift()) <= kMarksTolerance &&
           std::abs(last() - std::nearbyint(last())) <= kMarksTolerance;
  }
  // Pixels below the scan's first sample.
  [[nodiscard]] double before() const { return -std::nearbyint(first()); }
  [[nodiscard]] double covered() const {
    return std::max(0.0,
                    std::min(pixels - before(), static_cast<double>(samples)) - std::max(0.0, -before()));
  }
};

}  // namespace

Result<MarksPart> partOfMarks(const Grid& scan, const MarksPlace& marks, const std::string& path) {
  if (!hasPlace(scan) || !hasPlace(marks)) {
    if (marks.width == scan.width && marks.height == scan.height) return MarksPart{};
    return inputError(fmt::format("the marks are {} x {}, the field is {} x {}", marks.width, marks.height,
                                  scan.width, scan.height),
                      path, "take the marks that belong to this field");
  }
  if (!sameHorizontalCrs(scan.crs_wkt, marks.crs_wkt))
    return inputError(
        fmt::format("the marks are in {}, the scan is in {}", crsName(marks.crs_wkt), crsName(scan.crs_wkt)),
        path, "transform them first: gdalwarp -t_srs ... -r near");
  const auto place = placementOf(*marks.transform, marks.width, marks.height, path);
  if (!place) return tl::unexpected(place.error());
  const Axis x{scan.origin_x, scan.spacing_x, scan.width, place->origin_x, place->spacing_x, marks.width};
  const Axis y{scan.origin_y, scan.spacing_y, scan.height, place->origin_y, place->spacing_y, marks.height};
  if (!x.samePixels() || !y.samePixels())
    return inputError(
        fmt::format("the pixels of the marks are {:.9g} x {:.9g}, those of the scan {:.9g} x {:.9g}",
                    place->spacing_x, place->spacing_y, scan.spacing_x, scan.spacing_y),
        path, "resample them first: gdalwarp -tr ... -te ... -r near");
  if (!x.aligned() || !y.aligned())
    return inputError(
        fmt::format("the pixels of the marks lie {:.3g} and {:.3g} pixels beside the scan's samples",
                    x.shift(), y.shift()),
        path, "resample them first: gdalwarp -te ... -r near");
  const double covered = x.covered() * y.covered();
  if (covered < static_cast<double>(scan.samples()))
    return inputError(
        covered > 0.0
            ? fmt::format("the marks are {} x {} and cover {:.0f} of the {} x {} samples of the scan",
                          marks.width, marks.height, covered, scan.width, scan.height)
            : fmt::format("the marks are {} x {} and lie outside the scan of {} x {} samples", marks.width,
                          marks.height, scan.width, scan.height),
        path, "give marks that cover the whole scan");
  MarksPart part;
  part.top_down = place->top_down;
  part.right_to_left = place->right_to_left;
  const auto left = static_cast<std::int32_t>(x.before()), below = static_cast<std::int32_t>(y.before());
  part.first_column = part.right_to_left ? marks.width - left - scan.width : left;
  part.first_row = part.top_down ? marks.height - below - scan.height : below;
  return part;
}

}  // namespace fettle::engine
