#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "render/plan/framing.h"
#include "render/plan/picture.h"

namespace fettle::app {

/// Movements of the camera about a field: pure arithmetic on render::View.
///
/// A turntable: the vertical stays upright. A movement keeps hold of one point of the scene: turning and zooming
/// leave it at its pixel, panning takes it to another one, exactly (except for rounding, and where a limit below
/// ends the movement) in both projections. `framing`: how the view becomes the camera of the panel in which the
/// point is seen (render::LivePicture::grip).
///
/// Of the points on the axis of view, a parallel projection shows all alike as its centre. The one at half the
/// relief is taken, so that views by different ways are equal, or, near the horizon, that beside the block's middle.
class Navigation {
 public:
  /// The view from the same direction that shows all of the field.
  static void showAll(render::View& view) noexcept;
  /// Whether all of the block is seen, or nearly.
  [[nodiscard]] static bool seesAll(const render::View& view, const render::Framing& framing);
  /// Turns to a direction; things near the point keep their size. `elevation_deg` is clamped.
  static void turnAbout(render::View& view, const render::Framing& framing, const glm::dvec3& point,
                        double azimuth_deg, double elevation_deg);
  /// Turns by a drag: a full turn per width of the picture.
  static void turnBy(render::View& view, const render::Framing& framing, const glm::dvec3& point,
                     const glm::dvec2& drag_px, double picture_px);
  /// Pans so that the point is seen at the pixel.
  static void put(render::View& view, const render::Framing& framing, const glm::dvec3& point,
                  const glm::dvec2& pixel);
  /// Zooms in by `steps` of the wheel (out below zero).
  static void zoomAt(render::View& view, const render::Framing& framing, const glm::dvec3& point,
                     double steps);
  /// Puts the point into the middle of the picture.
  static void centreOn(render::View& view, const render::Framing& framing, const glm::dvec3& point);
  /// The same, and zooms so that something of `extent_mm` takes about a third of the picture.
  static void show(render::View& view, const render::Framing& framing, const glm::dvec3& point,
                   double extent_mm);
  /// From a side, or from above. Where all of the field is seen, all of it is afterwards; otherwise `middle`, the
  /// point in the middle of the picture, stays there.
  static void lookFrom(render::View& view, const render::Framing& framing, const glm::dvec3& middle,
                       double azimuth_deg, double elevation_deg);

  static constexpr double kLargestZoom = 1e5;
  static constexpr double kSmallestZoom = 0.1;
  /// Zooms that turning may lead to, since the same size on the screen is another zoom from another side:
  /// what a picture can show.
  static constexpr double kLargestTurned = 1e6, kSmallestTurned = 1e-3;
};

}  // namespace fettle::app
