#pragma once

#include <array>

#include "engine/base/error.h"
#include "render/plan/camera.h"

namespace fettle::render {

/// How the pictures of the two eyes are shown.
enum class StereoMode {
  kOff,
  kSideBySide,  ///< the left eye's picture in the left half, the right eye's in the right half, each in true proportions: for screens and goggles that separate the halves
  kAnaglyph,  ///< both superimposed in the colours of red - cyan glasses (left eye red), shaders/stereo.frag
};

/// A picture for each eye: off-axis frusta through one window in the scene, without rotation, so that no
/// point is higher for one eye than for the other. Parallel views, which have no eye position, are sheared
/// instead: what two distant eyes would see through that window.
struct Stereo {
  StereoMode mode = StereoMode::kOff;
  /// Distance between the eyes, as a share of their distance from the middle of what is shown, > 0 .. 0.25.
  /// Photographers use a thirtieth; larger values make relief stronger and viewing harder.
  double eye_separation = 1.0 / 30.0;
  /// When > 0, used instead: the distance on the screen [mm] between the two pictures of a point far behind
  /// the window, 1 .. 200. At the distance between a person's pupils (63 on average) the eyes are parallel;
  /// beyond it they would have to diverge.
  double eye_separation_mm = 0.0;
  double mm_per_pixel = 0.25;  ///< of the screen, for eye_separation_mm; 0.01 .. 10
  /// Position of the window, whose points both eyes see at the same place: as a share of the eyes' distance
  /// from the middle of what is shown, 0.1 .. 10. 0: at the surface in the middle of the picture.
  double screen_distance = 0.0;
  /// Passes over the scene: one for both eyes, where the device supports it (multiview), or two. The pictures
  /// are bit-identical.
  enum class Passes {
    kBest,  ///< one, unless the driver draws it wrongly: Context::multiviewWorks
    kOne,   ///< one, wherever the device reports that it draws several views at once
    kTwo,
  } passes = Passes::kBest;
};

/// Errors (kInput): a value outside the ranges above.
[[nodiscard]] engine::Status check(const Stereo& stereo);

enum class Eye { kLeft = 0, kRight = 1 };

/// The two eyes of a camera between them, left and right. `screen_distance`: as in Stereo, > 0.
[[nodiscard]] std::array<Camera, 2> eyesOf(const Camera& middle, const Stereo& stereo,
                                           double screen_distance);

/// How much further to the right the right eye sees a point than the left eye does [px]: 0 in the window,
/// less in front of it.
[[nodiscard]] double parallaxOf(const std::array<Camera, 2>& eyes, const glm::dvec3& point) noexcept;

}  // namespace fettle::render
