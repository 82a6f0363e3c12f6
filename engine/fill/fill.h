#pragma once

#include <cstdint>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/fill/hole_surface.h"

namespace fettle::engine {

/// Which holes are filled, and by what. All limits are inclusive.
struct FillOptions {
  FillMethod method = FillMethod::kCurvature;
  /// The longer side of the rectangle around a hole, counted from sample to sample across it [mm]; > 0.
  double most_extent_mm = std::numeric_limits<double>::infinity();
  /// Its samples times the area of one [mm^2]; > 0.
  double most_area_mm2 = std::numeric_limits<double>::infinity();
  /// Also holes that reach the field's border, where the surface ends freely.
  bool at_border = false;

  friend bool operator==(const FillOptions&, const FillOptions&) = default;

  /// Holes with more samples than these stay: their equations would take too much time and memory. Measured at that size: 15 s and 0.7 GB, 13 s and 0.8 GB.
  static constexpr std::int64_t kMostMembrane = 1'000'000;
  static constexpr std::int64_t kMostCurvature = 400'000;
  [[nodiscard]] std::int64_t mostSamples() const noexcept {
    return method == FillMethod::kMembrane ? kMostMembrane : kMostCurvature;
  }
};

/// What was done with the holes. Each hole counts once: filled, or in the first of the lists of those that stay.
struct Filled {
  Version field;
  std::int64_t holes = 0;         ///< of the field before
  std::int64_t filled_holes = 0;  ///< some sample of which was filled
  std::int64_t filled = 0;        ///< samples
  std::int64_t larger = 0;        ///< larger than the options allow
  std::int64_t at_border = 0;     ///< reach the border
  std::int64_t too_many = 0;      ///< more samples than mostSamples()
  std::int64_t no_rim = 0;        ///< no height next to them, on no side of a wall
  std::int64_t undetermined = 0;  ///< filled holes whose rim does not determine a surface (HoleSurface)
};

/// Fills holes (surfaceOfHole), each by itself and of the heights as they were, so that nothing depends on order, tiles or
/// threads. Edge lines are walls all along, also where no edge was located in the field, as in a hole: there the line
/// is of the kind of its nearest located point, a step where it has none. Marked samples without a height stay holes.
/// Samples with a height, marks, lines, place and sign stay; tiles without a filled sample stay shared.
///
/// Errors: every sample is a hole (kInput); kCancelled, between two holes; kFailed without memory. Memory: what the holes
/// under work need, those of over 50,000 samples one after the other. Thread: any; a long job on all workers of the arena.
[[nodiscard]] Result<Filled> fillHoles(const Version& field, const FillOptions& options, JobControl& job);

/// How far heights of a filled field lie below the lowest and above the highest one before, as a surface of least curvature may
/// continue a steep rim [height_unit, sign applied]; 0 up to a twentieth of the span of heights. From the pyramids.
struct BeyondBefore {
  double below = 0.0, above = 0.0;
};
[[nodiscard]] BeyondBefore beyondBefore(const Version& before, const Version& filled) noexcept;

}  // namespace fettle::engine
