#include "render/plan/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

namespace fettle::render {
namespace {

// Half the perspective camera's angle up and down.
const double kTanHalfAngle = std::tan(17.5 * std::numbers::pi / 180.0);

double sine(double degrees) {
  const double turn = std::remainder(degrees, 360.0);
  if (turn == 0.0 || std::abs(turn) == 180.0) return 0.0;
  if (std::abs(turn) == 90.0) return turn > 0.0 ? 1.0 : -1.0;
  return std::sin(turn * std::numbers::pi / 180.0);
}
double cosine(double degrees) {
  return sine(degrees + 90.0);
}

}  // namespace

ViewAxes axesOf(const View& view) noexcept {
  const double sin_a = sine(view.azimuth_deg), cos_a = cosine(view.azimuth_deg);
  const double sin_e = sine(view.elevation_deg), cos_e = cosine(view.elevation_deg);
  ViewAxes axes;
  axes.right = {cos_a, sin_a, 0.0};
  axes.to_viewer = {cos_e * sin_a, -cos_e * cos_a, sin_e};
  axes.up = glm::cross(axes.to_viewer, axes.right);
  return axes;
}

bool empty(const Rectangle& r) noexcept {
  return r.width <= 0 || r.height <= 0;
}

Rectangle cut(const Rectangle& a, const Rectangle& b) noexcept {
  const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
  const int right = std::min(a.x + a.width, b.x + b.width), low = std::min(a.y + a.height, b.y + b.height);
  return {x, y, std::max(0, right - x), std::max(0, low - y)};
}

std::array<glm::dvec3, 8> corners(const Box& box) {
  std::array<glm::dvec3, 8> c;
  for (std::size_t i = 0; i < 8; ++i)
    c[i] = {(i & 1) != 0 ? box.high.x : box.low.x, (i & 2) != 0 ? box.high.y : box.low.y,
            (i & 4) != 0 ? box.high.z : box.low.z};
  return c;
}

Camera Camera::fit(const View& view, const Box& shown, const Box& drawn, const Rectangle& plot) {
  Camera camera;
  const ViewAxes axes = axesOf(view);
  camera.right_ = axes.right;
  camera.to_viewer_ = axes.to_viewer;
  camera.up_ = axes.up;
  camera.plot_ = plot;

  const glm::dvec3 middle = 0.5 * (shown.low + shown.high);
  glm::dvec3 target = middle;
  target.x = shown.low.x + view.centre_x * (shown.high.x - shown.low.x);
  target.y = shown.low.y + view.centre_y * (shown.high.y - shown.low.y);
  target.z += view.centre_z * std::max(shown.high.x - shown.low.x, shown.high.y - shown.low.y);

  const glm::dmat3 view_rotation = glm::transpose(glm::dmat3(camera.right_, camera.up_, camera.to_viewer_));
  const double aspect = static_cast<double>(plot.width) / plot.height;

  double half_width = 0.0, half_height = 0.0;  // orthographic
  double distance = 0.0;                       // perspective: from eye to middle
  for (const glm::dvec3& corner : corners(shown)) {
    const glm::dvec3 v = view_rotation * (corner - middle);
    half_width = std::max(half_width, std::abs(v.x));
    half_height = std::max(half_height, std::abs(v.y));
    distance = std::max(
        {distance, v.z + std::abs(v.x) / (kTanHalfAngle * aspect), v.z + std::abs(v.y) / kTanHalfAngle});
  }
  if (!(std::max(half_width, half_height) > 0.0))
    half_width = half_height = 0.5, distance = 0.5 / kTanHalfAngle;

  double near = -std::numeric_limits<double>::infinity(), far = -near;
  for (const Box& box : {shown, drawn})
    for (const glm::dvec3& corner : corners(box)) {
      const double depth = glm::dot(camera.to_viewer_, corner - target);
      near = std::max(near, depth);
      far = std::min(far, depth);
    }
  // A small margin, so that nothing lies on the two planes themselves.
  const double margin = 0.01 * (near - far) + 1e-9 * std::max(half_width, half_height);
  near += margin;
  far -= margin;

  glm::dmat4 from_view(0.0);  // columns: clip x, y, z, w as functions of view x, y, z, 1
  if (view.projection == Projection::kOrthographic) {
    const double scale = view.zoom * std::min(plot.width / (2.0 * half_width + 1e-300),
                                              plot.height / (2.0 * half_height + 1e-300));
    camera.pixels_per_mm_ = scale;
    from_view[0][0] = 2.0 * scale / plot.width;
    from_view[1][1] = -2.0 * scale / plot.height;
    from_view[2][2] = -1.0 / (near - far);
    from_view[3] = {0.0, 0.0, near / (near - far), 1.0};
  } else {
    const double near_distance = std::max(distance - near, 1e-3 * distance);
    const double far_distance = std::max(distance - far, 1.001 * near_distance);
    camera.pixels_per_mm_ = view.zoom * 0.5 * plot.height / (kTanHalfAngle * distance);
    const double range = far_distance / (far_distance - near_distance);
    camera.near_w_ = near_distance;
    from_view[0][0] = view.zoom / (kTanHalfAngle * aspect);
    from_view[1][1] = -view.zoom / kTanHalfAngle;
    from_view[2][2] = -range;
    from_view[2][3] = -1.0;
    from_view[3] = {0.0, 0.0, range * (distance - near_distance), distance};
  }
  glm::dmat4 view_from_scene(view_rotation);
  view_from_scene[3] = glm::dvec4(-(view_rotation * target), 1.0);
  camera.clip_from_scene_ = from_view * view_from_scene;
  camera.scene_from_clip_ = glm::inverse(camera.clip_from_scene_);
  camera.distance_ = distance;
  camera.across_ = from_view[0][0];
  camera.target_ = target;
  camera.perspective_ = view.projection == Projection::kPerspective;
  return camera;
}

Camera Camera::ofEye(const EyeView& eye, const Box& drawn, const Rectangle& plot) {
  Camera camera;
  camera.right_ = eye.axes.right;
  camera.up_ = eye.axes.up;
  camera.to_viewer_ = eye.axes.to_viewer;
  camera.plot_ = plot;
  camera.perspective_ = true;
  const auto ahead = [&](const glm::dvec3& point) {
    return -glm::dot(eye.axes.to_viewer, point - eye.position);
  };
  double near = std::numeric_limits<double>::infinity(), far = 0.0;
  for (const glm::dvec3& corner : corners(drawn)) {
    near = std::min(near, ahead(corner));
    far = std::max(far, ahead(corner));
  }
  const double size = glm::length(drawn.high - drawn.low);
  // A head may be inside the block or look away from it: then the middle has no distance in front of the eye.
  const double least = 1e-3 * size + 1e-9;
  camera.distance_ = std::max(ahead(0.5 * (drawn.low + drawn.high)), least);
  camera.target_ = eye.position - camera.distance_ * eye.axes.to_viewer;
  const double margin = 0.01 * size;
  near = std::max(near - margin, least);
  far = std::max(far + margin, 2.0 * near);
  const double across = eye.right - eye.left, along = eye.up - eye.down;
  camera.near_w_ = near;
  camera.across_ = 2.0 / across;
  camera.pixels_per_mm_ = std::max(plot.width / across, plot.height / along) / camera.distance_;
  const double range = far / (far - near);
  glm::dmat4 from_view(0.0);  // columns: clip x, y, z, w as functions of view x, y, z, 1; clip w = -z
  from_view[0][0] = 2.0 / across;
  from_view[1][1] = -2.0 / along;
  from_view[2] = {(eye.right + eye.left) / across, -(eye.up + eye.down) / along, -range, -1.0};
  from_view[3][2] = -range * near;
  const glm::dmat3 rotation = glm::transpose(glm::dmat3(camera.right_, camera.up_, camera.to_viewer_));
  glm::dmat4 view_from_scene(rotation);
  view_from_scene[3] = glm::dvec4(-(rotation * eye.position), 1.0);
  camera.clip_from_scene_ = from_view * view_from_scene;
  camera.scene_from_clip_ = glm::inverse(camera.clip_from_scene_);
  return camera;
}

Camera Camera::aside(double share, double window) const noexcept {
  Camera eye = *this;
  const double aside = share * distance_, at_window = window * distance_;
  // Distance of a point behind the window, over the window's distance, as a function of x, y, z, 1.
  const glm::dvec4 behind =
      glm::dvec4(-to_viewer_, distance_ - at_window + glm::dot(to_viewer_, target_)) / at_window;
  // From the eye's position all points move by -aside; the frustum is sheared back so that points in the
  // window stay: clip x grows by across * aside * (w / at_window - 1), w being the distance from the viewer.
  // The parallel camera uses only that shear.
  for (int i = 0; i < 4; ++i) eye.clip_from_scene_[i][0] += across_ * aside * behind[i];
  eye.scene_from_clip_ = glm::inverse(eye.clip_from_scene_);
  return eye;
}

Camera Camera::part(const Rectangle& part) const noexcept {
  Camera c = *this;
  const glm::dvec2 plot(plot_.width, plot_.height), size(part.width, part.height);
  const glm::dvec2 scale = plot / size;
  // Twice the vector from the part's middle to the plot's, in halves of the part.
  const glm::dvec2 shift = (2.0 * glm::dvec2(plot_.x - part.x, plot_.y - part.y) + plot - size) / size;
  for (int i = 0; i < 4; ++i) {
    glm::dvec4& clip = c.clip_from_scene_[i];
    clip.x = scale.x * clip.x + shift.x * clip.w;
    // Clip y runs down, as rows do.
    clip.y = scale.y * clip.y + shift.y * clip.w;
  }
  c.scene_from_clip_ = glm::inverse(c.clip_from_scene_);
  c.across_ *= scale.x;
  c.plot_ = part;
  return c;
}

double Camera::asidePixels(double window) const noexcept {
  return 0.5 * plot_.width * across_ * (perspective_ ? 1.0 / window : distance_);
}

double Camera::windowOf(const glm::dvec3& point) const noexcept {
  return 1.0 - glm::dot(to_viewer_, point - target_) / distance_;
}

glm::dvec2 Camera::pixelOf(const glm::dvec3& point) const noexcept {
  const glm::dvec4 clip = clip_from_scene_ * glm::dvec4(point, 1.0);
  return {plot_.x + (clip.x / clip.w + 1.0) * 0.5 * plot_.width,
          plot_.y + (clip.y / clip.w + 1.0) * 0.5 * plot_.height};
}

Ray Camera::rayAt(const glm::dvec2& pixel) const noexcept {
  const double x = (pixel.x - plot_.x) / plot_.width * 2.0 - 1.0;
  const double y = (pixel.y - plot_.y) / plot_.height * 2.0 - 1.0;
  const glm::dvec4 near = scene_from_clip_ * glm::dvec4(x, y, 0.0, 1.0);
  const glm::dvec4 far = scene_from_clip_ * glm::dvec4(x, y, 1.0, 1.0);
  const glm::dvec3 from = glm::dvec3(near) / near.w;
  return {from, glm::normalize(glm::dvec3(far) / far.w - from)};
}

double Camera::movesAtMost(const glm::dvec3& step, const Box& box) const noexcept {
  const glm::dvec4 move = clip_from_scene_ * glm::dvec4(step, 0.0);
  double w = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& corner : corners(box))
    w = std::min(w, (clip_from_scene_ * glm::dvec4(corner, 1.0)).w);
  // (x + dx) / (w + dw) - x / w = (dx - (x / w) dw) / (w + dw), and |x / w| <= 1 for visible points. The end
  // of the move is in the box or one step from it, hence the smaller w.
  w = std::max(w - std::abs(move.w), near_w_);
  return std::hypot((std::abs(move.x) + std::abs(move.w)) * 0.5 * plot_.width,
                    (std::abs(move.y) + std::abs(move.w)) * 0.5 * plot_.height) /
         w;
}

double Camera::depthOf(const glm::dvec3& point) const noexcept {
  return -glm::dot(to_viewer_, point);
}

bool Camera::misses(const Box& box) const noexcept {
  int outside[6] = {};
  for (const glm::dvec3& corner : corners(box)) {
    const glm::dvec4 c = clip_from_scene_ * glm::dvec4(corner, 1.0);
    outside[0] += c.x < -c.w;
    outside[1] += c.x > c.w;
    outside[2] += c.y < -c.w;
    outside[3] += c.y > c.w;
    outside[4] += c.z < 0.0;
    outside[5] += c.z > c.w;
  }
  return std::any_of(std::begin(outside), std::end(outside), [](int n) { return n == 8; });
}

}  // namespace fettle::render
