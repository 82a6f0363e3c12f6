#pragma once

#include "engine/field/grid.h"
#include "render/plan/picture.h"

namespace fettle::app {

/// The mouse buttons that move the view, as in other programs. In all of them: wheel = zoom to the cursor,
/// and Alt+left drag = turn. While a tool is on, the left button is the stylus.
enum class Habits : std::uint8_t {
  kBlender,       ///< middle = turn, Shift+middle = pan, Ctrl+middle = zoom
  kCloudCompare,  ///< left = turn, right = pan
  kMeshLab,       ///< middle = turn, right = pan
};

/// The effect of a drag on the view.
enum class Drag : std::uint8_t { kNone, kTurn, kPan, kZoom };

/// Movements of the camera about a field: pure arithmetic on render::View.
///
/// A turntable: the vertical stays upright. A drag moves the point under the cursor with it: exactly when
/// panning in a parallel projection, at the middle of the picture otherwise.
class Navigation {
 public:
  /// The view from the same direction that shows all of the field.
  static void showAll(render::View& view) noexcept;
  /// Turns by a drag of so many pixels: half a turn per width of the picture.
  static void turn(render::View& view, double dx_px, double dy_px, double picture_px) noexcept;
  /// Pans by a drag. `pixels_per_mm`: of the last frame.
  static void pan(render::View& view, const engine::Grid& grid, double dx_px, double dy_px,
                  double pixels_per_mm) noexcept;
  /// Zooms in by `steps` of the wheel (out below zero); the point at (dx, dy) from the picture's middle stays
  /// in place.
  static void zoom(render::View& view, const engine::Grid& grid, double steps, double dx_px, double dy_px,
                   double pixels_per_mm) noexcept;
  /// Centres the view on a point of the field [mm].
  static void centreOn(render::View& view, const engine::Grid& grid, double x_mm, double y_mm) noexcept;

  /// Centres the view on a part of the field and zooms so that something of `extent_mm` takes about a third of the
  /// picture, from the same direction.
  static void show(render::View& view, const engine::Grid& grid, double x_mm, double y_mm,
                   double extent_mm) noexcept;

  static constexpr double kLowestElevation_deg = 3.0;
  static constexpr double kLargestZoom = 1e5;
  static constexpr double kSmallestZoom = 0.1;
};

}  // namespace fettle::app
