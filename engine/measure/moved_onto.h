#pragma once

#include <cstdint>
#include <limits>

#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/reader.h"
#include "engine/field/version.h"
#include "engine/measure/rigid_motion.h"

namespace fettle::engine {

/// A field, moved: heights of its bilinear patches at any place. Threading: const functions from any thread.
class MovedField {
 public:
  /// How far beyond the border, and beyond the last sample beside a hole, the patch there goes on [samples]: a motion that is
  /// found is known no better, and what lies on a sample must not be lost by its error.
  static constexpr double kBeyond = 0.01;

  /// Errors: kCancelled. Throws std::bad_alloc. A long job, as heightsAround.
  [[nodiscard]] static Result<MovedField> create(const Version& field, const RigidMotion& motion,
                                                 JobControl& job);

  struct Place {
    double z =
        std::numeric_limits<double>::quiet_NaN();  ///< [mm]; NaN: a hole, outside, or the surface overhangs
    double own_x = 0.0, own_y = 0.0;               ///< where that is in the field's own coordinates [mm]
  };
  /// The moved surface over or under a place; beside a hole off by kBeyond times the slope at most.
  [[nodiscard]] Place at(double x, double y) const noexcept;

  [[nodiscard]] const Version& field() const noexcept { return field_; }
  [[nodiscard]] const RigidMotion& motion() const noexcept { return motion_; }
  /// The height about which its samples lie, moved [mm].
  [[nodiscard]] double middle() const noexcept { return start_; }

 private:
  MovedField(const Version& field, const RigidMotion& motion, double start);

  struct Patch {
    double z = std::numeric_limits<double>::quiet_NaN(), slope_x = 0.0, slope_y = 0.0;
  };
  [[nodiscard]] Patch patchAt(double x, double y) const noexcept;
  [[nodiscard]] Patch patchIn(std::int32_t c, std::int32_t r, double s, double t) const noexcept;

  Version field_;
  RigidMotion motion_;
  double start_;
  FieldReader from_;
  glm::dvec3 along_;
  double unit_, spacing_x_, spacing_y_;
  std::int32_t width_, height_;
};

/// The second field, moved, at the samples of a grid: the height of its bilinear patches there, rounded to float once, in
/// the grid's height unit. A hole where the patch has one, outside, and where the moved surface overhangs. No marks.
/// Errors: kFailed without memory; kCancelled. Thread: any; a long job on all workers of the
/// calling arena.
[[nodiscard]] Result<Version> movedOnto(const Version& second, const RigidMotion& motion, const Grid& grid,
                                        JobControl& job);

}  // namespace fettle::engine
