#pragma once

#include <array>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "render/plan/picture.h"

namespace fettle::render {

/// Part of a picture [pixels], (0, 0) = top left corner.
struct Rectangle {
  int x = 0, y = 0, width = 0, height = 0;
  friend bool operator==(const Rectangle&, const Rectangle&) = default;
};
[[nodiscard]] bool empty(const Rectangle& r) noexcept;
/// The common part of two rectangles; of size zero where there is none.
[[nodiscard]] Rectangle cut(const Rectangle& a, const Rectangle& b) noexcept;

/// A box in scene coordinates [mm], exaggeration in z.
struct Box {
  glm::dvec3 low{0.0};
  glm::dvec3 high{0.0};
  friend bool operator==(const Box&, const Box&) = default;
};

/// A half line in scene coordinates.
struct Ray {
  glm::dvec3 from;
  glm::dvec3 along;  ///< unit, away from the viewer
};

/// Directions of a view in the scene, unit vectors: to the picture's right, to its top, to the viewer.
struct ViewAxes {
  glm::dvec3 right{1.0, 0.0, 0.0}, up{0.0, 1.0, 0.0}, to_viewer{0.0, 0.0, 1.0};
};
/// Exact at multiples of 90 degrees, where pictures must be aligned with the field.
[[nodiscard]] ViewAxes axesOf(const View& view) noexcept;

/// An eye in the scene, with the part of space that its picture shows: tangents of the angles from the direction in which it
/// looks, to the right and upwards.
struct EyeView {
  glm::dvec3 position{0.0};  ///< scene [mm]
  ViewAxes axes;
  double left = -1.0, right = 1.0, down = -1.0, up = 1.0;  ///< left < right, down < up
};

/// Transforms scene coordinates into pixels and back, in double precision. Scene coordinates are
/// right-handed: x and y as in the field, z up. Clip space is Vulkan's: y down, depth 0 (near) .. 1 (far).
class Camera {
 public:
  Camera() = default;

  /// The camera of `view` that shows all of `shown` in `plot` at zoom 1, and whose depth range also contains
  /// all of `drawn`. A box without extent is shown as if it were one millimetre wide. view.width and
  /// view.height are not used.
  [[nodiscard]] static Camera fit(const View& view, const Box& shown, const Box& drawn,
                                  const Rectangle& plot);

  /// The perspective camera of an eye, whose depth range contains what lies in front of it of `drawn`. Its distance() is that
  /// of the box's middle.
  [[nodiscard]] static Camera ofEye(const EyeView& eye, const Box& drawn, const Rectangle& plot);

  [[nodiscard]] const glm::dmat4& clipFromScene() const noexcept { return clip_from_scene_; }
  /// Unit vectors in the scene: to the picture's right, to its top, to the viewer.
  [[nodiscard]] const glm::dvec3& right() const noexcept { return right_; }
  [[nodiscard]] const glm::dvec3& up() const noexcept { return up_; }
  [[nodiscard]] const glm::dvec3& toViewer() const noexcept { return to_viewer_; }

  /// The camera of an eye next to this one that looks through the same window: a plane perpendicular to the
  /// view at `window` times the distance of the middle of what is shown, whose points both eyes see at the
  /// same pixels (Bourke 1999, "Calculating stereo pairs"). `share`: how far to the right it is, as a share
  /// of that distance. A parallel camera has no position; it is sheared as if it were at the perspective
  /// one's.
  [[nodiscard]] Camera aside(double share, double window) const noexcept;
  /// Pixels by which a point far behind the window is moved in such an eye's picture, for a share of 1.
  [[nodiscard]] double asidePixels(double window) const noexcept;
  /// The `window` in which a point lies; > 0 in front of the viewer.
  [[nodiscard]] double windowOf(const glm::dvec3& point) const noexcept;

  /// The camera of only a part of the picture, which may extend beyond the plot: a point has the same pixel,
  /// except for rounding, and clip space ends where `part` does.
  [[nodiscard]] Camera part(const Rectangle& part) const noexcept;

  /// Pixels per millimetre parallel to the picture, at the middle of what is shown.
  [[nodiscard]] double pixelsPerMm() const noexcept { return pixels_per_mm_; }
  /// The same at the depth of a point; <= 0 or infinite where a perspective camera has it beside or behind it.
  [[nodiscard]] double pixelsPerMmAt(const glm::dvec3& point) const noexcept {
    return perspective_ ? pixels_per_mm_ / windowOf(point) : pixels_per_mm_;
  }
  /// The scene point in the middle of the plot, and its distance from the viewer [mm]; that of a parallel
  /// camera is assumed.
  [[nodiscard]] const glm::dvec3& target() const noexcept { return target_; }
  [[nodiscard]] double distance() const noexcept { return distance_; }

  /// Position of a scene point in the picture; pixel (i, j) covers [i, i + 1) x [j, j + 1).
  [[nodiscard]] glm::dvec2 pixelOf(const glm::dvec3& point) const noexcept;

  /// The ray under a position in the picture.
  [[nodiscard]] Ray rayAt(const glm::dvec2& pixel) const noexcept;

  /// Upper limit of how far a point of the box moves in the picture when it moves by at most `step` in the
  /// scene [px]; of visible points and moves only: what is in front of the near plane does not count.
  [[nodiscard]] double movesAtMost(const glm::dvec3& step, const Box& box) const noexcept;

  /// Distance from the viewer, for sorting: grows away from it.
  [[nodiscard]] double depthOf(const glm::dvec3& point) const noexcept;

  /// Whether no part of the box can be in the plot. Conservative: false where uncertain.
  [[nodiscard]] bool misses(const Box& box) const noexcept;

  /// Whether both are bit-identical.
  friend bool operator==(const Camera&, const Camera&) = default;

 private:
  glm::dmat4 clip_from_scene_{1.0};
  glm::dmat4 scene_from_clip_{1.0};
  glm::dvec3 right_{1.0, 0.0, 0.0}, up_{0.0, 1.0, 0.0}, to_viewer_{0.0, 0.0, 1.0};
  double pixels_per_mm_ = 1.0;
  double near_w_ = 1.0;    // clip w on the near plane; 1 when orthographic
  double distance_ = 1.0;  // of the viewer from the target [mm]; assumed when orthographic
  double across_ = 1.0;    // clip x of a millimetre to the right
  glm::dvec3 target_{0.0};
  bool perspective_ = false;
  Rectangle plot_;
};

/// The eight corners of a box.
[[nodiscard]] std::array<glm::dvec3, 8> corners(const Box& box);

}  // namespace fettle::render
